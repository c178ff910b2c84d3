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

/// How far a fat box reaches beyond the box: a share of its size, and the flight of so many ticks
/// in the direction of the flight. More makes looks rarer and candidates more.
inline constexpr float kFatShare = 0.1f;
inline constexpr float kFatTicks = 10.0f;

/// @param flight  Of a tick, m.
template <int D>
Bounds<D> fattened(const Bounds<D>& box, const Vec<D>& flight) {
  Bounds<D> fat = box;
  float size = 0.0f;
  for (int i = 0; i < D; ++i) size += box.upper[i] - box.lower[i];
  for (int i = 0; i < D; ++i) {
    const float ahead = kFatTicks * flight[i];
    fat.lower[i] -= kFatShare * size - min(ahead, 0.0f);
    fat.upper[i] += kFatShare * size + max(ahead, 0.0f);
  }
  return fat;
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
  std::vector<ShapePair> candidates;          ///< Sorted by key.
  std::vector<std::uint64_t> jointed_bodies;  ///< Sorted pairs that do not collide.
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
