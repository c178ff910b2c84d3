#include <algorithm>
#include <cmath>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"

namespace cycloid::experiments {

/// Two planes through the origin that enclose `angle` (rad) and a target at (1, 0), outside of both
/// and on their bisector. The nearest point that satisfies both is the origin. Each sweep projects
/// on the one plane and then on the other. Returns the distances that are left after each sweep.
static std::vector<double> project(double angle, int sweeps) {
  // Normals point to the side that is allowed; the wedge opens towards -x.
  const double half = 0.5 * angle;
  const double normal_x = -std::sin(half);
  const double normal_y = std::cos(half);
  double x = 1.0;
  double y = 0.0;
  std::vector<double> left;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (const double side : {1.0, -1.0}) {
      const double depth = normal_x * x + side * normal_y * y;
      if (depth >= 0.0) continue;
      x -= depth * normal_x;
      y -= depth * side * normal_y;
    }
    left.push_back(std::hypot(x, y));
  }
  return left;
}

static int sweeps_to_error(const std::vector<double>& left, double tolerance) {
  for (std::size_t i = 0; i < left.size(); ++i)
    if (left[i] <= tolerance) return static_cast<int>(i) + 1;
  return 0;
}

Report corner() {
  Report report{"corner", {}, {}};
  const char* const source = "methods 3.6: |p_k| = cos(phi / 2) cos(phi)^(2 k - 1)";
  struct Case {
    int degrees;
    int to_5, to_1, to_0_1;
  };
  Figure figure{"corner-convergence",
                "Projecting on two planes in turn",
                "sweeps",
                "distance to the corner",
                false,
                true,
                {}};
  for (const Case& each :
       {Case{60, 3, 4, 6}, Case{45, 5, 8, 11}, Case{30, 11, 17, 25}, Case{20, 25, 38, 56},
        Case{10, 99, 151, 226}, Case{5, 394, 605, 907}, Case{1, 9835, 15118, 22677}}) {
    const double angle = each.degrees * kPi / 180.0;
    const std::vector<double> left = project(angle, each.to_0_1 + 1);
    const std::string name = ", corner of " + std::to_string(each.degrees) + " degrees";
    report.expect("sweeps to 5 %" + name, source, each.to_5, sweeps_to_error(left, 0.05), 0.0);
    report.expect("sweeps to 1 %" + name, source, each.to_1, sweeps_to_error(left, 0.01), 0.0);
    report.expect("sweeps to 0.1 %" + name, source, each.to_0_1, sweeps_to_error(left, 0.001), 0.0);
    report.expect("distance after sweep 2 over that after sweep 1" + name, "cos^2 phi",
                  std::pow(std::cos(angle), 2), left[1] / left[0], 1.0e-12);
    Curve measured{std::to_string(each.degrees) + " degrees", {}};
    Curve closed{std::to_string(each.degrees) + " degrees, closed form", {}};
    for (int k = 1; k <= std::min(each.to_0_1, 40); ++k) {
      measured.points.emplace_back(k, left[static_cast<std::size_t>(k) - 1]);
      closed.points.emplace_back(k, std::cos(0.5 * angle) * std::pow(std::cos(angle), 2 * k - 1));
    }
    figure.curves.push_back(measured);
    figure.curves.push_back(closed);
  }
  report.expect("distance after 20 sweeps at 30 degrees", source,
                std::cos(kPi / 12.0) * std::pow(std::cos(kPi / 6.0), 39),
                project(kPi / 6.0, 20).back(), 1.0e-12);
  report.figures.push_back(figure);
  return report;
}

}  // namespace cycloid::experiments
