#include "solver/tracing/digest_writer.hpp"
#include "solver/visit.hpp"
#include "solver/world.hpp"

namespace cycloid::solver {

template <int D>
std::uint64_t World<D>::digest() const {
  DigestWriter write;
  write(static_cast<std::uint32_t>(D));
  visit_words(state_.header, write);
  visit_arrays(state_, [&](const char*, const auto& array) {
    write(static_cast<std::uint32_t>(array.size()));
    for (const auto& element : array) visit_words(element, write);
  });
  return write.digest();
}

template std::uint64_t World<2>::digest() const;
template std::uint64_t World<3>::digest() const;

}  // namespace cycloid::solver
