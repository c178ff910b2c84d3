#include "solver/encoding.hpp"
#include "solver/tracing/digest_writer.hpp"
#include "solver/visit.hpp"
#include "solver/world.hpp"

namespace cycloid::solver {

template <class A>
static void write_array(const A& array, DigestWriter& write) {
  write(static_cast<std::uint32_t>(array.size()));
  write.records(std::span(array));
}

/// What no tick changes enters as a digest of its own, which is made when it has been edited:
/// shapes are two fifths of a state's bytes.
template <class R>
static void write_array(const SharedArray<R>& array, DigestWriter& write) {
  write(array.kept_number([&] {
    DigestWriter of_array;
    write_array(std::span(array), of_array);
    return of_array.digest();
  }));
}

/// As above for the parts that no tick changes, half of a body and four fifths of a joint; what
/// ticks move follows.
template <class R>
static void write_array(const MovedArray<R>& array, DigestWriter& write) {
  const std::span<const R> records(array.data(), array.size());
  write(static_cast<std::uint32_t>(array.size()));
  write(array.kept_number([&] {
    DigestWriter of_array;
    of_array.parts<typename R::Kept>(records);
    return of_array.digest();
  }));
  write.parts<typename R::Moved>(records);
}

/// Number by number, but for the tuning, which is most of it and lies in memory as a record does.
template <int D>
static void write_header(const WorldHeader<D>& header, DigestWriter& write) {
  visit(header, [&](const char*, const auto& field) {
    if constexpr (std::is_same_v<decltype(field), const Tuning&>)
      write.records(std::span(&field, 1));
    else
      visit_words(field, write);
  });
}

template <int D>
std::uint64_t digest_state(const WorldState<D>& state) {
  DigestWriter write;
  write(static_cast<std::uint32_t>(D));
  write_header(state.header, write);
  visit_arrays(state, [&](const char*, const auto& array) { write_array(array, write); });
  return write.digest();
}

template <int D>
static std::optional<std::uint64_t> digest_as(std::span<const std::byte> bytes) {
  WorldState<D> state;
  if (!read_state(bytes, state)) return std::nullopt;
  return digest_state(state);
}

std::optional<std::uint64_t> digest_encoding(std::span<const std::byte> bytes) {
  const int dimension = encoded_dimension(bytes);
  if (dimension == 0) return std::nullopt;
  return dimension == 2 ? digest_as<2>(bytes) : digest_as<3>(bytes);
}

template <int D>
std::uint64_t World<D>::digest() const {
  return digest_state(state_);
}

template std::uint64_t digest_state(const WorldState<2>&);
template std::uint64_t digest_state(const WorldState<3>&);
template std::uint64_t World<2>::digest() const;
template std::uint64_t World<3>::digest() const;

}  // namespace cycloid::solver
