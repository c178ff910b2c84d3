#include <cstring>
#include <utility>

#include "tests/oracle/manifold_case.hpp"

namespace cycloid::oracle {

using solver::Manifold;
using solver::Vec;

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

// Where the normal is the same, the same separations occur; how often may differ, since points that
// coincide are not told from one point.
void check_swapped(Case& c, const solver::Polyhedra& polyhedra) {
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
  const bool lying = pair.a->kind == Kind::kCapsule || pair.b->kind == Kind::kCapsule;
  const double slack = lying ? c.allowed.lying * pair.scale() : 0.0;
  for (const auto& [values, others] : {std::pair(here, there), std::pair(there, here)})
    for (const float value : values)
      if (value < at_margin && !has_value(others, value, c.tolerance + slack)) {
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

void check_moved(Case& c, const solver::Polyhedra& polyhedra) {
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

}  // namespace cycloid::oracle
