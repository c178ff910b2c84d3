#include "solver/collision/held_pairs.hpp"

#include <algorithm>
#include <cstring>

#include "solver/collision/collide.hpp"
#include "solver/collision/solid_apart.hpp"

namespace cycloid::solver {

bool is_held(const Shape<3>& a, const Shape<3>& b) {
  const auto is_solid = [](const Shape<3>& shape) {
    return shape.kind == ShapeKind::kBox || shape.kind == ShapeKind::kHull;
  };
  return is_solid(a) && is_solid(b);
}

template <int D>
static const Shape<D>& shape_a_of(const WorldState<D>& state, const PlacedPair<D>& pair) {
  return state.shapes[pair.shape_a];
}
template <int D>
static const Shape<D>& shape_b_of(const WorldState<D>& state, const PlacedPair<D>& pair) {
  return state.shapes[pair.shape_b];
}

static CellGrid grid_of_pair(const WorldState<3>& state, const PlacedPair<3>& pair) {
  return grid_of(state.bodies[shape_a_of(state, pair).body].extent,
                 state.bodies[shape_b_of(state, pair).body].extent);
}

static Manifold<3> collide_rounded(const WorldState<3>& state, const PlacedPair<3>& pair,
                                   const CellGrid& grid, const Pose<3>& cell, float margin) {
  return collide_in_cell(shape_a_of(state, pair), shape_b_of(state, pair), state.polyhedra, grid,
                         cell, margin);
}

Manifold<2> collide_held(const WorldState<2>& state, const PlacedPair<2>& pair) {
  return collide(shape_a_of(state, pair), pair.pose_a, shape_b_of(state, pair), pair.pose_b,
                 pair.margin, state.polyhedra);
}

Manifold<3> collide_held(const WorldState<3>& state, const PlacedPair<3>& pair) {
  const Shape<3>& a = shape_a_of(state, pair);
  const Shape<3>& b = shape_b_of(state, pair);
  if (!is_held(a, b)) return collide(a, pair.pose_a, b, pair.pose_b, pair.margin, state.polyhedra);
  const CellGrid grid = grid_of_pair(state, pair);
  const Pose<3> relative = relative_pose(grid, pair);
  const Pose<3> cell = rounded(grid, relative);
  const float margin = rounded_margin(pair.margin, state.header.tuning.speculative_distance);
  Manifold<3> manifold;
  move_from_cell(collide_rounded(state, pair, grid, cell, margin), grid, cell, relative, pair,
                 manifold);
  return manifold;
}

template <class Held>
static std::span<const Held> from_key(std::span<const Held> held, std::uint64_t key) {
  const auto first =
      std::lower_bound(held.begin(), held.end(), key,
                       [](const Held& pair, std::uint64_t wanted) { return pair.key < wanted; });
  return held.subspan(static_cast<std::size_t>(first - held.begin()));
}

/// The pair of this key, or null; and no pair before it any more.
template <class Held>
static const Held* pass_to(std::uint64_t key, std::span<const Held>& held) {
  std::size_t passed = 0;
  while (passed < held.size() && held[passed].key < key) ++passed;
  held = held.subspan(passed);
  return !held.empty() && held.front().key == key ? &held.front() : nullptr;
}

PairMemory<3>::PairMemory(const WorldState<3>& state, const HeldPairs<3>& before, std::uint64_t key,
                          HeldPairs<3>& now)
    : state_(state),
      parted_(from_key<PartedPair>(before.parted, key)),
      manifolds_(from_key<HeldManifold>(before.manifolds, key)),
      now_(now) {}

/// Along any direction that one of the bodies carries, the points of the other have moved by
///   |p - p0| + |R - R0| reach <= |p - p0| + 2 |q - q0| reach
/// at most since it was told, which is no more than the root of twice the sum of the squares.
bool PairMemory<3>::is_parted(std::uint64_t key, const Pose<3>& relative, float margin) {
  const PartedPair* known = pass_to(key, parted_);
  if (known == nullptr) return false;
  const float left = known->gap - margin;
  const Vec<3> moved = relative.position - known->relative.position;
  const Rotation<3> turned = (2.0f * known->reach) * (relative.rotation - known->relative.rotation);
  if (!(left > 0.0f && 2.0f * (dot(moved, moved) + dot(turned, turned)) < left * left))
    return false;
  now_.parted.push_back(*known);
  return true;
}

/// Of a face of the body that carries the frame the points of the other turn about its own centre;
/// of a face of the other, all that this one reaches to turns about that. What is held of the gap
/// is what rounding leaves of it, to the grid and of positions and rotations, some 1e-6 of lengths.
bool PairMemory<3>::find_parted(const PlacedPair<3>& pair, std::uint64_t key, const CellGrid& grid,
                                const Pose<3>& relative, float margin) {
  constexpr float kRounding = 1.0e-5f;
  const Shape<3>& a = shape_a_of(state_, pair);
  const Shape<3>& b = shape_b_of(state_, pair);
  if (!may_be_parted(a, b)) return false;
  const float all = length(relative.position) + grid.reach + grid.far_reach;
  const float asked = margin + moved_by_rounding(grid, grid.reach) + kRounding * all;
  const FaceGap found = gap_beside_a_face(a, b, pair, grid.b_carries, state_.polyhedra, asked);
  const float reach = found.of_b == grid.b_carries ? grid.reach : all;
  const float gap = found.gap - moved_by_rounding(grid, reach) - kRounding * all;
  if (!(gap > margin)) return false;
  now_.parted.push_back({key, relative, gap, reach});
  return true;
}

/// To the bit, so that a zero is no other one.
static bool are_same(const Pose<3>& one, const Pose<3>& other) {
  static_assert(sizeof(Pose<3>) == 7 * sizeof(float));
  return std::memcmp(&one, &other, sizeof one) == 0;
}

void PairMemory<3>::collide(const PlacedPair<3>& pair, Manifold<3>& manifold) {
  const std::uint64_t key = ShapePair{pair.shape_a, pair.shape_b}.key();
  const CellGrid grid = grid_of_pair(state_, pair);
  const Pose<3> relative = relative_pose(grid, pair);
  const float margin = rounded_margin(pair.margin, state_.header.tuning.speculative_distance);
  manifold.point_count = 0;
  if (is_parted(key, relative, margin)) return;
  const HeldManifold* known = pass_to(key, manifolds_);
  // What had points will nearly always have some again.
  const bool had_points = known != nullptr && known->manifold.point_count > 0;
  const Pose<3> cell = rounded(grid, relative);
  if (known != nullptr && known->margin == margin && are_same(known->cell, cell)) {
    now_.manifolds.push_back(*known);
  } else {
    if (!had_points && find_parted(pair, key, grid, relative, margin)) return;
    now_.manifolds.push_back(
        {key, cell, margin, collide_rounded(state_, pair, grid, cell, margin)});
  }
  move_from_cell(now_.manifolds.back().manifold, grid, cell, relative, pair, manifold);
}

}  // namespace cycloid::solver
