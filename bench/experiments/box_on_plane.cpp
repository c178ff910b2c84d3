#include <algorithm>
#include <array>
#include <cmath>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/space_worlds.hpp"
#include "bench/reference/direct.hpp"
#include "bench/reference/projected_gauss_seidel.hpp"
#include "bench/reference/residual.hpp"

namespace cycloid::experiments {

using namespace solver;

static const char* const kTalkOf2020 = "Sequential Impulses Explained 2020: a box on four contacts";
static constexpr double kHalf = 0.5;

/// A cube of 1 kg at rest on the plane, with a ball inside off its middle.
struct BoxCase {
  const char* name;
  double ballast;  ///< kg
  int copies;      ///< Of the box, all of the one body: 2 give 8 points, each twice.
};

static constexpr BoxCase kCases[] = {{"4 points", 0.0, 1},
                                     {"4 points, load off the middle", 3.0, 1},
                                     {"8 points, each twice", 0.0, 2}};

static World<3> world_of(const BoxCase& each, std::uint32_t sweeps, ContactBlockRows together) {
  Tuning tuning = velocities_only(sweeps);
  tuning.contact_block = together;
  World<3> world = space::make_world(tuning);
  space::add_ground(world);
  std::vector<ShapeDef<3>> shapes(static_cast<std::size_t>(each.copies),
                                  space::box(kHalf, kHalf, kHalf));
  for (ShapeDef<3>& shape : shapes) shape.density = 1.0f / static_cast<float>(each.copies);
  if (each.ballast > 0.0) {
    ShapeDef<3> inside = space::ball(0.2);
    inside.points = {{{0.25f, 0.0f, 0.0f}}};
    inside.density = static_cast<float>(each.ballast / (4.0 / 3.0 * 3.14159265358979 * 0.008));
    shapes.push_back(inside);
  }
  space::add(world, shapes, kHalf);
  return world;
}

/// Height, turn about x, turn about z of the box, in double: n = (0, 1, 0), so that r x n is
/// (-z, 0, x). The ball lies on the x axis, so M is diagonal.
static reference::Assembled assemble_box(const BoxCase& each) {
  const World<3> world = world_of(each, 1, ContactBlockRows::kNone);
  const Body<3>& body = world.state().bodies[1];
  const double off = 0.25 * each.ballast / (1.0 + each.ballast);
  std::vector<double> jacobian;
  for (int copy = 0; copy < each.copies; ++copy)
    for (const double z : {-kHalf, kHalf})
      for (const double x : {-kHalf, kHalf}) {
        const std::array<double, 3> row = {1.0, -z, x - off};
        jacobian.insert(jacobian.end(), row.begin(), row.end());
      }
  return reference::assemble(
      4 * each.copies, jacobian,
      {static_cast<double>(body.inverse_mass), static_cast<double>(body.inverse_inertia.m[0]),
       static_cast<double>(body.inverse_inertia.m[8])},
      {-kTickSpeed, 0.0, 0.0});
}

static std::vector<double> impulses_of_box(const BoxCase& each, int sweeps,
                                           ContactBlockRows together) {
  World<3> world = world_of(each, static_cast<std::uint32_t>(sweeps), together);
  space::step(world);
  return space::normal_impulses(world);
}

/// Of the force and of the moment on the box, over the exact force (and half a width).
struct WrenchError {
  double force = 0.0;
  double moment = 0.0;
};

static WrenchError wrench_of(const reference::Assembled& box, const std::vector<double>& impulses,
                             const std::vector<double>& exact) {
  std::array<double, 3> difference{};
  double weight = 0.0;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    weight += exact[i];
    for (std::size_t f = 0; f < 3; ++f)
      difference[f] += box.jacobian[3 * i + f] * (impulses[i] - exact[i]);
  }
  return {std::abs(difference[0]) / weight,
          std::hypot(difference[1], difference[2]) / (weight * kHalf)};
}

static double largest_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < b.size(); ++i) largest = std::max(largest, std::abs(a[i] - b[i]));
  return largest / *std::max_element(b.begin(), b.end());
}

static Curve check_case(Report& report, const BoxCase& each) {
  const std::string in = std::string(", ") + each.name;
  const reference::Assembled box = assemble_box(each);
  const reference::Mlcp& problem = box.problem;
  const reference::DirectResult exact = reference::solve_direct(problem);
  report.expect("residual of the direct solution" + in, kTalkOf2020, 0.0, exact.residual, 1.0e-10);
  report.expect("rank of A over the rows that push" + in, "a body has 3 freedoms on a plane", 3.0,
                exact.rank, 0.0);
  double left = 0.0;
  for (const double velocity : reference::body_velocities(box, exact.lambda))
    left = std::max(left, std::abs(velocity));
  report.expect("velocity left by the direct solution, over the fall" + in, "statics: at rest", 0.0,
                left / kTickSpeed, 1.0e-12);
  constexpr int kMost = 200;
  const auto history = reference::pgs_history<double>(problem, {.sweeps = kMost});
  Curve curve{each.name, {}};
  for (int sweeps = 1; sweeps <= 12; ++sweeps)
    curve.points.emplace_back(
        sweeps, std::max(reference::velocity_error(
                             problem, history[static_cast<std::size_t>(sweeps) - 1], exact.lambda),
                         1.0e-16));
  for (const int sweeps : {1, 2, 4, 8}) {
    const std::vector<double>& matrix = history[static_cast<std::size_t>(sweeps) - 1];
    const std::vector<double> now = impulses_of_box(each, sweeps, ContactBlockRows::kNone);
    const std::string after = " after " + std::to_string(sweeps) + " sweeps" + in;
    const WrenchError expected = wrench_of(box, matrix, exact.lambda);
    const WrenchError measured = wrench_of(box, now, exact.lambda);
    report.expect("error of the force" + after, "matrix in double", expected.force, measured.force,
                  1.0e-5);
    report.expect("error of the moment" + after, "matrix in double", expected.moment,
                  measured.moment, 1.0e-5);
    report.expect("error of the velocity in energy's norm" + after, "matrix in double",
                  reference::velocity_error(problem, matrix, exact.lambda),
                  reference::velocity_error(problem, now, exact.lambda), 1.0e-5);
  }
  const std::vector<double> late = impulses_of_box(each, kMost, ContactBlockRows::kNone);
  report.expect("error of the force after 200 sweeps" + in, kTalkOf2020, 0.0,
                wrench_of(box, late, exact.lambda).force, 1.0e-5);
  report.expect("impulses farthest from those of least norm, over the largest, 200 sweeps" + in,
                "not unique: matrix in double", largest_difference(history.back(), exact.lambda),
                largest_difference(late, exact.lambda), 1.0e-4);
  const std::vector<double> together = impulses_of_box(each, 1, ContactBlockRows::kNormals);
  const WrenchError block = wrench_of(box, together, exact.lambda);
  report.expect("error of the force, normals together, one sweep" + in, "exact", 0.0, block.force,
                1.0e-5);
  report.expect("error of the moment, normals together, one sweep" + in, "exact", 0.0, block.moment,
                1.0e-5);
  return curve;
}

/// By hand: K = (4 1 1 -2; 1 4 -2 1; 1 -2 4 1; -2 1 1 4) / m, d = -g h.
static void check_first_sweep(Report& report) {
  const std::vector<double> now = impulses_of_box(kCases[0], 1, ContactBlockRows::kNone);
  const std::array expected = {1.0 / 4.0, 3.0 / 16.0, 9.0 / 32.0, 33.0 / 128.0};
  for (std::size_t i = 0; i < expected.size(); ++i)
    report.expect("impulse of corner " + std::to_string(i) + " after the first sweep, over weight",
                  "Gauss-Seidel by hand", expected[i], now.at(i) / kTickSpeed, 1.0e-6);
}

Report box_on_plane() {
  Report report{"box-on-plane", {}, {}};
  check_first_sweep(report);
  Figure figure{"box-on-plane-in-space",
                "A cube on a plane, row by row",
                "sweeps",
                "error of the velocity",
                false,
                true,
                {}};
  for (const BoxCase& each : kCases) figure.curves.push_back(check_case(report, each));
  report.figures.push_back(figure);
  return report;
}

}  // namespace cycloid::experiments
