#include "solver/collision/bounds_tree.hpp"

#include <algorithm>
#include <array>

#include "solver/lane_widths.hpp"
#include "solver/radix_sort.hpp"

namespace cycloid::solver {

/// Of each byte its bits with D - 1 zeros behind each.
template <int D>
static constexpr std::array<std::uint32_t, 256> spread_bytes() {
  std::array<std::uint32_t, 256> spread{};
  for (std::uint32_t byte = 0; byte < spread.size(); ++byte)
    for (int i = 0; i < 8; ++i) spread[byte] |= ((byte >> i) & 1u) << (i * D);
  return spread;
}

/// Spreads the low bits of x so that D - 1 zeros follow each.
template <int D>
static std::uint32_t spread_bits(std::uint32_t x) {
  static_assert(Dim<D>::kMortonBits <= 16);
  static constexpr std::array<std::uint32_t, 256> kSpread = spread_bytes<D>();
  return kSpread[x & 255u] | kSpread[(x >> 8) & 255u] << (8 * D);
}

template <int D>
static std::uint32_t morton_code(const Bounds<D>& box, const Bounds<D>& world) {
  constexpr float kCells = static_cast<float>((1 << Dim<D>::kMortonBits) - 1);
  std::uint32_t code = 0;
  for (int i = 0; i < D; ++i) {
    const float extent = max(world.upper[i] - world.lower[i], 1.0e-6f);
    const float centre = 0.5f * (box.lower[i] + box.upper[i]);
    const float cell = clamp((centre - world.lower[i]) / extent * kCells, 0.0f, kCells);
    code |= spread_bits<D>(static_cast<std::uint32_t>(cell)) << i;
  }
  return code;
}

/// By Morton code, and by id where two codes are the same: a crowd in one cell. Keys are integers
/// that no two leaves share, so there is one order of them, whatever a library's sort does with
/// equals, and whether it counts or compares.
template <int D>
void BoundsTree<D>::sort_keys() {
  // Total order: the whole key, whose low half is the id, and ids are unique.
  const auto is_before = [](const Key& a, const Key& b) { return a.code < b.code; };
  if (keys_.size() < kRadixSortMin) return std::sort(keys_.begin(), keys_.end(), is_before);
  const auto place_of = [](const Key& key) { return static_cast<std::uint32_t>(key.code >> 32); };
  keys_room_.resize(keys_.size());
  radix_sort(~std::uint32_t{0}, place_of, keys_room_, keys_);
  for (auto first = keys_.begin(); first != keys_.end();) {
    auto last = first + 1;
    while (last != keys_.end() && place_of(*last) == place_of(*first)) ++last;
    // Total order: the same; of these the high halves are equal, so it is that of the ids.
    if (last - first > 1) std::sort(first, last, is_before);
    first = last;
  }
}

template <int D>
void BoundsTree<D>::build(std::vector<Leaf>& leaves) {
  keys_.clear();
  leaves_.clear();
  if (leaves.empty()) return;
  Bounds<D> world = leaves[0].bounds;
  for (const Leaf& leaf : leaves) world = merged(world, leaf.bounds);
  for (std::uint32_t i = 0; i < leaves.size(); ++i) {
    const std::uint64_t code = morton_code(leaves[i].bounds, world);
    keys_.push_back({(code << 32) | leaves[i].id, i});
  }
  sort_keys();
  for (const Key& key : keys_) leaves_.push_back(leaves[key.leaf]);
  build_rows();
}

template <int D>
void BoundsTree<D>::put(int level, int child, const Bounds<D>& box) {
  const auto row = static_cast<std::size_t>(first_row_[level] + child / BoundsRow<D>::kBoxes);
  if (row == rows_.size()) rows_.push_back(BoundsRow<D>::empty());
  rows_[row].set(child % BoundsRow<D>::kBoxes, box);
}

template <int D>
void BoundsTree<D>::build_rows() {
  rows_.clear();
  first_row_[0] = 0;
  for (int rank = 0; rank < size(); ++rank) put(0, rank, leaf(rank).bounds);
  for (levels_ = 1;; ++levels_) {
    const int begin = first_row_[levels_ - 1];
    const int end = static_cast<int>(rows_.size());
    if (end - begin == 1) return;
    first_row_[levels_] = end;
    for (int row = begin; row < end; ++row)
      put(levels_, row - begin, rows_[static_cast<std::size_t>(row)].all());
  }
}

template <int D>
bool BoundsTree<D>::search_on(BoundsSearch<D>& search, FoundBoxes& found) const {
  const RowsOfTree<D> tree{rows_.data(), first_row_, levels_};
  return at_widest([&]<int W>() { return BoundsKernels<D, W>::search_tree(tree, search, found); });
}

template class BoundsTree<2>;
template class BoundsTree<3>;

}  // namespace cycloid::solver
