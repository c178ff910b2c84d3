#include "tests/oracle/pairs.hpp"

#include <algorithm>
#include <limits>

namespace cycloid::oracle {

using solver::Pose;

static constexpr double kTouching = 1e-5;  ///< m.

double Pair::scale() const {
  return std::max({1.0, a->size, b->size});
}

Placement placement_in(const Pair& pair, const Pose<3>& pose) {
  const Vector imaginary = {pose.rotation[0], pose.rotation[1], pose.rotation[2]};
  const double real = pose.rotation[3];
  const double scale = 1.0 / std::sqrt(dot(imaginary, imaginary) + real * real);
  const Vector position = to_double(pose.position) - to_double(pair.pose_a.position);
  return {position, scale * imaginary, scale * real};
}

PlacedPair place(const Pair& pair) {
  const Placement at_a = placement_in(pair, pair.pose_a);
  const Placement at_b = placement_in(pair, pair.pose_b);
  PlacedPair bodies{placed(pair.a->body, at_a), placed(pair.b->body, at_b), {}};
  if (is_fixed(pair.a->kind)) bodies.normal = at_a.turn(pair.a->normal);
  if (is_fixed(pair.b->kind)) bodies.normal = at_b.turn(pair.b->normal);
  return bodies;
}

Truth truth_of(const Pair& pair, const PlacedPair& bodies) {
  Truth truth;
  if (pair.a->kind == Kind::kHalfSpace || pair.b->kind == Kind::kHalfSpace) {
    const Vector& normal = bodies.normal;
    const Vector direction = pair.a->kind == Kind::kHalfSpace ? normal : -normal;
    truth.gap = {gap_along(bodies.a, bodies.b, direction), direction};
    truth.lower = truth.gap.value;
    return truth;
  }
  const Distance apart = distance(bodies.a, bodies.b);
  const double radii = bodies.a.radius + bodies.b.radius;
  // Of bodies that all but touch the direction is lost in rounding; their gap is not.
  const bool meet = apart.value < kTouching;
  truth.proved = meet || apart.value - apart.lower_bound < 1e-9;
  truth.gap = {apart.value - radii, apart.direction};
  if (meet) truth.gap = widest_gap(bodies.a, bodies.b);
  truth.lower = truth.gap.value;
  const bool near = truth.gap.value < 2 * pair.margin;
  if (!meet && near && !is_round(pair.a->kind) && !is_round(pair.b->kind))
    truth.lower = widest_gap(bodies.a, bodies.b).value;
  return truth;
}

double gap_of(const Pair& pair, const PlacedPair& bodies, const Vector& direction) {
  const bool from_a = pair.a->kind == Kind::kHalfSpace;
  if (from_a || pair.b->kind == Kind::kHalfSpace) {
    const Vector& free = from_a ? bodies.normal : -bodies.normal;
    if (length(free - direction) > 1e-5) return -std::numeric_limits<double>::infinity();
  }
  return gap_along(bodies.a, bodies.b, direction);
}

/// A multiple of 2^-13 m: 1024 m away it is a float still.
static Vector snapped(const Vector& v) {
  return {std::round(v.x * 0x1p13) * 0x1p-13, std::round(v.y * 0x1p13) * 0x1p-13,
          std::round(v.z * 0x1p13) * 0x1p-13};
}

static Pose<3> pose_at(const Vector& position, const Placement& turn) {
  return {to_float(position),
          {{static_cast<float>(turn.imaginary.x), static_cast<float>(turn.imaginary.y),
            static_cast<float>(turn.imaginary.z), static_cast<float>(turn.real)}}};
}

static Vector inner_point(Random& random, const Convex& body) {
  Vector sum;
  double weights = 0.0;
  for (const Vector& corner : body.corners) {
    const double weight = random.within(0.01, 1.0);
    sum = sum + weight * corner;
    weights += weight;
  }
  return (1.0 / weights) * sum;
}

/// A shift of `b` after which the two just touch: towards `a` along a line through inner points of
/// both, until their distance, which is convex along it, is gone.
static Vector touching_shift(Random& random, const Convex& a, const Convex& b) {
  const Vector way = random.direction();
  const Vector start = inner_point(random, a) - inner_point(random, b);
  double along = a.extent() + b.extent() + length(start) + 1.0;
  for (int i = 0; i < 12; ++i) {
    const Gap gap = [&] {
      const Distance apart = distance(a, placed(b, {start + along * way, {}, 1.0}));
      return Gap{apart.value - a.radius - b.radius, apart.direction};
    }();
    const double rate = dot(gap.direction, way);
    if (gap.value < 1e-4 || rate < 1e-6) break;
    along -= gap.value / rate;
  }
  return start + along * way;
}

/// Signed, m: what a pair in general position is to be apart.
static double wanted_gap(Random& random, double smaller_size) {
  const int pick = random.below(10);
  if (pick < 6) return random.within(-0.05, 0.05);
  if (pick < 8) return -smaller_size * random.within(0, 1);
  return random.within(0.05, 2.0);
}

Pair random_pair(Random& random, const Specimen& a, const Specimen& b) {
  Pair pair{&a, &b, {}, {}, random.below(4) == 0 ? 0.1f : 0.02f};
  const Vector base = snapped(random.within(0, 10) * random.direction());
  pair.pose_a = pose_at(base, random.turn());
  pair.pose_b = pose_at(base, random.turn());
  const bool has_half_space = a.kind == Kind::kHalfSpace || b.kind == Kind::kHalfSpace;
  const double smaller = has_half_space ? std::max(a.size, b.size) : std::min(a.size, b.size);
  const bool same_centre = random.below(20) == 0;
  if (same_centre && !has_half_space) return pair;
  PlacedPair bodies = place(pair);
  Vector shift;
  if (!has_half_space) {
    shift = touching_shift(random, bodies.a, bodies.b);
    bodies.b = placed(bodies.b, {shift, {}, 1.0});
  }
  const Gap gap = truth_of(pair, bodies).gap;
  shift = shift + (wanted_gap(random, smaller) - gap.value) * gap.direction;
  if (has_half_space) shift = shift + random.within(0, 1) * perpendicular(gap.direction);
  pair.pose_b = {to_float(snapped(base + shift)), pair.pose_b.rotation};
  return pair;
}

/// Some of the 24 turns that map the axes onto each other, and no turn most often.
static Placement right_turn(Random& random) {
  static constexpr double kHalf = 0.70710678118654752440;
  const double sign = random.below(2) == 0 ? 1.0 : -1.0;
  switch (random.below(8)) {
    case 0:
      return {{}, {sign * kHalf, 0, 0}, kHalf};
    case 1:
      return {{}, {0, sign * kHalf, 0}, kHalf};
    case 2:
      return {{}, {0, 0, sign * kHalf}, kHalf};
    case 3:
      return {{}, {0.5, sign * 0.5, 0.5}, 0.5};
    case 4:
      return {{}, {0, 0, 1}, 0};
    default:
      return {};
  }
}

/// Off by a turn between 1e-7 and 0.01 rad.
static Placement little_turn(Random& random) {
  return turned(random.direction(), random.log_within(1e-7, 0.01));
}

Pair regular_pair(Random& random, const Specimen& a, const Specimen& b) {
  Pair pair{&a, &b, {}, {}, random.below(4) == 0 ? 0.1f : 0.02f};
  const Vector base = {1.0 * random.below(9), 1.0 * random.below(9), 1.0 * random.below(9)};
  pair.pose_a = pose_at(base, right_turn(random));
  pair.pose_b = pose_at(base, random.below(4) == 0 ? little_turn(random) : right_turn(random));
  if (random.below(8) == 0) return pair;
  const PlacedPair bodies = place(pair);
  // Features meet, with no gap, a little one, or a little overlap, along an axis of the grid.
  const Vector axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  Vector shift;
  const int touching = random.below(3);
  for (int axis = 0; axis < 3; ++axis) {
    const double sign = random.below(2) == 0 ? 1.0 : -1.0;
    const double reach = -gap_along(bodies.a, bodies.b, sign * axes[axis]);
    const double slack = random.below(2) == 0 ? 0.0 : 0x1p-7 * random.within(-1, 1);
    const double share = axis == touching ? 1.0 : 0.25 * random.below(5);
    shift = shift + sign * (share * reach + (axis == touching ? slack : 0.0)) * axes[axis];
  }
  pair.pose_b = {to_float(base + shift), pair.pose_b.rotation};
  return pair;
}

}  // namespace cycloid::oracle
