#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "solver/collision/manifold.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// Questions about a state that change nothing in it. Answers are in the order of the shapes'
/// slots, which is that of their creation; of equals the lowest slot comes first. They depend on
/// the state alone, so every peer gets the same bits. Cost: a test of bounds per shape.

/// Which shapes a query meets: as if it were a shape with this filter. `ignore` is left out.
struct QueryFilter {
  Filter filter;
  BodyId ignore;  ///< index kNone: nobody.
};

/// One shape met by a query.
template <int D>
struct QueryHit {
  BodyId body;
  std::uint32_t shape = 0;  ///< Index within the body.
  Vec<D> point;             ///< On the surface of the shape met, world, m.
  Vec<D> normal;            ///< Unit, outwards from the shape met.
  float fraction = 0.0f;    ///< Of the cast's way, 0 to 1; 0 for other queries.
  float separation = 0.0f;  ///< m, negative inside; 0 for ray casts.
};

/// A convex shape that is not in the world: 1 to Dim<D>::kVertices points, rounded by the radius.
/// One point is a ball, two a capsule, more a counter-clockwise polygon.
template <int D>
struct Probe {
  std::uint32_t count = 1;
  float radius = 0.0f;  ///< m, >= 0.
  std::array<Vec<D>, Dim<D>::kVertices> points{};
};

/// The probe as a shape record, as collide() takes it.
template <int D>
Shape<D> shape_of(const Probe<D>& probe);

/// Every shape on the way from `from` to `to`. A ray that starts inside a shape meets it at
/// fraction 0 with the normal against the ray; chain edges are met from their free side only.
template <int D>
std::vector<QueryHit<D>> ray_cast(const WorldState<D>& state, const Vec<D>& from, const Vec<D>& to,
                                  const QueryFilter& filter);
/// The first of them; nothing where the way is free.
template <int D>
std::optional<QueryHit<D>> ray_cast_first(const WorldState<D>& state, const Vec<D>& from,
                                          const Vec<D>& to, const QueryFilter& filter);

/// Every shape closer than `margin` [m] to the probe, each with its deepest point. The normal
/// points to the probe.
template <int D>
std::vector<QueryHit<D>> overlap(const WorldState<D>& state, const Probe<D>& probe,
                                 const Pose<D>& pose, float margin, const QueryFilter& filter);

/// Every shape that the probe meets on its way along `translation`, without turning. A probe that
/// overlaps a shape at the start meets it at 0 where it moves deeper, and not where it leaves.
template <int D>
std::vector<QueryHit<D>> shape_cast(const WorldState<D>& state, const Probe<D>& probe,
                                    const Pose<D>& pose, const Vec<D>& translation,
                                    const QueryFilter& filter);
template <int D>
std::optional<QueryHit<D>> shape_cast_first(const WorldState<D>& state, const Probe<D>& probe,
                                            const Pose<D>& pose, const Vec<D>& translation,
                                            const QueryFilter& filter);

/// The nearest point of any surface within `distance_max` [m]; `separation` is the distance,
/// negative for a point inside. Nothing where nothing is so near.
template <int D>
std::optional<QueryHit<D>> closest_point(const WorldState<D>& state, const Vec<D>& point,
                                         float distance_max, const QueryFilter& filter);

}  // namespace cycloid::solver
