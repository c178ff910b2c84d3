#include "solver/queries/time_of_impact.hpp"

#include "solver/collision/collide.hpp"
#include "solver/motion.hpp"

namespace cycloid::solver {

static constexpr int kAdvancesMax = 48;
/// Shapes of a bounded world are never farther apart than this, m.
static constexpr float kFar = 1.0e9f;

template <int D>
Pose<D> pose_at(const BodySweep<D>& sweep, float fraction) {
  const bool turns = dot(sweep.turn, sweep.turn) > 0.0f;
  const Rotation<D>& start = sweep.start.rotation;
  return {sweep.start.position + fraction * sweep.translation,
          turns ? normalized_or(compose(rotation_by(fraction * sweep.turn), start), start) : start};
}

/// Farthest point of a shape from its body's centre of mass, m.
template <int D>
static float reach_of(const Shape<D>& shape) {
  float reach = 0.0f;
  for (std::uint32_t v = 0; v < shape.vertex_count; ++v)
    reach = max(reach, length(shape.vertices[v]));
  return reach + shape.radius;
}

/// An edge of a chain alone, as a capsule: what collide() leaves to its neighbours is theirs at one
/// place, but a way leads past many.
template <int D>
static Shape<D> alone(Shape<D> shape) {
  if (shape.kind == ShapeKind::kSegment) {
    shape.kind = ShapeKind::kCapsule;
    shape.ghosts = 0;
  }
  return shape;
}

/// The gap along the axis that collide() chose.
template <int D>
static float gap_of(const Manifold<D>& manifold) {
  float gap = manifold.points[0].separation;
  for (std::uint32_t i = 1; i < manifold.point_count; ++i)
    gap = min(gap, manifold.points[i].separation);
  return gap;
}

template <int D>
static bool from_behind(const Shape<D>& edge, const Pose<D>& pose, const Vec<D>& outwards) {
  return edge.kind == ShapeKind::kSegment &&
         dot(rotate(pose.rotation, edge.normals[0]), outwards) < 0.0f;
}

template <int D>
static Impact<D> impact_at(float fraction, const Pose<D>& pose_a, const Manifold<D>& manifold,
                           float gap) {
  const ManifoldPoint<D>* nearest = &manifold.points[0];
  for (std::uint32_t i = 1; i < manifold.point_count; ++i)
    if (manifold.points[i].separation < nearest->separation) nearest = &manifold.points[i];
  // A point of a manifold lies midway between the surfaces.
  const Vec<D> point =
      pose_a.position + nearest->anchor_a - (0.5f * nearest->separation) * manifold.normal;
  return {true, fraction, manifold.normal, point, gap};
}

template <int D>
Impact<D> time_of_impact(const Shape<D>& a, const BodySweep<D>& sweep_a, const Shape<D>& b,
                         const BodySweep<D>& sweep_b, float target, float tolerance) {
  const Shape<D> shape_a = alone(a);
  const Shape<D> shape_b = alone(b);
  const float turning =
      length(sweep_a.turn) * reach_of(shape_a) + length(sweep_b.turn) * reach_of(shape_b);
  const Vec<D> way = sweep_b.translation - sweep_a.translation;
  float fraction = 0.0f;
  for (int i = 0; i < kAdvancesMax; ++i) {
    const Pose<D> pose_a = pose_at(sweep_a, fraction);
    const Pose<D> pose_b = pose_at(sweep_b, fraction);
    const Manifold<D> manifold = collide(shape_a, pose_a, shape_b, pose_b, kFar);
    if (manifold.point_count == 0) return {};
    const float gap = gap_of(manifold);
    const float approach = -dot(manifold.normal, way);
    if (gap <= target + tolerance) {
      const bool leaves = fraction == 0.0f && approach + turning <= 0.0f;
      const bool behind =
          from_behind(a, pose_a, manifold.normal) || from_behind(b, pose_b, -manifold.normal);
      if (leaves || behind) return {};
      return impact_at(fraction, pose_a, manifold, gap);
    }
    const float rate = max(approach, 0.0f) + turning;
    if (rate <= 0.0f || (gap - target) > rate * (1.0f - fraction)) return {};
    fraction += (gap - target) / rate;
    if (i + 1 == kAdvancesMax) return impact_at(fraction, pose_a, manifold, gap);
  }
  return {};
}

template Pose<2> pose_at(const BodySweep<2>&, float);
template Pose<3> pose_at(const BodySweep<3>&, float);
template Impact<2> time_of_impact(const Shape<2>&, const BodySweep<2>&, const Shape<2>&,
                                  const BodySweep<2>&, float, float);
template Impact<3> time_of_impact(const Shape<3>&, const BodySweep<3>&, const Shape<3>&,
                                  const BodySweep<3>&, float, float);

}  // namespace cycloid::solver
