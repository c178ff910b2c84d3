#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "solver/collision/bounds_row.hpp"

namespace cycloid::solver {

/// A balanced tree of boxes, four to a node, over a sorted sequence, built from nothing:
/// O(n log n), without a history.
///
/// Leaves are sorted along a Morton curve, which keeps neighbours together. Source: Karras,
/// "Maximizing Parallelism in the Construction of BVHs, Octrees, and k-d Trees" (HPG 2012); we
/// take them four at a time instead of splitting at the highest differing bit, so the depth is
/// bounded.
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
    Visit path[kLevelsMax];
    int level = levels_ - 1;
    path[level] = visit(level, 0, bounds);
    while (level < levels_) {
      Visit& at = path[level];
      if (at.overlapping == 0) {
        ++level;
        continue;
      }
      const int child = 4 * at.row + std::countr_zero(at.overlapping);
      at.overlapping &= at.overlapping - 1;
      if (level == 0) {
        found(child);
        continue;
      }
      --level;
      path[level] = visit(level, child, bounds);
    }
  }

 private:
  /// A fourth of what an int counts, a fourth of that, and so on.
  static constexpr int kLevelsMax = 16;

  /// A row on the way to the leaves, and which of its boxes are still to be gone into.
  struct Visit {
    int row;
    std::uint32_t overlapping;
  };
  Visit visit(int level, int row, const Bounds<D>& bounds) const {
    return {row, rows_[static_cast<std::size_t>(first_row_[level] + row)].overlapping(bounds)};
  }
  void put(int level, int child, const Bounds<D>& box);
  void build_rows();

  std::vector<Leaf> leaves_;
  /// Level by level: box i of row r is of leaf 4 r + i, and one level up of row 4 r + i.
  std::vector<BoundsRow<D>> rows_;
  int first_row_[kLevelsMax] = {};  ///< Of each level, from the leaves to the one of a single row.
  int levels_ = 0;
  struct Key {
    std::uint64_t code;  ///< Morton code, then id: unique, so the order is total.
    std::uint32_t leaf;
  };
  std::vector<Key> keys_;
};

}  // namespace cycloid::solver
