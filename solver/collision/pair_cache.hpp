#pragma once

#include <cstdint>
#include <vector>

#include "solver/collision/box_set.hpp"

namespace cycloid::solver {

/// Two shapes whose boxes overlap, lower slot first.
struct ShapePair {
  std::uint32_t shape_a;
  std::uint32_t shape_b;
  std::uint64_t key() const { return (std::uint64_t{shape_a} << 32) | shape_b; }
};

/// The lengths of a box's sides, summed, m.
template <int D>
float size_of(const Bounds<D>& box) {
  float size = 0.0f;
  for (int i = 0; i < D; ++i) size += box.upper[i] - box.lower[i];
  return size;
}

/// A box that reaches as far again as something flies.
template <int D>
Bounds<D> along(Bounds<D> box, const Vec<D>& flight) {
  for (int i = 0; i < D; ++i) {
    box.lower[i] += min(flight[i], 0.0f);
    box.upper[i] += max(flight[i], 0.0f);
  }
  return box;
}

/// How far a fat box reaches beyond the box: a share of its size, and the flight of some ticks.
/// More makes looks rarer and candidates more.
inline constexpr float kFatShare = 0.03f;
inline constexpr float kFatTicks = 10.0f;

/// @param flight  Of a tick, m.
template <int D>
Bounds<D> fattened(const Bounds<D>& box, const Vec<D>& flight, float ticks) {
  Bounds<D> fat = along(box, ticks * flight);
  const float share = kFatShare * size_of(box);
  for (int i = 0; i < D; ++i) {
    fat.lower[i] -= share;
    fat.upper[i] += share;
  }
  return fat;
}

/// Of how many ticks the flight is: fewer for a shape whose last look met many.
inline float fat_ticks(std::uint32_t seen) {
  constexpr float kFew = 12.0f;
  return kFatTicks * min(1.0f, kFew / static_cast<float>(seen + 1));
}
/// Of one that has not looked yet: no farther than it is large, for it may be one of a crowd.
template <int D>
float first_fat_ticks(const Bounds<D>& box, const Vec<D>& flight) {
  const float size = size_of(box);
  const float way = length(flight);
  return way * kFatTicks <= size ? kFatTicks : size / way;
}

/// What `find_pairs` keeps from tick to tick to find the same pairs with less work. A pure cache:
/// with it or without, the pairs of a tick are a function of the state.
///
/// Around the box of each shape of a body that can move lies a fat one, which it leaves only now
/// and then. Candidates are the pairs that may touch and whose fat boxes overlap, so each pair of
/// overlapping boxes is among them; only shapes that left their fat box are looked up again.
template <int D>
struct PairCache {
  std::vector<Bounds<D>> boxes;        ///< By shape: of this tick. A half-space's is open.
  std::vector<std::uint8_t> active;    ///< By shape: its body takes part in this tick.
  std::vector<std::uint8_t> is_still;  ///< By shape: its box was made while nothing moved it.
  std::vector<std::uint8_t> looks;     ///< By shape: it is looked up in this tick.
  std::vector<std::uint32_t> seen;     ///< By shape: boxes its last look met.
  std::uint64_t seen_sum = 0;
  BoxSet<D> fat;
  std::vector<ShapePair> candidates;          ///< Sorted by key: those with an active shape.
  std::vector<ShapePair> dormant;             ///< The others, sorted by key.
  std::vector<std::uint64_t> jointed_bodies;  ///< Sorted pairs that do not collide.
  std::vector<std::uint32_t> first_jointed;   ///< By lower body of those, where its pairs begin.
  std::vector<std::uint32_t> forgotten;       ///< Shapes whose box or filter was changed.
  bool is_known = false;                      ///< Otherwise all but the statics is made anew.
  bool statics_are_known = false;             ///< Their tree, and which are half-spaces.

  /// Something happened that may concern any pair, or another state is in place.
  void forget_all() {
    is_known = false;
    statics_are_known = false;
    forgotten.clear();
  }
  /// A shape came, or is about to go, or may touch what it did not or the other way round.
  void forget(std::uint32_t shape) {
    if (!is_known) return;
    if (forgotten.size() > 2 * boxes.size()) return forget_all();
    forgotten.push_back(shape);
  }
};

}  // namespace cycloid::solver
