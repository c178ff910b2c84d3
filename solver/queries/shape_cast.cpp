#include "solver/queries/candidates.hpp"
#include "solver/queries/casting.hpp"
#include "solver/queries/solid_queries.hpp"

namespace cycloid::solver {

/// A cast as the ray from the origin along `translation` against the Minkowski difference of the
/// cores, rounded by both radii: it is where the ray first enters one of its faces or corners.
template <int D>
struct Way {
  Vec<D> translation;
  Vec<D> direction;
  float length;
  float radius;  ///< Of both.
};

/// What a cast has met so far. The first contact counts also where it is not allowed: what comes
/// after it, the probe meets from within, as when it passes a segment from behind.
struct FirstMet {
  Entry<2> best;
  float first = 2.0f;  ///< The least fraction of all, 2 for none.
};

static void offer(const Core<2>& core, float fraction, const Vec<2>& normal, const Vec<2>& point,
                  FirstMet& met) {
  if (!(fraction <= 1.0f)) return;
  met.first = min(met.first, fraction);
  if (met.best.hit && fraction >= met.best.fraction) return;
  if (!allows(core, normal)) return;
  met.best = {true, fraction, normal, point};
}

/// The discs around the differences of vertices.
static void enter_corners(const Core<2>& core, const Core<2>& probe, const Way<2>& way,
                          FirstMet& met) {
  if (way.radius <= 0.0f) return;
  for (std::uint32_t i = 0; i < core.count; ++i)
    for (std::uint32_t j = 0; j < probe.count; ++j) {
      // Split along the way, so that a long way to a small ball keeps its digits.
      const Vec<2> start = probe.vertices[j] - core.vertices[i];
      const float along = dot(start, way.direction);
      const Vec<2> aside = start - along * way.direction;
      const float square = way.radius * way.radius - dot(aside, aside);
      if (square <= 0.0f || along >= 0.0f) continue;
      const float half = sqrt(square);
      const float distance = -along - half;
      if (distance < -kTouch) continue;
      const Vec<2> normal =
          normalized_or((1.0f / way.radius) * (aside - half * way.direction), -way.direction);
      offer(core, max(distance, 0.0f) / way.length, normal, core.vertices[i] + core.radius * normal,
            met);
    }
}

/// Whether the ray from the origin enters the edge from `from` to `to`, which has `normal` outside,
/// pushed out by the radius. The signs of shared ends are computed alike for both their edges, so
/// that no ray slips between two.
static bool enter_face(const Vec<2>& from, const Vec<2>& to, const Vec<2>& normal,
                       const Way<2>& way, float& fraction) {
  const float approach = -dot(normal, way.translation);
  if (approach <= 0.0f) return false;
  const Vec<2> shift = way.radius * normal;
  if (cross(way.direction, from + shift) < 0.0f || cross(way.direction, to + shift) > 0.0f)
    return false;
  const float height = -dot(normal, from) - way.radius;
  if (height < -kTouch || height > approach) return false;
  fraction = max(height, 0.0f) / approach;
  return true;
}

/// A segment's side that is not free counts too: what passes it has come from behind.
static void enter_faces(const Core<2>& core, const Core<2>& probe, const Way<2>& way,
                        FirstMet& met) {
  float fraction = 0.0f;
  const std::uint32_t sides = core.one_sided() ? 2 : core.faces();
  for (std::uint32_t i = 0; i < sides; ++i) {
    const Vec<2> normal = i < core.faces() ? core.normals[i] : -core.normals[0];
    for (std::uint32_t j = 0; j < probe.count; ++j) {
      const Vec<2> from = core.vertices[i] - probe.vertices[j];
      const Vec<2> to = core.vertices[core.next(i)] - probe.vertices[j];
      if (!enter_face(from, to, normal, way, fraction)) continue;
      offer(core, fraction, normal,
            probe.vertices[j] + fraction * way.translation - probe.radius * normal, met);
    }
  }
  for (std::uint32_t j = 0; j < probe.faces(); ++j)
    for (std::uint32_t i = 0; i < core.count; ++i) {
      const Vec<2> from = core.vertices[i] - probe.vertices[j];
      const Vec<2> to = core.vertices[i] - probe.vertices[probe.next(j)];
      const Vec<2> normal = -probe.normals[j];
      if (!enter_face(from, to, normal, way, fraction)) continue;
      offer(core, fraction, normal, core.vertices[i] + core.radius * normal, met);
    }
}

/// Whether the line of the way passes the core, or only touches its outline. The ends of a
/// segment count, because a neighbour may continue there.
static bool passes(const Core<2>& core, const Core<2>& probe, const Way<2>& way) {
  float lowest = 3.0e38f;
  float highest = -3.0e38f;
  for (std::uint32_t i = 0; i < core.count; ++i)
    for (std::uint32_t j = 0; j < probe.count; ++j) {
      const float aside = cross(way.direction, core.vertices[i] - probe.vertices[j]);
      lowest = min(lowest, aside);
      highest = max(highest, aside);
    }
  if (core.one_sided()) return lowest <= way.radius && highest >= -way.radius;
  return lowest < way.radius && highest > -way.radius;
}

static Entry<2> enter_core(const Core<2>& core, const Core<2>& probe, const Vec<2>& translation) {
  FirstMet met{};
  const float way_length = length(translation);
  if (way_length <= 1.0e-12f) return met.best;
  const Way<2> way{translation, (1.0f / way_length) * translation, way_length,
                   core.radius + probe.radius};
  if (!passes(core, probe, way)) return met.best;
  enter_faces(core, probe, way, met);
  enter_corners(core, probe, way, met);
  // Of contacts that only rounding tells apart the one that is allowed counts.
  if (met.best.fraction > met.first + kTouch / way_length) return Entry<2>{};
  return met.best;
}

template <int D>
static Entry<D> enter_half_space(const Core<D>& plane, const Core<D>& probe,
                                 const Vec<D>& translation) {
  const Separation<D> start = separation_of(plane, probe);
  const float approach = -dot(plane.normal, translation);
  Entry<D> entry{};
  if (approach <= 0.0f || start.distance > approach) return entry;
  entry.hit = true;
  entry.fraction = max(start.distance, 0.0f) / approach;
  entry.normal = plane.normal;
  entry.point = start.point_b + entry.fraction * translation;
  return entry;
}

template <int D>
Entry<D> enter(const Core<D>& core, const Core<D>& probe, const Vec<D>& translation) {
  if (core.half_space()) return enter_half_space(core, probe, translation);
  return enter_core(core, probe, translation);
}

template <int D>
Bounds<D> swept_bounds(const Core<D>& probe, const Vec<D>& translation) {
  Bounds<D> bounds{probe.vertices[0], probe.vertices[0]};
  for (std::uint32_t i = 0; i < probe.count; ++i)
    bounds = merged(bounds, {probe.vertices[i], probe.vertices[i]});
  bounds = merged(bounds, {bounds.lower + translation, bounds.upper + translation});
  float extent = 0.0f;
  for (int i = 0; i < D; ++i) extent = max(extent, max(abs(bounds.lower[i]), abs(bounds.upper[i])));
  const float room = probe.radius + bounds_slack(extent);
  for (int i = 0; i < D; ++i) {
    bounds.lower[i] -= room;
    bounds.upper[i] += room;
  }
  return bounds;
}

template <int D>
std::vector<QueryHit<D>> shape_cast(const WorldState<D>& state, const Probe<D>& probe,
                                    const Pose<D>& pose, const Vec<D>& translation,
                                    const QueryFilter& filter) {
  std::vector<QueryHit<D>> hits;
  const Core<D> moving = core_of(probe, pose.rotation);
  const auto cast = [&](const Shape<D>& shape, const Pose<D>& relative) {
    const Core<D> core = core_of(shape, relative.rotation, relative.position, state.polyhedra);
    const Separation<D> start = separation_of(core, moving);
    if (start.distance <= 0.0f && allows(core, start.normal)) {
      if (!(dot(start.normal, translation) < 0.0f)) return;
      const Vec<D> point = surface_point(core, moving, start);
      hits.push_back(hit_of(state, shape, pose.position, point, start.normal));
      hits.back().separation = start.distance;
      return;
    }
    const Entry<D> entry = enter(core, moving, translation);
    if (!entry.hit) return;
    hits.push_back(hit_of(state, shape, pose.position, entry.point, entry.normal));
    hits.back().fraction = entry.fraction;
  };
  for_each_candidate(state, pose.position, swept_bounds(moving, translation), filter, cast);
  return hits;
}

template <int D>
std::optional<QueryHit<D>> shape_cast_first(const WorldState<D>& state, const Probe<D>& probe,
                                            const Pose<D>& pose, const Vec<D>& translation,
                                            const QueryFilter& filter) {
  return earliest(shape_cast(state, probe, pose, translation, filter));
}

template Entry<2> enter(const Core<2>&, const Core<2>&, const Vec<2>&);
template Entry<3> enter(const Core<3>&, const Core<3>&, const Vec<3>&);
template Bounds<2> swept_bounds(const Core<2>&, const Vec<2>&);
template Bounds<3> swept_bounds(const Core<3>&, const Vec<3>&);
template std::vector<QueryHit<2>> shape_cast(const WorldState<2>&, const Probe<2>&, const Pose<2>&,
                                             const Vec<2>&, const QueryFilter&);
template std::vector<QueryHit<3>> shape_cast(const WorldState<3>&, const Probe<3>&, const Pose<3>&,
                                             const Vec<3>&, const QueryFilter&);
template std::optional<QueryHit<2>> shape_cast_first(const WorldState<2>&, const Probe<2>&,
                                                     const Pose<2>&, const Vec<2>&,
                                                     const QueryFilter&);
template std::optional<QueryHit<3>> shape_cast_first(const WorldState<3>&, const Probe<3>&,
                                                     const Pose<3>&, const Vec<3>&,
                                                     const QueryFilter&);

}  // namespace cycloid::solver
