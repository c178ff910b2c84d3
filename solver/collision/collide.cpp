#include "solver/collision/collide.hpp"

#include <initializer_list>

#include "solver/collision/hull.hpp"
#include "solver/collision/solid.hpp"

namespace cycloid::solver {

template <int D>
static Manifold<D> ball_against_ball(const Vec<D>& a, float radius_a, const Vec<D>& b,
                                     float radius_b, float margin) {
  const Vec<D> between = b - a;
  const float distance = length(between);
  const float separation = distance - (radius_a + radius_b);
  if (separation > margin) return {};
  Vec<D> up = Vec<D>::zero();
  up[1] = 1.0f;  // Concentric balls part upwards: any direction will do, but it has to be one.
  Manifold<D> manifold;
  manifold.normal = normalized_or(between, up);
  add_point(a + (radius_a + 0.5f * separation) * manifold.normal, separation, 0, manifold);
  return manifold;
}

template <int D>
static Manifold<D> half_space_against_ball(const Vec<D>& normal, float offset, const Vec<D>& centre,
                                           float radius, float margin) {
  const float separation = dot(normal, centre) - offset - radius;
  if (separation > margin) return {};
  Manifold<D> manifold;
  manifold.normal = normal;
  add_point(centre - (radius + 0.5f * separation) * normal, separation, 0, manifold);
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
  const Polyhedra& polyhedra;
  Rotation<D> rotation;
  Vec<D> position;

  Vec<D> centre() const { return position + rotate(rotation, shape.vertices[0]); }
  Vec<D> normal() const { return rotate(rotation, shape.normal); }
  float offset() const { return shape.offset + dot(normal(), position); }
};

/// A manifold of b against a as one of a against b: the frame is a's in both.
using Against = Manifold<3> (*)(const Placed<3>&, const Placed<3>&, float);
static Manifold<3> turned_round(Against against, const Placed<3>& a, const Placed<3>& b,
                                float margin) {
  return flipped(against(b, a, margin));
}

static Hull hull_of(const Placed<2>& placed) {
  return make_hull(placed.shape, placed.rotation, placed.position);
}

/// Pairs with at least one hull; `a` is the one whose kind comes later in ShapeKind.
static Manifold<2> collide_hulls(const Placed<2>& a, const Placed<2>& b, float margin) {
  const bool a_half_space = a.shape.kind == ShapeKind::kHalfSpace;
  const bool b_half_space = b.shape.kind == ShapeKind::kHalfSpace;
  if (a_half_space) return half_space_against_hull(a.normal(), a.offset(), hull_of(b), margin);
  if (b_half_space)
    return flipped(half_space_against_hull(b.normal(), b.offset(), hull_of(a), margin));
  if (b.shape.kind == ShapeKind::kBall)
    return hull_against_ball(hull_of(a), b.centre(), b.shape.radius, margin);
  if (a.shape.kind == ShapeKind::kBall)
    return flipped(hull_against_ball(hull_of(b), a.centre(), a.shape.radius, margin));
  return hull_against_hull(hull_of(a), hull_of(b), margin);
}

static bool is_rod(const Shape<3>& shape) {
  return shape.kind == ShapeKind::kBall || shape.kind == ShapeKind::kCapsule;
}

static Rod rod_of(const Placed<3>& placed) {
  const Vec<3> from = placed.centre();
  const bool ball = placed.shape.kind == ShapeKind::kBall;
  const Vec<3> to =
      ball ? from : placed.position + rotate(placed.rotation, placed.shape.vertices[1]);
  return {from, to, placed.shape.radius};
}

/// A half-space or triangle `a` against anything that is neither.
static Manifold<3> against_surface(const Placed<3>& a, const Placed<3>& b, float margin) {
  const bool half_space = a.shape.kind == ShapeKind::kHalfSpace;
  if (half_space && is_rod(b.shape))
    return half_space_against_rod(a.normal(), a.offset(), rod_of(b), margin);
  Solid solid_b;
  if (!is_rod(b.shape)) place(b.shape, b.polyhedra, b.rotation, b.position, solid_b);
  if (half_space) return half_space_against_solid(a.normal(), a.offset(), solid_b, margin);
  Solid triangle;
  place(a.shape, a.polyhedra, a.rotation, a.position, triangle);
  if (is_rod(b.shape)) return triangle_against_rod(triangle, rod_of(b), margin);
  return triangle_against_solid(triangle, solid_b, margin);
}

static Manifold<3> against_solid(const Placed<3>& a, const Placed<3>& b, float margin) {
  const bool boxes = a.shape.kind == ShapeKind::kBox && b.shape.kind == ShapeKind::kBox;
  Solid solid_a;
  place(a.shape, a.polyhedra, a.rotation, a.position, solid_a);
  if (is_rod(b.shape)) return solid_against_rod(solid_a, rod_of(b), margin);
  Solid solid_b;
  place(b.shape, b.polyhedra, b.rotation, b.position, solid_b);
  return boxes ? box_against_box(solid_a, solid_b, margin)
               : solid_against_solid(solid_a, solid_b, margin);
}

static bool is_surface(const Shape<3>& shape) {
  return shape.kind == ShapeKind::kHalfSpace || shape.kind == ShapeKind::kTriangle;
}

/// Pairs with at least one box, hull, triangle or capsule.
static Manifold<3> collide_hulls(const Placed<3>& a, const Placed<3>& b, float margin) {
  if (is_surface(a.shape) && is_surface(b.shape)) return {};
  if (is_surface(a.shape)) return against_surface(a, b, margin);
  if (is_surface(b.shape)) return turned_round(against_surface, a, b, margin);
  if (is_rod(a.shape) && is_rod(b.shape)) return rod_against_rod(rod_of(a), rod_of(b), margin);
  if (is_rod(a.shape)) return turned_round(against_solid, a, b, margin);
  return against_solid(a, b, margin);
}

template <int D>
Manifold<D> collide(const Shape<D>& a, const Pose<D>& pose_a, const Shape<D>& b,
                    const Pose<D>& pose_b, float margin, const Polyhedra& polyhedra) {
  const Vec<D> a_to_b = pose_b.position - pose_a.position;
  const Placed<D> placed_a{a, polyhedra, pose_a.rotation, Vec<D>::zero()};
  const Placed<D> placed_b{b, polyhedra, pose_b.rotation, a_to_b};
  const bool ball_a = a.kind == ShapeKind::kBall;
  const bool ball_b = b.kind == ShapeKind::kBall;
  if (ball_a && ball_b)
    return ball_against_ball(placed_a.centre(), a.radius, placed_b.centre(), b.radius, margin);
  if (a.kind == ShapeKind::kHalfSpace && ball_b)
    return half_space_against_ball(placed_a.normal(), placed_a.offset(), placed_b.centre(),
                                   b.radius, margin);
  if (b.kind == ShapeKind::kHalfSpace && ball_a)
    return flipped(half_space_against_ball(placed_b.normal(), placed_b.offset(), placed_a.centre(),
                                           a.radius, margin));
  return collide_hulls(placed_a, placed_b, margin);
}

template Manifold<2> collide(const Shape<2>&, const Pose<2>&, const Shape<2>&, const Pose<2>&,
                             float, const Polyhedra&);
template Manifold<3> collide(const Shape<3>&, const Pose<3>&, const Shape<3>&, const Pose<3>&,
                             float, const Polyhedra&);

}  // namespace cycloid::solver
