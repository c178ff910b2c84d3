#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "solver/collision/manifold.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// What a query looks at. A shape is met where (shape.category & filter.mask) and
/// (filter.category & shape.mask); the rule of groups is that of Filter.
struct QueryFilter {
  Filter filter;
  BodyId ignore;  ///< A body that is not there for the query; index kNone: nobody.
};

/// One shape met by a query.
template <int D>
struct QueryHit {
  BodyId body;
  std::uint32_t shape = 0;  ///< Of the shape within its body: Shape::ordinal.
  Vec<D> point;             ///< World, m, on the surface of the shape met.
  Vec<D> normal;            ///< Unit, outwards from the shape met.
  float fraction = 0.0f;    ///< Of the way of a cast, 0 to 1; other queries: 0.
  float separation = 0.0f;  ///< m, negative inside; ray casts: 0.
};

/// A convex probe: a hull of 1 to Dim<D>::kVertices points rounded by `radius` [m]: a ball is one
/// point, a capsule two, a polygon 3 to 8 in counter-clockwise order and convex. In space a hull
/// has 4 to 64 corners in any order; a box has 8.
template <int D>
struct Probe {
  std::uint32_t count = 1;
  float radius = 0.0f;
  std::array<Vec<D>, Dim<D>::kVertices> points{};  ///< Frame of the probe's pose, m.
};

/// The probe as a shape: kind by its number of points, edge normals filled, default filter. It
/// belongs to no body; its pose takes the place of a body's centre of mass.
/// @pre as in Probe; neighbouring points differ; in space a ball or a capsule.
template <int D>
Shape<D> shape_of(const Probe<D>& probe);

// What all queries share: world frame, SI units; nothing is changed; the result is a pure function
// of the arguments. A segment of a chain is met from its free side only, and where it continues
// into a neighbour only with normals between the two segments', so that nothing stumbles over the
// joints of a smooth chain. Positions are taken relative to the query's own, so precision does not
// depend on where in the world it lies. @pre all arguments are finite.

/// Every shape that the straight way `from` to `to` enters, in the order of shape slots: where it
/// enters first. A ray that starts inside of a shape meets it at fraction 0 with point `from` and
/// the normal against the ray (without length: away from the nearest surface). Tangents do not hit.
template <int D>
std::vector<QueryHit<D>> ray_cast(const WorldState<D>& state, const Vec<D>& from, const Vec<D>& to,
                                  const QueryFilter& filter);

/// The hit of `ray_cast` with the smallest fraction; of equal ones the lowest shape slot. Nothing
/// where no shape is hit.
template <int D>
std::optional<QueryHit<D>> ray_cast_first(const WorldState<D>& state, const Vec<D>& from,
                                          const Vec<D>& to, const QueryFilter& filter);

/// Every shape closer than `margin` [m] to the probe at `pose`, in the order of shape slots. One
/// hit per shape: its point deepest in, or nearest to, the probe; normal towards the probe. Of a
/// chain every segment that close on its free side counts.
template <int D>
std::vector<QueryHit<D>> overlap(const WorldState<D>& state, const Probe<D>& probe,
                                 const Pose<D>& pose, float margin, const QueryFilter& filter);

/// Every shape that the probe meets when it moves from `pose` along `translation` [m] without
/// turning, in the order of shape slots, at the fraction of first contact. A shape that the probe
/// overlaps at the start is met at fraction 0, with that separation, if the way leads deeper in
/// (dot(normal, translation) < 0), and otherwise not at all. Exact up to rounding: no iteration.
///
/// In space that holds for rays and for balls against balls and capsules. Other casts advance by
/// their distance, at most 48 times: they stop at most 1e-5 m + 2e-6 of the shapes' size before the
/// contact (grazing ways earlier), not after it, and never miss one that goes deeper than that.
///
/// The first contact is where the ray along `translation` enters the rounded Minkowski difference
/// of the two. Source: van den Bergen, "Ray Casting against General Convex Objects" (2004).
template <int D>
std::vector<QueryHit<D>> shape_cast(const WorldState<D>& state, const Probe<D>& probe,
                                    const Pose<D>& pose, const Vec<D>& translation,
                                    const QueryFilter& filter);

/// The hit of `shape_cast` with the smallest fraction; of equal ones the lowest shape slot.
/// Nothing where the way is free.
template <int D>
std::optional<QueryHit<D>> shape_cast_first(const WorldState<D>& state, const Probe<D>& probe,
                                            const Pose<D>& pose, const Vec<D>& translation,
                                            const QueryFilter& filter);

/// The surface point nearest to `point`, of the shapes whose surface is at most `distance_max` [m]
/// away from inside or outside; of equal distances the lowest shape slot. Chains count on their
/// free side only. Nothing where no surface is that near.
template <int D>
std::optional<QueryHit<D>> closest_point(const WorldState<D>& state, const Vec<D>& point,
                                         float distance_max, const QueryFilter& filter);

}  // namespace cycloid::solver
