#include "solver/collision/collide.hpp"

#include <initializer_list>

#include "solver/collision/hull.hpp"

namespace cycloid::solver {

template <int D>
static Manifold<D> ball_against_ball(const Vec<D>& a, float radius_a, const Vec<D>& b,
                                     float radius_b, const Vec<D>& a_to_b, float margin) {
  const Vec<D> between = b - a;
  const float distance = length(between);
  const float separation = distance - (radius_a + radius_b);
  if (separation > margin) return {};
  Vec<D> up = Vec<D>::zero();
  up[1] = 1.0f;  // Concentric balls part upwards: any direction will do, but it has to be one.
  Manifold<D> manifold;
  manifold.normal = normalized_or(between, up);
  add_point(a + (radius_a + 0.5f * separation) * manifold.normal, separation, 0, a_to_b, manifold);
  return manifold;
}

template <int D>
static Manifold<D> half_space_against_ball(const Vec<D>& normal, float offset, const Vec<D>& centre,
                                           float radius, const Vec<D>& a_to_b, float margin) {
  const float separation = dot(normal, centre) - offset - radius;
  if (separation > margin) return {};
  Manifold<D> manifold;
  manifold.normal = normal;
  add_point(centre - (radius + 0.5f * separation) * normal, separation, 0, a_to_b, manifold);
  return manifold;
}

template <int D>
static Manifold<D> flipped(Manifold<D> manifold) {
  manifold.normal = -manifold.normal;
  return manifold;
}

/// A shape with its pose relative to body a.
template <int D>
struct Placed {
  const Shape<D>& shape;
  Rotation<D> rotation;
  Vec<D> position;

  Vec<D> centre() const { return position + rotate(rotation, shape.vertices[0]); }
  Vec<D> normal() const { return rotate(rotation, shape.normal); }
  float offset() const { return shape.offset + dot(normal(), position); }
};

static Hull hull_of(const Placed<2>& placed) {
  return make_hull(placed.shape, placed.rotation, placed.position);
}

/// Pairs with at least one hull; `a` is the one whose kind comes later in ShapeKind.
static Manifold<2> collide_hulls(const Placed<2>& a, const Placed<2>& b, const Vec<2>& a_to_b,
                                 float margin) {
  const bool a_half_space = a.shape.kind == ShapeKind::kHalfSpace;
  const bool b_half_space = b.shape.kind == ShapeKind::kHalfSpace;
  if (a_half_space)
    return half_space_against_hull(a.normal(), a.offset(), hull_of(b), a_to_b, margin);
  if (b_half_space)
    return flipped(half_space_against_hull(b.normal(), b.offset(), hull_of(a), a_to_b, margin));
  if (b.shape.kind == ShapeKind::kBall)
    return hull_against_ball(hull_of(a), b.centre(), b.shape.radius, a_to_b, margin);
  if (a.shape.kind == ShapeKind::kBall)
    return flipped(hull_against_ball(hull_of(b), a.centre(), a.shape.radius, a_to_b, margin));
  return hull_against_hull(hull_of(a), hull_of(b), a_to_b, margin);
}
/// Space has no hulls yet.
static Manifold<3> collide_hulls(const Placed<3>&, const Placed<3>&, const Vec<3>&, float) {
  return {};
}

template <int D>
Manifold<D> collide(const Shape<D>& a, const Pose<D>& pose_a, const Shape<D>& b,
                    const Pose<D>& pose_b, float margin) {
  const Vec<D> a_to_b = pose_b.position - pose_a.position;
  const Placed<D> placed_a{a, pose_a.rotation, Vec<D>::zero()};
  const Placed<D> placed_b{b, pose_b.rotation, a_to_b};
  const bool ball_a = a.kind == ShapeKind::kBall;
  const bool ball_b = b.kind == ShapeKind::kBall;
  if (ball_a && ball_b)
    return ball_against_ball(placed_a.centre(), a.radius, placed_b.centre(), b.radius, a_to_b,
                             margin);
  if (a.kind == ShapeKind::kHalfSpace && ball_b)
    return half_space_against_ball(placed_a.normal(), placed_a.offset(), placed_b.centre(),
                                   b.radius, a_to_b, margin);
  if (b.kind == ShapeKind::kHalfSpace && ball_a)
    return flipped(half_space_against_ball(placed_b.normal(), placed_b.offset(), placed_a.centre(),
                                           a.radius, a_to_b, margin));
  return collide_hulls(placed_a, placed_b, a_to_b, margin);
}

template Manifold<2> collide(const Shape<2>&, const Pose<2>&, const Shape<2>&, const Pose<2>&,
                             float);
template Manifold<3> collide(const Shape<3>&, const Pose<3>&, const Shape<3>&, const Pose<3>&,
                             float);

}  // namespace cycloid::solver
