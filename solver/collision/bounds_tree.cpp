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

/// Cells along each axis of a box of the world, whose centres of boxes become codes.
template <int D>
class MortonCells {
 public:
  explicit MortonCells(const Bounds<D>& world) : lower_(world.lower) {
    for (int i = 0; i < D; ++i)
      per_length_[i] = kCells / max(world.upper[i] - world.lower[i], 1.0e-6f);
  }
  std::uint32_t code_of(const Bounds<D>& box) const {
    std::uint32_t code = 0;
    for (int i = 0; i < D; ++i) {
      const float centre = 0.5f * (box.lower[i] + box.upper[i]);
      const float cell = clamp((centre - lower_[i]) * per_length_[i], 0.0f, kCells);
      code |= spread_bits<D>(static_cast<std::uint32_t>(cell)) << i;
    }
    return code;
  }

 private:
  static constexpr float kCells = static_cast<float>((1 << Dim<D>::kMortonBits) - 1);
  Vec<D> lower_;
  Vec<D> per_length_;  ///< 1/m
};

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
  leaves_.resize(leaves.size());
  if (leaves.empty()) return;
  Bounds<D> world = leaves[0].bounds;
  for (const Leaf& leaf : leaves) world = merged(world, leaf.bounds);
  const MortonCells<D> cells(world);
  keys_.resize(leaves.size());
  for (std::uint32_t i = 0; i < leaves.size(); ++i) {
    const std::uint64_t code = cells.code_of(leaves[i].bounds);
    keys_[i] = {(code << 32) | leaves[i].id, i};
  }
  sort_keys();
  for (std::size_t rank = 0; rank < leaves.size(); ++rank) leaves_[rank] = leaves[keys_[rank].leaf];
  build_rows();
}

/// Appends rows of so many boxes, of which only the last has empty places.
template <int D>
template <class BoxOf>
void BoundsTree<D>::add_rows(int count, BoxOf&& box_of) {
  constexpr int kBoxes = BoundsRow<D>::kBoxes;
  for (int begin = 0; begin < count; begin += kBoxes) {
    BoundsRow<D> row;
    for (int place = 0; place < kBoxes; ++place) {
      if (begin + place < count)
        row.set(place, box_of(begin + place));
      else
        row.clear(place);
    }
    rows_.push_back(row);
  }
}

template <int D>
void BoundsTree<D>::build_rows() {
  rows_.clear();
  first_row_[0] = 0;
  add_rows(size(), [&](int rank) -> const Bounds<D>& { return leaf(rank).bounds; });
  for (levels_ = 1;; ++levels_) {
    const int begin = first_row_[levels_ - 1];
    const int end = static_cast<int>(rows_.size());
    if (end - begin == 1) return;
    first_row_[levels_] = end;
    add_rows(end - begin,
             [&](int child) { return rows_[static_cast<std::size_t>(begin + child)].all(); });
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
