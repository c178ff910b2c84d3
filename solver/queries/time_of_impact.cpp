#include "solver/queries/time_of_impact.hpp"

#include "solver/motion.hpp"
#include "solver/queries/four_points.hpp"
#include "solver/queries/separation.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

template <int D>
Pose<D> pose_at(const BodySweep<D>& sweep, float fraction) {
  if (fraction == 0.0f) return sweep.start;
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
  std::array<float, Dim<D>::kVertices> arms;  ///< Of vertices from the centre, m.
  float reach;                                ///< The longest of them.

  Vec<D> velocity_at(const Vec<D>& point) const {
    return translation + spin_cross(turn, point - centre);
  }
};

static void measure_arms(Mover<3>& mover) {
  float reach = 0.0f;
  for (std::uint32_t i = 0; i < mover.core.count; ++i) {
    mover.arms[i] = length(mover.core.vertices[i] - mover.centre);
    reach = max(reach, mover.arms[i]);
  }
  mover.reach = reach;
}
/// Of what stands behind the last vertex the arm is that of the first, which makes none longer.
static void measure_arms(Mover<2>& mover) {
  FourFloats reach = FourFloats(0.0f);
  const std::uint32_t count = mover.core.count;
  for (std::uint32_t first = 0; first < count; first += 4) {
    const FourFloats arms =
        length(load_four_of(mover.core.vertices, first, count) - four_of(mover.centre));
    arms.store(&mover.arms[first]);
    reach = max(reach, arms);
  }
  for (int lane = 0; lane < 4; ++lane) mover.reach = max(mover.reach, reach.raw[lane]);
}

/// Where it is at a fraction of its way, relative to where body a starts, so that the world
/// position costs no digits.
template <int D>
static void put_at(Mover<D>& mover, const Shape<D>& shape, const BodySweep<D>& sweep,
                   const Vec<D>& offset, float fraction, const Polyhedra& polyhedra) {
  mover.centre = offset + fraction * sweep.translation;
  mover.core = core_of(shape, pose_at(sweep, fraction).rotation, mover.centre, polyhedra);
}

/// At the start of its way.
template <int D>
static Mover<D> mover_of(const Shape<D>& shape, const BodySweep<D>& sweep, const Vec<D>& offset,
                         const Polyhedra& polyhedra) {
  Mover<D> mover{{}, {}, sweep.translation, sweep.turn, length(sweep.turn), {}, 0.0f};
  put_at(mover, shape, sweep, offset, 0.0f, polyhedra);
  measure_arms(mover);
  return mover;
}

/// Whether it stays where it is. Most fast bodies meet what is static.
template <int D>
static bool rests(const Mover<D>& mover) {
  return dot(mover.translation, mover.translation) == 0.0f && mover.turn_rate == 0.0f;
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
  const float arm = mover.arms[i];
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

/// The vertices of a core along an axis.
template <int D>
struct Outline {
  std::uint32_t count = 0;
  std::array<Support, Dim<D>::kVertices> supports;
};

template <int D>
static Outline<D> outline_of(const Mover<D>& mover, const Vec<D>& axis) {
  Outline<D> outline;
  outline.count = mover.core.half_space() ? 1 : mover.core.count;
  for (std::uint32_t i = 0; i < outline.count; ++i)
    outline.supports[i] = support_of(mover, i, axis);
  return outline;
}

/// Whether a gap of `room` that closes at the speed -`speed` at most surely lasts for `time`.
static bool surely_lasts(float room, float speed, float time) {
  return speed >= -1.0e-12f || room > -1.0001f * (time * speed);
}

/// The part of the way in which the gap along `axis` surely stays above `level`; 2 and more: for
/// ever. The least over all pairs of vertices of the later of two times: with turning as a bound of
/// the acceleration, and, which is better for long steps of fast spins, of the speed. So where the
/// second is late enough the first, which takes a root, is not asked for.
static float safe_step(const Mover<2>& a, const Mover<2>& b, const Vec<2>& axis, float level) {
  float step = 2.0f;
  const Outline<2> outline_a = outline_of(a, axis);
  const Outline<2> outline_b = outline_of(b, axis);
  const float radius = a.core.radius + b.core.radius;
  const float way = dot(axis, b.translation - a.translation);
  for (std::uint32_t i = 0; i < outline_a.count; ++i) {
    const Support& from = outline_a.supports[i];
    for (std::uint32_t j = 0; j < outline_b.count; ++j) {
      const Support& to = outline_b.supports[j];
      const float room = max(to.height - from.height - radius - level, 0.0f);
      const float speed_min = way - to.turn_speed - from.turn_speed;
      if (surely_lasts(room, speed_min, step)) continue;
      const float line = time_to_close(room, speed_min, 0.0f);
      if (line >= step) continue;
      const float parabola = time_to_close(room, to.speed - from.speed, to.turning + from.turning);
      step = min(step, max(parabola, line));
    }
  }
  return step;
}

/// Of the heights after `time` the one that reaches farthest: `side` 1: upwards, -1: downwards.
static const Support& farthest_after(const Outline<3>& outline, float side, float time) {
  std::uint32_t best = 0;
  float highest = -3.0e38f;
  for (std::uint32_t i = 0; i < outline.count; ++i) {
    const Support& support = outline.supports[i];
    const float height =
        side * (support.height + time * support.speed) + 0.5f * time * time * support.turning;
    if (height <= highest) continue;
    highest = height;
    best = i;
  }
  return outline.supports[best];
}

/// How long no pair of vertices closes its gap: as the least `time_to_close` over all pairs, but
/// only of those that are nearest at a time already found. Each such pair shortens the time until
/// the pair that is nearest then has just closed; where that takes too many, all pairs are asked.
static float time_until_close(const Outline<3>& a, const Outline<3>& b, float clearance) {
  constexpr int kRounds = 16;
  const auto time_of = [&](const Support& from, const Support& to) {
    const float room = max(to.height - from.height - clearance, 0.0f);
    return time_to_close(room, to.speed - from.speed, to.turning + from.turning);
  };
  float time = 2.0f;
  for (int round = 0; round < kRounds; ++round) {
    const Support& from = farthest_after(a, 1.0f, time);
    const Support& to = farthest_after(b, -1.0f, time);
    const float closes = time_of(from, to);
    if (!(closes < time)) return time;
    time = closes;
  }
  for (std::uint32_t i = 0; i < a.count; ++i)
    for (std::uint32_t j = 0; j < b.count; ++j)
      time = min(time, time_of(a.supports[i], b.supports[j]));
  return time;
}

/// Every vertex at the greatest speed its turning can have: for long steps of fast spins the better
/// bound. `side` as above.
static Outline<3> without_curve(const Mover<3>& mover, const Vec<3>& axis, float side,
                                const Outline<3>& outline) {
  Outline<3> straight = outline;
  const float speed = dot(axis, mover.translation);
  for (std::uint32_t i = 0; i < outline.count; ++i) {
    straight.supports[i].speed = speed + side * outline.supports[i].turn_speed;
    straight.supports[i].turning = 0.0f;
  }
  return straight;
}

static float safe_step(const Mover<3>& a, const Mover<3>& b, const Vec<3>& axis, float level) {
  const Outline<3> from = outline_of(a, axis);
  const Outline<3> to = outline_of(b, axis);
  const float clearance = a.core.radius + b.core.radius + level;
  const float parabola = time_until_close(from, to, clearance);
  if (parabola >= 2.0f) return parabola;
  const float line = time_until_close(without_curve(a, axis, 1.0f, from),
                                      without_curve(b, axis, -1.0f, to), clearance);
  return max(parabola, line);
}

/// Whether the two may touch where they are nearest: not from behind a segment.
template <int D>
static bool may_touch(const Core<D>& a, const Core<D>& b, const Separation<D>& between) {
  return allows(a, between.normal) && allows(b, -between.normal);
}

static bool one_sided(ShapeKind kind) {
  return kind == ShapeKind::kSegment || kind == ShapeKind::kTriangle;
}

static bool never_meet(ShapeKind a, ShapeKind b) {
  const auto surface = [](ShapeKind kind) {
    return one_sided(kind) || kind == ShapeKind::kHalfSpace;
  };
  return surface(a) && surface(b);
}

template <int D>
Impact time_of_impact(const Shape<D>& a, const BodySweep<D>& sweep_a, const Shape<D>& b,
                      const BodySweep<D>& sweep_b, float target, float tolerance,
                      const Polyhedra& polyhedra) {
  constexpr int kSteps = 64;
  if (never_meet(a.kind, b.kind)) return {};
  const Vec<D> a_to_b = sweep_b.start.position - sweep_a.start.position;
  const bool sided = one_sided(a.kind) || one_sided(b.kind);
  const float level = target - 0.5f * tolerance;
  float fraction = 0.0f;
  bool stopped_before = false;
  Mover<D> mover_a = mover_of(a, sweep_a, Vec<D>::zero(), polyhedra);
  Mover<D> mover_b = mover_of(b, sweep_b, a_to_b, polyhedra);
  const float speed_max = length(sweep_b.translation - sweep_a.translation) +
                          mover_a.turn_rate * mover_a.reach + mover_b.turn_rate * mover_b.reach;
  if (speed_max <= 1.0e-12f) return {};
  const bool a_moves = !rests(mover_a);
  const bool b_moves = !rests(mover_b);
  for (int i = 0; i < kSteps; ++i) {
    if (i > 0 && a_moves) put_at(mover_a, a, sweep_a, Vec<D>::zero(), fraction, polyhedra);
    if (i > 0 && b_moves) put_at(mover_b, b, sweep_b, a_to_b, fraction, polyhedra);
    const Separation<D> between = separation_of(mover_a.core, mover_b.core);
    // What lies across a segment on the way has come from behind.
    const bool from_behind = sided && between.crossing && i > 0;
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
