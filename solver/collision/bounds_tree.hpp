#pragma once

#include <cstdint>
#include <vector>

#include "solver/collision/bounds.hpp"

namespace cycloid::solver {

/// A balanced tree of boxes over a sorted sequence, built from nothing: O(n log n), without
/// a history.
///
/// Leaves are sorted along a Morton curve, which keeps neighbours together. Source: Karras,
/// "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees" (HPG 2012); we
/// split ranges in the middle instead of at the highest differing bit, which bounds the depth.
template <int D>
class BoundsTree {
 public:
  struct Leaf {
    Bounds<D> bounds;
    std::uint32_t id;
  };

  /// @pre ids are unique.
  void build(std::vector<Leaf>& leaves);

  int size() const { return static_cast<int>(leaves_.size()); }
  const Leaf& leaf(int rank) const { return leaves_[static_cast<std::size_t>(rank)]; }

  /// Calls found(rank) for every leaf whose box overlaps `bounds`, in rank order.
  template <class Found>
  void query(const Bounds<D>& bounds, Found&& found) const {
    if (leaves_.empty()) return;
    // The tree halves at each level: 64 entries suffice for any size that an int can count.
    Node stack[64];
    int depth = 0;
    stack[depth++] = {0, 0, size()};
    while (depth > 0) {
      const Node node = stack[--depth];
      if (!overlaps(boxes_[static_cast<std::size_t>(node.box)], bounds)) continue;
      if (node.end - node.begin == 1) {
        found(node.begin);
        continue;
      }
      const int middle = node.begin + (node.end - node.begin) / 2;
      stack[depth++] = {node.box + 2 * (middle - node.begin), middle, node.end};
      stack[depth++] = {node.box + 1, node.begin, middle};
    }
  }

 private:
  /// Leaves [begin, end); their box is boxes_[box], the left child's follows it directly.
  struct Node {
    int box;
    int begin;
    int end;
  };
  Bounds<D> build_range(int box, int begin, int end);

  std::vector<Leaf> leaves_;
  std::vector<Bounds<D>> boxes_;
  struct Key {
    std::uint64_t code;  ///< Morton code, then id: unique, so the order is total.
    std::uint32_t leaf;
  };
  std::vector<Key> keys_;
};

}  // namespace cycloid::solver
