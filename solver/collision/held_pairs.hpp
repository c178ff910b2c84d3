#pragma once

#include <span>
#include <vector>

#include "solver/collision/pair_cache.hpp"
#include "solver/collision/pose_cells.hpp"

namespace cycloid::solver {

/// Two solids that a face of one of them parted, and how they lay then.
struct PartedPair {
  std::uint64_t key;  ///< ShapePair::key.
  Pose<3> relative;   ///< relative_pose.
  float gap;          ///< Between the shapes along the normal of that face, m: at least, in all
                      ///< poses that round as this does.
  float reach;        ///< From where a turn of one moves the other along that normal, m.
};

/// What was found of two solids in a cell, which may be nothing.
struct HeldManifold {
  std::uint64_t key;  ///< ShapePair::key.
  Pose<3> cell;       ///< `rounded`.
  float margin;       ///< `rounded_margin`.
  Manifold<3> manifold;
};

/// What a tick has found of pairs that moves little in most, each list sorted by key. In the plane
/// a look at it would cost as much as to collide the pair.
///
/// A cache: it tells what would be found again and nothing else, so no result depends on it.
template <int D>
struct HeldPairs {};
template <>
struct HeldPairs<3> {
  std::vector<PartedPair> parted;
  std::vector<HeldManifold> manifolds;
};

inline void clear(HeldPairs<2>&) {}
inline void clear(HeldPairs<3>& held) {
  held.parted.clear();
  held.manifolds.clear();
}
inline void append(const HeldPairs<2>&, HeldPairs<2>&) {}
inline void append(const HeldPairs<3>& more, HeldPairs<3>& held) {
  held.parted.insert(held.parted.end(), more.parted.begin(), more.parted.end());
  held.manifolds.insert(held.manifolds.end(), more.manifolds.begin(), more.manifolds.end());
}

/// Collides the pairs of which something is held: two boxes or hulls.
template <int D>
class PairMemory {
 public:
  /// @param key  None below it will be asked for.
  PairMemory(const WorldState<D>&, const HeldPairs<D>&, std::uint64_t, HeldPairs<D>&) {}
};
template <>
class PairMemory<3> {
 public:
  PairMemory(const WorldState<3>& state, const HeldPairs<3>& before, std::uint64_t key,
             HeldPairs<3>& now);

  /// What `collide_held` gives, and holds it for the next tick. @pre the key is above that before.
  void collide(const PlacedPair<3>& pair, Manifold<3>& manifold);

 private:
  bool is_parted(std::uint64_t key, const Pose<3>& relative, float margin);
  bool find_parted(const PlacedPair<3>& pair, std::uint64_t key, const CellGrid& grid,
                   const Pose<3>& relative, float margin);

  const WorldState<3>& state_;
  std::span<const PartedPair> parted_;  ///< Those of keys that may still be asked for.
  std::span<const HeldManifold> manifolds_;
  HeldPairs<3>& now_;
};

/// Whether a pair is collided in cells.
inline bool is_held(const Shape<2>&, const Shape<2>&) {
  return false;
}
bool is_held(const Shape<3>& a, const Shape<3>& b);

/// The manifold of a pair, as a step makes it, without a memory. In cells where it is held.
Manifold<2> collide_held(const WorldState<2>& state, const PlacedPair<2>& pair);
Manifold<3> collide_held(const WorldState<3>& state, const PlacedPair<3>& pair);

}  // namespace cycloid::solver
