#pragma once

#include <cstdint>
#include <vector>

#include "solver/collision/bounds_tree.hpp"

namespace cycloid::solver {

/// Boxes by number, to be asked which of them overlap another: those that changed last lie in rows
/// that a query compares at once, those that changed lately in a small tree, the others in
/// a great one. Each tree is made anew when too many have changed since. A small world has rows
/// alone. What is found depends on the boxes alone, in which order also on the history: whoever
/// asks must not let the order show.
template <int D>
class BoxSet {
 public:
  void clear();
  /// Adds the box of `id`, or changes it.
  void put(std::uint32_t id, const Bounds<D>& box);
  void remove(std::uint32_t id);
  /// Makes a tree anew where too many boxes changed since the last time; call it after changes.
  void settle(Workers& workers, TreeRoom<D>& room);

  bool contains(std::uint32_t id) const { return id < home_.size() && home_[id] != kAbsent; }
  /// @pre contains(id).
  const Bounds<D>& box(std::uint32_t id) const { return boxes_[id]; }
  std::uint32_t size() const { return count_; }

  /// Calls found(id) once for every box that overlaps `bounds`.
  template <class Found>
  void query(const Bounds<D>& bounds, Found&& found) const {
    for (const Home home : {kInOld, kInYoung}) {
      const BoundsTree<D>& tree = home == kInOld ? old_ : young_;
      tree.query(bounds, [&](int rank) {
        const std::uint32_t id = tree.leaf(rank).id;
        if (home_[id] == home) found(id);
      });
    }
    if (rows_.empty()) return;
    for_each_found(
        bounds,
        [&](BoundsSearch<D>& search, FoundBoxes& boxes) { return search_rows(search, boxes); },
        [&](std::uint32_t place) { found(ids_[place]); });
  }

 private:
  bool search_rows(BoundsSearch<D>& search, FoundBoxes& found) const;
  /// Where a box is, if not at a place among the rows. A tree also holds boxes that have left it.
  enum Home : std::uint32_t { kInYoung = 0xfffffffdu, kInOld, kAbsent };
  void write(std::uint32_t place, std::uint32_t id, const Bounds<D>& box);
  void take_out(std::uint32_t place);
  void list_young();
  void forget_rows(Home home);

  std::vector<Bounds<D>> boxes_;     ///< By id.
  std::vector<std::uint32_t> home_;  ///< By id: a Home, or the place among the rows.
  std::vector<BoundsRow<D>> rows_;
  std::vector<std::uint32_t> ids_;  ///< By place among the rows: whose box is there.
  std::uint32_t count_ = 0;
  BoundsTree<D> old_;
  BoundsTree<D> young_;
  std::vector<typename BoundsTree<D>::Leaf> leaves_;
};

}  // namespace cycloid::solver
