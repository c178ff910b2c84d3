#include "tests/oracle/manifold_checks.hpp"

#include <algorithm>
#include <sstream>

#include "tests/oracle/manifold_case.hpp"

namespace cycloid::oracle {

using solver::Manifold;
using solver::ManifoldPoint;
using solver::Vec;

double Tolerance::of(const Pair& pair, double gap) const {
  const double exact = rounding * pair.scale();
  if (is_round(pair.a->kind) && is_round(pair.b->kind)) return exact;
  const bool plane = pair.a->kind == Kind::kHalfSpace || pair.b->kind == Kind::kHalfSpace;
  if (plane || is_round(pair.a->kind) || is_round(pair.b->kind)) return exact + reduction;
  return exact + reduction + preference + preference_of_depth * std::max(0.0, -gap);
}

static std::string describe(const Manifold<3>& manifold) {
  std::ostringstream out;
  out.precision(9);
  const auto print = [&](const Vec<3>& v) { out << v[0] << " " << v[1] << " " << v[2]; };
  out << "\n normal ";
  print(manifold.normal);
  for (std::uint32_t i = 0; i < std::min(manifold.point_count, 4u); ++i) {
    out << "\n point ";
    print(manifold.points[i].anchor_a);
    out << " separation " << manifold.points[i].separation << " feature " << std::hex
        << manifold.points[i].feature << std::dec;
  }
  return out.str();
}

static bool is_finite(const Vec<3>& v) {
  return std::isfinite(v[0]) && std::isfinite(v[1]) && std::isfinite(v[2]);
}

/// What holds for any manifold. @returns whether its numbers can be used.
static bool check_form(Case& c) {
  const Manifold<3>& manifold = c.manifold;
  if (manifold.point_count > 4) c.complain("more than four points", manifold.point_count);
  if (manifold.point_count == 0 || manifold.point_count > 4) return false;
  bool finite = is_finite(manifold.normal);
  for (std::uint32_t i = 0; i < manifold.point_count; ++i) {
    const ManifoldPoint<3>& point = manifold.points[i];
    finite = finite && is_finite(point.anchor_a) && std::isfinite(point.separation);
    if (point.separation > c.pair.margin) c.complain("beyond the margin", point.separation);
    for (std::uint32_t k = 0; k < i; ++k)
      if (manifold.points[k].feature == point.feature) c.complain("equal features", point.feature);
  }
  if (!finite) c.complain("not finite");
  if (!finite) return false;
  const double norm = length(to_double(manifold.normal));
  if (std::abs(norm - 1.0) > 1e-5) c.complain("normal not of unit length", norm);
  return true;
}

/// How far a point lies outside a body, m. For a half-space: above it.
static double outside(const Case& c, const Specimen& specimen, const Convex& body,
                      const Vector& point) {
  if (specimen.kind == Kind::kHalfSpace) return dot(point - body.corners[0], c.bodies.normal);
  const Convex at = hull_of({point});
  return distance(body, at).value - body.radius;
}

static void check_points(Case& c) {
  const bool lying = c.pair.a->kind == Kind::kCapsule || c.pair.b->kind == Kind::kCapsule;
  const double least = c.least();
  // Along an axis of separation that is not the way between the nearest points, those lie aside.
  const double aside = c.truth.lower > 0.0
                           ? std::sqrt(std::max(0.0, c.truth.gap.value * c.truth.gap.value -
                                                         c.truth.lower * c.truth.lower))
                           : 0.0;
  const Vector normal = to_double(c.manifold.normal);
  for (std::uint32_t i = 0; i < c.manifold.point_count; ++i) {
    const ManifoldPoint<3>& point = c.manifold.points[i];
    const Vector at = to_double(point.anchor_a);
    const Vector half_way = 0.5 * point.separation * normal;
    const double outside_a = outside(c, *c.pair.a, c.bodies.a, at - half_way);
    const double outside_b = outside(c, *c.pair.b, c.bodies.b, at + half_way);
    const bool deepest = point.separation <= least + 1e-6;
    const double slack = aside + (lying && !deepest ? c.allowed.lying * c.pair.scale() : 0.0);
    const bool within_one = std::min(outside_a, outside_b) <= c.tolerance + slack;
    if (std::max(outside_a, outside_b) > c.tolerance + slack)
      c.complain(within_one ? "point beside one body" : "point beside both bodies",
                 "outside a, b:", outside_a, outside_b, "separation", point.separation, "true",
                 c.truth.gap.value);
  }
}

/// How far in front of a triangle the centre of the other body is, whichever centre is meant: of
/// mass, of the bounding box, of the corners; the least of them.
static double height_over(const Case& c, bool triangle_is_a) {
  const Specimen& specimen = triangle_is_a ? *c.pair.b : *c.pair.a;
  const Convex& triangle = triangle_is_a ? c.bodies.a : c.bodies.b;
  const Convex& other = triangle_is_a ? c.bodies.b : c.bodies.a;
  const double plane = dot(triangle.corners[0], c.bodies.normal);
  const Placement placement = placement_in(c.pair, triangle_is_a ? c.pair.pose_b : c.pair.pose_a);
  Vector middle;
  for (const Vector& corner : other.corners) middle = middle + corner;
  middle = (1.0 / static_cast<double>(other.corners.size())) * middle;
  double least = dot(middle, c.bodies.normal) - plane;
  least = std::min(least, dot(placement.position, c.bodies.normal) - plane);
  if (!is_round(specimen.kind))
    least = std::min(
        least,
        dot(placement.place(to_double(specimen.shape.vertices[0])), c.bodies.normal) - plane);
  return least;
}

/// Whether a triangle is to push the other body as if it had two sides.
static bool triangle_is_free(const Case& c) {
  const bool is_a = c.pair.a->kind == Kind::kTriangle;
  if (!is_a && c.pair.b->kind != Kind::kTriangle) return true;
  const Vector away = is_a ? c.truth.gap.direction : -c.truth.gap.direction;
  return dot(away, c.bodies.normal) > 0.1 && height_over(c, is_a) > c.tolerance;
}

static void check_side(Case& c) {
  if (c.pair.a->kind != Kind::kTriangle && c.pair.b->kind != Kind::kTriangle) return;
  const Vector normal = to_double(c.manifold.normal);
  const double cosine = dot(c.pair.a->kind == Kind::kTriangle ? normal : -normal, c.bodies.normal);
  if (cosine < -1e-3) c.complain("triangle pushes to its back", cosine);
}

static void check_values(Case& c, bool has_points) {
  const Gap& gap = c.truth.gap;
  const double lower = c.truth.lower;
  const double margin = c.pair.margin;
  const double least = c.least();
  if (!c.truth.proved) c.complain("the oracle itself", gap.value);
  if (has_points && lower > margin + c.tolerance)
    c.complain("points of bodies apart", least, "true", gap.value, "bound", lower);
  if (has_points && lower > 0.0 && least < -c.tolerance)
    c.complain("overlap of bodies apart", least, "true", gap.value, "bound", lower);
  if (!triangle_is_free(c)) return;
  if (!has_points && gap.value < margin - c.tolerance)
    c.complain(gap.value < 0 ? "no points in overlap" : "no points within the margin", "true",
               gap.value, "bound", lower);
  if (!has_points) return;
  if (least > gap.value + c.tolerance)
    c.complain(gap.value < 0 ? "depth too little" : "separation too wide", least, "true", gap.value,
               "bound", lower);
  if (least < lower - c.tolerance)
    c.complain(gap.value < 0 ? "depth too much" : "separation too little", least, "true", gap.value,
               "bound", lower);
}

/// Beside the end of a face, or of a triangle, the other body reaches deeper, so the depth along
/// the normal of the face says nothing there; what says something is that the normal is almost the
/// best direction.
static void check_normal(Case& c) {
  if (!triangle_is_free(c)) return;
  const Vector normal = to_double(c.manifold.normal);
  const double along = gap_of(c.pair, c.bodies, normal);
  const double slack = c.allowed.reduction * c.pair.scale() +
                       c.allowed.preference_of_depth * std::max(0.0, -c.truth.gap.value);
  if (along >= c.truth.lower - c.tolerance - slack) return;
  const double angle = length(normal - c.truth.gap.direction);
  const bool whole = c.pair.a->kind != Kind::kTriangle && c.pair.b->kind != Kind::kTriangle &&
                     !is_round(c.pair.a->kind) && !is_round(c.pair.b->kind);
  if (!whole && angle <= c.allowed.parallel) return;
  c.complain("normal not the best", along, "true", c.truth.gap.value, "bound", c.truth.lower,
             "angle", angle);
}

Verdict verdict_on(const Pair& pair, const solver::Polyhedra& polyhedra,
                   const Tolerance& tolerance) {
  const PlacedPair bodies = place(pair);
  const Truth truth = truth_of(pair, bodies);
  Case c{pair,
         bodies,
         truth,
         solver::collide(pair.a->shape, pair.pose_a, pair.b->shape, pair.pose_b, pair.margin,
                         polyhedra),
         tolerance,
         tolerance.of(pair, truth.gap.value),
         {}};
  const bool has_points = check_form(c);
  if (has_points) {
    check_points(c);
    check_side(c);
    check_normal(c);
  }
  if (has_points || c.manifold.point_count == 0) {
    check_values(c, has_points);
    check_swapped(c, polyhedra);
    check_moved(c, polyhedra);
  }
  for (Complaint& complaint : c.complaints) complaint.numbers += describe(c.manifold);
  return {truth.gap.value, c.complaints};
}

}  // namespace cycloid::oracle
