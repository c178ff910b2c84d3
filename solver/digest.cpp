#include "solver/encoding.hpp"
#include "solver/tracing/digest_writer.hpp"
#include "solver/visit.hpp"
#include "solver/world.hpp"

namespace cycloid::solver {

template <int D>
std::uint64_t digest_state(const WorldState<D>& state) {
  DigestWriter write;
  write(static_cast<std::uint32_t>(D));
  visit_words(state.header, write);
  visit_arrays(state, [&](const char*, const auto& array) {
    write(static_cast<std::uint32_t>(array.size()));
    for (const auto& element : array) visit_words(element, write);
  });
  return write.digest();
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
