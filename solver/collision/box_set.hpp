#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "solver/collision/bounds_tree.hpp"

namespace cycloid::solver {

/// Boxes by number, to be asked which of them overlap another: those that changed lately lie in
/// rows of four that a query compares at once, the others in a tree that is made anew when these
/// have become too many. A small world never has a tree. What is found depends on the boxes alone,
/// in which order also on the history: whoever asks must not let the order show.
template <int D>
class BoxSet {
 public:
  void clear();
  /// Adds the box of `id`, or changes it.
  void put(std::uint32_t id, const Bounds<D>& box);
  void remove(std::uint32_t id);
  /// Makes the tree anew where too many boxes changed since the last time; call it after changes.
  void settle();

  bool contains(std::uint32_t id) const { return id < home_.size() && home_[id] != kAbsent; }
  /// @pre contains(id).
  const Bounds<D>& box(std::uint32_t id) const { return boxes_[id]; }
  std::uint32_t size() const { return count_; }

  /// Calls found(id) once for every box that overlaps `bounds`.
  template <class Found>
  void query(const Bounds<D>& bounds, Found&& found) const {
    tree_.query(bounds, [&](int rank) {
      const std::uint32_t id = tree_.leaf(rank).id;
      if (home_[id] == kInTree) found(id);
    });
    for (const Row& row : rows_)
      for (std::uint32_t lanes = row.boxes.overlapping(bounds); lanes != 0; lanes &= lanes - 1)
        found(row.id[std::countr_zero(lanes)]);
  }

 private:
  struct Row {
    BoundsRow<D> boxes;
    std::uint32_t id[4];
  };
  static constexpr std::uint32_t kAbsent = 0xffffffffu;
  static constexpr std::uint32_t kInTree = 0xfffffffeu;
  void write(std::uint32_t place, std::uint32_t id, const Bounds<D>& box);
  void take_out(std::uint32_t place);

  std::vector<Bounds<D>> boxes_;     ///< By id.
  std::vector<std::uint32_t> home_;  ///< By id: kAbsent, kInTree, or the place among the rows.
  std::vector<Row> rows_;
  std::uint32_t loose_ = 0;  ///< Boxes in rows.
  std::uint32_t count_ = 0;
  BoundsTree<D> tree_;
  std::vector<typename BoundsTree<D>::Leaf> leaves_;
};

}  // namespace cycloid::solver
