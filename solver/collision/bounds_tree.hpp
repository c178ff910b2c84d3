#pragma once

#include <cstdint>
#include <vector>

#include "solver/collision/bounds_kernels.hpp"
#include "solver/workers.hpp"

namespace cycloid::solver {

/// A box in the order of a tree. Sorted by Morton code, then by id: unique, so the order is total.
struct TreeKey {
  std::uint64_t code;
  std::uint32_t leaf;  ///< Place among those that the tree is built of.
};

/// Keys of one stretch of a tree's order, for a thread to sort.
struct TreeStretch {
  std::vector<TreeKey> keys;
  std::vector<TreeKey> room;
  std::size_t begin = 0;  ///< Rank of the first.
};

/// For trees to be built in, one after the other.
template <int D>
struct TreeRoom {
  std::vector<Bounds<D>> worlds;  ///< Of each chunk of the leaves.
  std::vector<TreeKey> keys;
  std::vector<std::uint64_t> cuts;  ///< Between stretches: the least code of the next.
  std::vector<TreeStretch> stretches;
};

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

  /// Several threads sort a stretch of the order each. @pre ids are unique: of those that build one
  /// each is the slot of a shape, listed once.
  void build(const std::vector<Leaf>& leaves, Workers& workers, TreeRoom<D>& room);

  void clear() { leaves_.clear(); }

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
  static void find_keys(const std::vector<Leaf>& leaves, Workers& workers, TreeRoom<D>& room);
  template <class BoxOf>
  void fill_rows(int first, int count, Workers& workers, BoxOf&& box_of);
  void build_rows(Workers& workers);

  std::vector<Leaf> leaves_;
  std::vector<BoundsRow<D>> rows_;                 ///< As in RowsOfTree.
  int first_row_[RowsOfTree<D>::kLevelsMax] = {};  ///< Of each level.
  int levels_ = 0;
};

}  // namespace cycloid::solver
