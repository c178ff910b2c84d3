#include "solver/collision/bounds_tree.hpp"

#include <algorithm>

namespace cycloid::solver {

/// Spreads the low bits of x so that D - 1 zeros follow each.
template <int D>
static std::uint32_t spread_bits(std::uint32_t x) {
  std::uint32_t spread = 0;
  for (int i = 0; i < Dim<D>::kMortonBits; ++i) spread |= ((x >> i) & 1u) << (i * D);
  return spread;
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

template <int D>
void BoundsTree<D>::build(std::vector<Leaf>& leaves) {
  keys_.clear();
  leaves_.clear();
  boxes_.clear();
  if (leaves.empty()) return;
  Bounds<D> world = leaves[0].bounds;
  for (const Leaf& leaf : leaves) world = merged(world, leaf.bounds);
  for (std::uint32_t i = 0; i < leaves.size(); ++i) {
    const std::uint64_t code = morton_code(leaves[i].bounds, world);
    keys_.push_back({(code << 32) | leaves[i].id, i});
  }
  // Total order: ids are unique.
  std::sort(keys_.begin(), keys_.end(), [](const Key& a, const Key& b) { return a.code < b.code; });
  for (const Key& key : keys_) leaves_.push_back(leaves[key.leaf]);
  boxes_.resize(2 * leaves_.size() - 1);
  build_range(0, 0, size());
}

template <int D>
Bounds<D> BoundsTree<D>::build_range(int box, int begin, int end) {
  Bounds<D> bounds;
  if (end - begin == 1) {
    bounds = leaf(begin).bounds;
  } else {
    const int middle = begin + (end - begin) / 2;
    const Bounds<D> left = build_range(box + 1, begin, middle);
    const Bounds<D> right = build_range(box + 2 * (middle - begin), middle, end);
    bounds = merged(left, right);
  }
  boxes_[static_cast<std::size_t>(box)] = bounds;
  return bounds;
}

template class BoundsTree<2>;
template class BoundsTree<3>;

}  // namespace cycloid::solver
