#pragma once

#include <cstdint>
#include <vector>

#include "solver/collision/bounds_kernels.hpp"

namespace cycloid::solver {

/// A balanced tree of boxes, sixteen to a node, over a sorted sequence, built from nothing:
/// O(n log n), without a history.
///
/// Leaves are sorted along a Morton curve, which keeps neighbours together. Source: Karras,
/// "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees" (HPG 2012); we
/// take them sixteen at a time instead of splitting at the highest differing bit, so the depth is
/// bounded.
template <int D>
class BoundsTree {
 public:
  struct Leaf {
    Bounds<D> bounds;
    std::uint32_t id;
  };

  /// @pre ids are unique: of those that build one each is the slot of a shape, listed once.
  void build(std::vector<Leaf>& leaves);

  int size() const { return static_cast<int>(leaves_.size()); }
  const Leaf& leaf(int rank) const { return leaves_[static_cast<std::size_t>(rank)]; }

  /// Calls found(rank) for every leaf whose box overlaps `bounds`, in rank order.
  template <class Found>
  void query(const Bounds<D>& bounds, Found&& found) const {
    if (leaves_.empty()) return;
    for_each_found(
        bounds,
        [&](BoundsSearch<D>& search, FoundBoxes& boxes) { return search_on(search, boxes); },
        [&](std::uint32_t rank) { found(static_cast<int>(rank)); });
  }

 private:
  bool search_on(BoundsSearch<D>& search, FoundBoxes& found) const;
  void sort_keys();
  template <class BoxOf>
  void add_rows(int count, BoxOf&& box_of);
  void build_rows();

  std::vector<Leaf> leaves_;
  std::vector<BoundsRow<D>> rows_;                 ///< As in RowsOfTree.
  int first_row_[RowsOfTree<D>::kLevelsMax] = {};  ///< Of each level.
  int levels_ = 0;
  struct Key {
    std::uint64_t code;  ///< Morton code, then id: unique, so the order is total.
    std::uint32_t leaf;
  };
  std::vector<Key> keys_;
  std::vector<Key> keys_room_;  ///< For sort_keys to work in.
};

}  // namespace cycloid::solver
