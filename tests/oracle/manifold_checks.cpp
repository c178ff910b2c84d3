#include "tests/oracle/manifold_checks.hpp"

#include <algorithm>
#include <cstring>
#include <sstream>
#include <utility>

#include "solver/collision/collide.hpp"

namespace cycloid::oracle {

using solver::Manifold;
using solver::ManifoldPoint;
using solver::Vec;

double Tolerance::of(const Pair& pair, double gap) const {
  const double exact = rounding * pair.scale();
  if (is_round(pair.a->kind) || is_round(pair.b->kind)) return exact;
  if (pair.a->kind == Kind::kHalfSpace || pair.b->kind == Kind::kHalfSpace)
    return exact + reduction;
  return exact + reduction + preference + preference_of_depth * std::max(0.0, -gap);
}

static Vector to_double(const Vec<3>& v) {
  return {v[0], v[1], v[2]};
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

/// A pair, its manifold, and what has been found wrong with it.
struct Case {
  const Pair& pair;
  PlacedPair bodies;
  Truth truth;
  Manifold<3> manifold;
  double tolerance;
  std::vector<Complaint> complaints;

  template <class... Numbers>
  void complain(const char* what, const Numbers&... numbers) {
    std::ostringstream out;
    out.precision(9);
    ((out << numbers << " "), ...);
    complaints.push_back({what, out.str()});
  }
  double least() const {
    double least = INFINITY;
    for (std::uint32_t i = 0; i < manifold.point_count; ++i)
      least = std::min(least, static_cast<double>(manifold.points[i].separation));
    return least;
  }
};

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
    finite = finite && is_finite(point.anchor_a) && is_finite(point.anchor_b) &&
             std::isfinite(point.separation);
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
  const Vector normal = to_double(c.manifold.normal);
  const Vector between = to_double(c.pair.pose_b.position) - to_double(c.pair.pose_a.position);
  for (std::uint32_t i = 0; i < c.manifold.point_count; ++i) {
    const ManifoldPoint<3>& point = c.manifold.points[i];
    const Vector at = to_double(point.anchor_a);
    const double apart = length(at - to_double(point.anchor_b) - between);
    if (apart > 1e-5 * c.pair.scale()) c.complain("anchors of different places", apart);
    const Vector half_way = 0.5 * point.separation * normal;
    const double outside_a = outside(c, *c.pair.a, c.bodies.a, at - half_way);
    const double outside_b = outside(c, *c.pair.b, c.bodies.b, at + half_way);
    if (std::max(outside_a, outside_b) > c.tolerance)
      c.complain("point not of the bodies", "outside a, b:", outside_a, outside_b, "separation",
                 point.separation);
  }
}

/// Whether a triangle is to push the other body as if it had two sides.
static bool triangle_is_free(const Case& c) {
  const bool is_a = c.pair.a->kind == Kind::kTriangle;
  if (!is_a && c.pair.b->kind != Kind::kTriangle) return true;
  const Convex& triangle = is_a ? c.bodies.a : c.bodies.b;
  const Convex& other = is_a ? c.bodies.b : c.bodies.a;
  const Vector away = is_a ? c.truth.gap.direction : -c.truth.gap.direction;
  Vector middle;
  for (const Vector& corner : other.corners) middle = middle + corner;
  middle = (1.0 / static_cast<double>(other.corners.size())) * middle;
  return dot(away, c.bodies.normal) > 0.1 &&
         dot(middle - triangle.corners[0], c.bodies.normal) > c.tolerance;
}

static void check_side(Case& c) {
  if (c.pair.a->kind != Kind::kTriangle && c.pair.b->kind != Kind::kTriangle) return;
  const Vector normal = to_double(c.manifold.normal);
  const double cosine = dot(c.pair.a->kind == Kind::kTriangle ? normal : -normal, c.bodies.normal);
  if (cosine < -1e-3) c.complain("triangle pushes to its back", cosine);
}

static void check_values(Case& c, bool has_points) {
  const Truth& truth = c.truth;
  const double margin = c.pair.margin;
  const double least = c.least();
  if (!truth.proved) c.complain("the oracle itself", truth.gap.value);
  if (has_points && truth.lower > margin + c.tolerance)
    c.complain("points of bodies apart", least, "true", truth.gap.value, "bound", truth.lower);
  if (!triangle_is_free(c)) return;
  if (!has_points && truth.gap.value < margin - c.tolerance)
    c.complain(truth.gap.value < 0 ? "no points in overlap" : "no points within the margin", "true",
               truth.gap.value, "bound", truth.lower);
  if (!has_points) return;
  if (least > truth.gap.value + c.tolerance)
    c.complain(truth.gap.value < 0 ? "depth too little" : "separation too wide", least, "true",
               truth.gap.value, "bound", truth.lower);
  if (least < truth.lower - c.tolerance)
    c.complain(truth.gap.value < 0 ? "depth too much" : "separation too little", least, "true",
               truth.gap.value, "bound", truth.lower);
  const double along = gap_of(c.pair, c.bodies, to_double(c.manifold.normal));
  if (along < truth.lower - c.tolerance)
    c.complain("normal not the best", along, "true", truth.gap.value, "bound", truth.lower);
}

static std::vector<float> separations(const Manifold<3>& manifold) {
  std::vector<float> values;
  for (std::uint32_t i = 0; i < manifold.point_count; ++i)
    values.push_back(manifold.points[i].separation);
  std::sort(values.begin(), values.end());
  return values;
}

static bool has_value(const std::vector<float>& values, float wanted, double tolerance) {
  return std::any_of(values.begin(), values.end(),
                     [&](float value) { return std::abs(value - wanted) <= tolerance; });
}

/// As deep in both orders, and where the normal is the same, the same separations; how often each
/// occurs may differ, since points that coincide are not told from one point.
static void check_swapped(Case& c, const solver::Polyhedra& polyhedra) {
  const Pair& pair = c.pair;
  const Manifold<3> swapped = solver::collide(pair.b->shape, pair.pose_b, pair.a->shape,
                                              pair.pose_a, pair.margin, polyhedra);
  if (swapped.point_count > 4) {
    c.complain("swapped: more than four points", swapped.point_count);
    return;
  }
  const std::vector<float> here = separations(c.manifold);
  const std::vector<float> there = separations(swapped);
  // At the margin itself the one may have a point and the other none.
  const double at_margin = pair.margin - c.tolerance;
  if (here.empty() != there.empty()) {
    if ((here.empty() ? there : here)[0] < at_margin)
      c.complain("swapped: points in one order only", here.size(), there.size());
    return;
  }
  if (here.empty()) return;
  if (std::abs(here[0] - there[0]) > c.tolerance)
    c.complain("swapped: other depth", here[0], there[0]);
  const Vector turned_by = to_double(c.manifold.normal) + to_double(swapped.normal);
  if (length(turned_by) > 1e-4) return;
  for (const auto& [values, others] : {std::pair(here, there), std::pair(there, here)})
    for (const float value : values)
      if (value < at_margin && !has_value(others, value, c.tolerance)) {
        c.complain("swapped: other separations", here.size(), there.size(), value);
        return;
      }
}

static Vec<3> moved(const Vec<3>& position) {
  return position + Vec<3>{{1024.0f, -1024.0f, 1024.0f}};
}

static bool moves_exactly(const Vec<3>& position) {
  const Vec<3> there_and_back = moved(position) - Vec<3>{{1024.0f, -1024.0f, 1024.0f}};
  return length(to_double(there_and_back) - to_double(position)) == 0.0;
}

/// Positions that stay exact must give the same bits; others the same depth.
static void check_moved(Case& c, const solver::Polyhedra& polyhedra) {
  solver::Pose<3> pose_a = c.pair.pose_a;
  solver::Pose<3> pose_b = c.pair.pose_b;
  const bool exact = moves_exactly(pose_a.position) && moves_exactly(pose_b.position);
  pose_a.position = moved(pose_a.position);
  pose_b.position = moved(pose_b.position);
  const Manifold<3> there =
      solver::collide(c.pair.a->shape, pose_a, c.pair.b->shape, pose_b, c.pair.margin, polyhedra);
  const std::uint32_t count = c.manifold.point_count;
  if (there.point_count > 4) {
    c.complain("moved: more than four points", there.point_count);
    return;
  }
  if (exact) {
    const bool same =
        there.point_count == count &&
        (count == 0 || std::memcmp(&there.normal, &c.manifold.normal, sizeof there.normal) == 0) &&
        std::memcmp(there.points.data(), c.manifold.points.data(),
                    count * sizeof there.points[0]) == 0;
    if (!same) c.complain("moved: other bits", count, there.point_count);
    return;
  }
  const std::vector<float> values = separations(there);
  const double least = c.least();
  const bool lost = values.empty() != (count == 0);
  if (lost && (values.empty() ? least : values[0]) < c.pair.margin - 1e-3)
    c.complain("moved: points in one place only", count, values.size());
  if (!values.empty() && count > 0 && std::abs(values[0] - least) > 1e-3 + c.tolerance)
    c.complain("moved: other depth", least, values[0]);
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
         tolerance.of(pair, truth.gap.value),
         {}};
  const bool has_points = check_form(c);
  if (has_points) {
    check_points(c);
    check_side(c);
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
