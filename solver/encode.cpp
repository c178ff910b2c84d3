#include "solver/bytes.hpp"
#include "solver/encoding.hpp"
#include "solver/record_bytes.hpp"
#include "solver/validate.hpp"
#include "solver/visit.hpp"
#include "solver/world.hpp"

namespace cycloid::solver {

// "CYW" and the version of this encoding, then the dimension. Raise the version with any change of
// what `visit` lists or of its order.
static constexpr std::uint32_t kMagic = 0x04575943u;

template <int D>
std::size_t encoded_bytes(const WorldState<D>& state) {
  std::size_t bytes = 2 * sizeof(std::uint32_t) + visited_bytes<WorldHeader<D>>();
  visit_arrays(state, [&](const char*, const auto& array) {
    using Element = std::remove_cvref_t<decltype(array[0])>;
    bytes += sizeof(std::uint32_t) + array.size() * visited_bytes<Element>();
  });
  return bytes;
}

template <int D>
std::size_t saved_bytes(const WorldState<D>& state) {
  std::size_t bytes = sizeof state.header;
  visit_arrays(state, [&](const char*, const auto& array) {
    if constexpr (requires { array.capacity(); }) bytes += array.size() * sizeof array[0];
  });
  return bytes;
}

template <int D>
void encode_state(const WorldState<D>& state, std::vector<std::byte>& into) {
  into.resize(encoded_bytes(state));
  std::byte* to = into.data();
  auto write = [&](const auto& value) {
    const auto bits = bits_of(value);
    store_little(bits, to);
    to += sizeof bits;
  };
  write(kMagic);
  write(static_cast<std::uint32_t>(D));
  visit_words(state.header, write);
  visit_arrays(state, [&](const char*, const auto& array) {
    write(static_cast<std::uint32_t>(array.size()));
    to = write_records(std::span(array), to);
  });
}

int encoded_dimension(std::span<const std::byte> bytes) {
  ByteReader read{bytes};
  std::uint32_t magic = 0;
  std::uint32_t dimension = 0;
  read(magic);
  read(dimension);
  const bool known = !read.failed && magic == kMagic && (dimension == 2 || dimension == 3);
  return known ? static_cast<int>(dimension) : 0;
}

template <int D>
bool read_state(std::span<const std::byte> bytes, WorldState<D>& state) {
  ByteReader read{bytes};
  std::uint32_t magic = 0;
  std::uint32_t dimension = 0;
  read(magic);
  read(dimension);
  if (read.failed || magic != kMagic || dimension != static_cast<std::uint32_t>(D)) return false;
  visit_words(state.header, read);
  visit_arrays(state, [&](const char*, auto& array) {
    using Element = std::remove_cvref_t<decltype(array[0])>;
    std::uint32_t count = 0;
    read(count);
    // The bytes that are there bound the allocation, whatever the count claims.
    if (count > read.bytes.size() / visited_bytes<Element>()) read.failed = true;
    if (read.failed) return;
    array.resize(count);
    read_records(read, std::span(array));
  });
  return !read.failed && read.bytes.empty();
}

template <int D>
void World<D>::encode(std::vector<std::byte>& into) const {
  encode_state(state_, into);
}

template <int D>
Error World<D>::decode(std::span<const std::byte> bytes) {
  WorldState<D> state;
  if (!read_state(bytes, state)) return {Code::kCorrupt, "bytes"};
  if (const Error error = validate(state); !error.ok()) return error;
  restore(state);
  return {};
}

template std::size_t encoded_bytes(const WorldState<2>&);
template std::size_t encoded_bytes(const WorldState<3>&);
template std::size_t saved_bytes(const WorldState<2>&);
template std::size_t saved_bytes(const WorldState<3>&);
template void encode_state(const WorldState<2>&, std::vector<std::byte>&);
template void encode_state(const WorldState<3>&, std::vector<std::byte>&);
template bool read_state(std::span<const std::byte>, WorldState<2>&);
template bool read_state(std::span<const std::byte>, WorldState<3>&);
template void World<2>::encode(std::vector<std::byte>&) const;
template void World<3>::encode(std::vector<std::byte>&) const;
template Error World<2>::decode(std::span<const std::byte>);
template Error World<3>::decode(std::span<const std::byte>);

}  // namespace cycloid::solver
