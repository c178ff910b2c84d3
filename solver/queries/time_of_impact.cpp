#include "solver/queries/time_of_impact.hpp"

#include "solver/queries/separation.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

static Rotation<2> rotation_by(const Vec<1>& turn) {
  Rotation<2> rotation;
  sin_cos(turn[0], rotation[1], rotation[0]);
  return rotation;
}
static Rotation<3> rotation_by(const Vec<3>& turn) {
  const float angle = length(turn);
  float sine = 0.0f;
  float cosine = 1.0f;
  sin_cos(0.5f * angle, sine, cosine);
  const Vec<3> axis = normalized_or(turn, Vec<3>::zero());
  return {{sine * axis[0], sine * axis[1], sine * axis[2], cosine}};
}

template <int D>
Pose<D> pose_at(const BodySweep<D>& sweep, float fraction) {
  return {sweep.start.position + fraction * sweep.translation,
          compose(rotation_by(fraction * sweep.turn), sweep.start.rotation)};
}

/// What moves a core: the place of its centre now, and its motion per whole way.
template <int D>
struct Mover {
  Core<D> core;
  Vec<D> centre;
  Vec<D> translation;
  Spin<D> turn;
  float turn_rate;
  float reach;  ///< Of the farthest vertex from the centre, m.

  Vec<D> velocity_at(const Vec<D>& point) const {
    return translation + spin_cross(turn, point - centre);
  }
};

template <int D>
static Mover<D> mover_at(const Shape<D>& shape, const BodySweep<D>& sweep, const Vec<D>& offset,
                         float fraction, const Polyhedra& polyhedra) {
  // Relative to where body a starts, so that the world position costs no digits.
  const Vec<D> centre = offset + fraction * sweep.translation;
  const Rotation<D> rotation = pose_at(sweep, fraction).rotation;
  Mover<D> mover{core_of(shape, rotation, centre, polyhedra),
                 centre,
                 sweep.translation,
                 sweep.turn,
                 length(sweep.turn),
                 0.0f};
  for (std::uint32_t i = 0; i < mover.core.count; ++i)
    mover.reach = max(mover.reach, length(mover.core.vertices[i] - centre));
  return mover;
}

/// How a surface lies along an axis and moves: `turning` [m per way^2] bounds its acceleration.
struct Support {
  float height;
  float speed;
  float turning;
  float turn_speed;  ///< Bound of the part of any speed that comes from turning.
};

template <int D>
static Support support_of(const Mover<D>& mover, std::uint32_t i, const Vec<D>& axis) {
  if (mover.core.half_space())
    return {mover.core.offset * dot(axis, mover.core.normal), dot(axis, mover.translation), 0.0f,
            0.0f};
  const Vec<D> vertex = mover.core.vertices[i];
  const float arm = length(vertex - mover.centre);
  return {dot(axis, vertex), dot(axis, mover.velocity_at(vertex)),
          mover.turn_rate * mover.turn_rate * arm, mover.turn_rate * arm};
}

/// How long a gap of `room` >= 0 lasts at the least that opens at `speed` and whose speed changes
/// by at most `turning`: the first root of room + speed t - turning t^2 / 2.
static float time_to_close(float room, float speed, float turning) {
  const float root = sqrt(speed * speed + 2.0f * turning * room);
  if (speed < -1.0e-12f) return 2.0f * room / (root - speed);
  return turning > 1.0e-12f ? (max(speed, 0.0f) + root) / turning : 2.0f;
}

/// The part of the way in which the gap along `axis` surely stays above `level`; 2 and more: for
/// ever.
template <int D>
static float safe_step(const Mover<D>& a, const Mover<D>& b, const Vec<D>& axis, float level) {
  float step = 2.0f;
  const std::uint32_t count_a = a.core.half_space() ? 1 : a.core.count;
  const std::uint32_t count_b = b.core.half_space() ? 1 : b.core.count;
  const float radius = a.core.radius + b.core.radius;
  for (std::uint32_t i = 0; i < count_a; ++i) {
    const Support from = support_of(a, i, axis);
    for (std::uint32_t j = 0; j < count_b; ++j) {
      const Support to = support_of(b, j, axis);
      const float room = max(to.height - from.height - radius - level, 0.0f);
      const float parabola = time_to_close(room, to.speed - from.speed, to.turning + from.turning);
      // For long steps of fast spins the greatest speed is the better bound.
      const float line = time_to_close(
          room, dot(axis, b.translation - a.translation) - to.turn_speed - from.turn_speed, 0.0f);
      step = min(step, max(parabola, line));
    }
  }
  return step;
}

/// Whether the two may touch where they are nearest: not from behind a segment.
template <int D>
static bool may_touch(const Core<D>& a, const Core<D>& b, const Separation<D>& between) {
  return allows(a, between.normal) && allows(b, -between.normal);
}

template <int D>
static bool never_meet(const Shape<D>& a, const Shape<D>& b) {
  const auto surface = [](const Shape<D>& shape) {
    return shape.kind == ShapeKind::kSegment || shape.kind == ShapeKind::kHalfSpace;
  };
  return surface(a) && surface(b);
}

template <int D>
Impact time_of_impact(const Shape<D>& a, const BodySweep<D>& sweep_a, const Shape<D>& b,
                      const BodySweep<D>& sweep_b, float target, float tolerance,
                      const Polyhedra& polyhedra) {
  constexpr int kSteps = 64;
  if (never_meet(a, b)) return {};
  const Vec<D> a_to_b = sweep_b.start.position - sweep_a.start.position;
  const bool one_sided = a.kind == ShapeKind::kSegment || b.kind == ShapeKind::kSegment;
  const float level = target - 0.5f * tolerance;
  float fraction = 0.0f;
  bool stopped_before = false;
  for (int i = 0; i < kSteps; ++i) {
    const Mover<D> mover_a = mover_at(a, sweep_a, Vec<D>::zero(), fraction, polyhedra);
    const Mover<D> mover_b = mover_at(b, sweep_b, a_to_b, fraction, polyhedra);
    const float speed_max = length(sweep_b.translation - sweep_a.translation) +
                            mover_a.turn_rate * mover_a.reach + mover_b.turn_rate * mover_b.reach;
    if (speed_max <= 1.0e-12f) return {};
    const Separation<D> between = separation_of(mover_a.core, mover_b.core);
    // What lies across a segment on the way has come from behind.
    const bool from_behind = one_sided && between.crossing && i > 0;
    const bool meets = !from_behind && may_touch(mover_a.core, mover_b.core, between);
    // A step this short changes the distance by a quarter of the tolerance at most.
    const float quarter = 0.25f * tolerance;
    float step = quarter / speed_max;
    if (meets) {
      const float lowest = min(level, between.distance - quarter);
      step = max(step, safe_step(mover_a, mover_b, between.normal, lowest));
    } else if (between.distance > target) {
      step = max(step, safe_step(mover_a, mover_b, between.normal, target));
    } else {
      // To get clear of a segment from behind takes this long at the least.
      step = max(step, (target - between.distance) / speed_max);
    }
    if (fraction + step >= 1.0f) return {};
    const float speed = dot(between.normal, mover_b.velocity_at(between.point_b) -
                                                mover_a.velocity_at(between.point_a));
    if (meets && between.distance <= target && speed < 0.0f) return {true, fraction};
    stopped_before = meets && between.distance >= level;
    fraction = fraction + step;
  }
  return stopped_before ? Impact{true, fraction} : Impact{};
}

template Pose<2> pose_at(const BodySweep<2>&, float);
template Pose<3> pose_at(const BodySweep<3>&, float);
template Impact time_of_impact(const Shape<2>&, const BodySweep<2>&, const Shape<2>&,
                               const BodySweep<2>&, float, float, const Polyhedra&);
template Impact time_of_impact(const Shape<3>&, const BodySweep<3>&, const Shape<3>&,
                               const BodySweep<3>&, float, float, const Polyhedra&);

}  // namespace cycloid::solver
