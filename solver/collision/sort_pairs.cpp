#include "solver/collision/sort_pairs.hpp"

#include <algorithm>
#include <bit>

#include "solver/radix_sort.hpp"

namespace cycloid::solver {

void sort_pairs(std::uint32_t shapes, std::vector<ShapePair>& room, std::vector<ShapePair>& pairs) {
  if (pairs.size() < kRadixSortMin) {
    // Total order: the key is the whole pair.
    std::sort(pairs.begin(), pairs.end(),
              [](const ShapePair& a, const ShapePair& b) { return a.key() < b.key(); });
    return;
  }
  room.resize(pairs.size());
  const int bits = std::bit_width(shapes - 1);
  if (bits > kRadixSortBits && 2 * bits <= 32) {  // As one number they have a digit less.
    const auto number_of = [&](const ShapePair& pair) {
      return pair.shape_a << bits | pair.shape_b;
    };
    return radix_sort(number_of({shapes - 1, shapes - 1}), number_of, room, pairs);
  }
  radix_sort(
      shapes - 1, [](const ShapePair& pair) { return pair.shape_b; }, room, pairs);
  radix_sort(
      shapes - 1, [](const ShapePair& pair) { return pair.shape_a; }, room, pairs);
}

}  // namespace cycloid::solver
