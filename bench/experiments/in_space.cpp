#include <algorithm>
#include <cmath>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/space_worlds.hpp"
#include "bench/reference/direct.hpp"
#include "bench/reference/projected_gauss_seidel.hpp"

namespace cycloid::experiments {

using namespace solver;

/// Sweeps of one cold tick until the slowest contact is within 5 %; 0 where `most` are too few.
static int sweeps_of_balls(const std::vector<double>& masses, Order order, std::uint32_t most) {
  const std::vector<double> exact = exact_impulses(masses);
  for (std::uint32_t sweeps = 1; sweeps <= most; ++sweeps) {
    World<3> world = space::stack_of_balls(masses, velocities_only(sweeps, order));
    space::step(world);
    if (slowest_error(space::normal_impulses(world), exact) <= 0.05)
      return static_cast<int>(sweeps);
  }
  return 0;
}

static void check_balls(Report& report) {
  const std::vector<int> up = {1, 5, 11, 20, 31, 45, 61, 81, 102, 127};
  const std::vector<int> down = {1, 6, 13, 23, 35, 50, 67, 88, 110, 136};
  for (const std::size_t n : {1u, 2u, 3u, 4u, 5u, 6u, 7u, 8u, 9u, 10u}) {
    const std::vector<double> masses(n, 1.0);
    const std::string name = std::to_string(n) + " balls in space";
    report.expect("sweeps to 5 %, bottom-up, " + name, "methods 3.3, as in the plane", up[n - 1],
                  sweeps_of_balls(masses, Order::kId, 150), 0.0);
    report.expect("sweeps to 5 %, top-down, " + name, "methods 3.3, as in the plane", down[n - 1],
                  sweeps_of_balls(masses, Order::kReverse, 150), 0.0);
  }
  for (const int ratio : {1, 2, 5, 10, 20, 50})
    report.expect("sweeps to 5 %, " + std::to_string(ratio) + " kg on 1 kg, balls in space",
                  "3 r + 2", 3 * ratio + 2,
                  sweeps_of_balls({1.0, static_cast<double>(ratio)}, Order::kId, 200), 0.0);
}

/// Cubes of 1 kg on one another, four points under each: freedoms of each height, turn about x and
/// turn about z; 4 rows per cube, bottom first.
static reference::Assembled stack_of_cubes(int count) {
  const int dof = 3 * count;
  std::vector<double> jacobian(static_cast<std::size_t>(4 * count * dof), 0.0);
  std::vector<double> inverse_mass;
  std::vector<double> velocity;
  for (int i = 0; i < count; ++i) {
    // I = m (2 a)^2 / 6.
    inverse_mass.insert(inverse_mass.end(), {1.0, 6.0, 6.0});
    velocity.insert(velocity.end(), {-kTickSpeed, 0.0, 0.0});
    for (int p = 0; p < 4; ++p) {
      double* row = &jacobian[static_cast<std::size_t>((4 * i + p) * dof)];
      const double x = (p & 1) == 0 ? -0.5 : 0.5;
      const double z = (p & 2) == 0 ? -0.5 : 0.5;
      const double own[3] = {1.0, -z, x};
      for (int f = 0; f < 3; ++f) {
        row[3 * i + f] = own[f];
        if (i > 0) row[3 * (i - 1) + f] = -own[f];
      }
    }
  }
  return reference::assemble(4 * count, jacobian, inverse_mass, velocity);
}

/// The force of every manifold within 5 % of the weight above it; impulses are not unique.
static bool carries(const std::vector<double>& impulses) {
  const std::size_t count = impulses.size() / 4;
  for (std::size_t i = 0; i < count; ++i) {
    double force = 0.0;
    for (std::size_t p = 0; p < 4; ++p) force += impulses[4 * i + p];
    const double weight = static_cast<double>(count - i) * kTickSpeed;
    if (std::abs(force - weight) > 0.05 * weight) return false;
  }
  return true;
}

static int sweeps_row_by_row(const reference::Mlcp& problem) {
  int sweeps = 0;
  reference::projected_gauss_seidel(problem, {.sweeps = 1000},
                                    std::vector<double>(static_cast<std::size_t>(problem.n), 0.0),
                                    [&](int sweep, const std::vector<double>& lambda) {
                                      if (carries(lambda)) sweeps = sweep;
                                      return sweeps == 0;
                                    });
  return sweeps;
}

/// The four rows from `first` on, given all the others.
static reference::Mlcp manifold_of(const reference::Mlcp& problem,
                                   const std::vector<double>& lambda, int first) {
  reference::Mlcp four;
  four.n = 4;
  for (int i = first; i < first + 4; ++i) {
    double b = problem.b[static_cast<std::size_t>(i)];
    for (int j = 0; j < problem.n; ++j)
      if (j < first || j >= first + 4) b += problem.at(i, j) * lambda[static_cast<std::size_t>(j)];
    four.b.push_back(b);
    for (int j = first; j < first + 4; ++j) four.a.push_back(problem.at(i, j));
  }
  four.lower.assign(4, 0.0);
  four.upper.assign(4, reference::kInfinity);
  four.normal_of.assign(4, -1);
  four.friction.assign(4, 0.0);
  return four;
}

/// Each manifold solved exactly in its turn.
static int sweeps_of_blocks(const reference::Mlcp& problem) {
  std::vector<double> lambda(static_cast<std::size_t>(problem.n), 0.0);
  for (int sweep = 1; sweep <= 200; ++sweep) {
    for (int first = 0; first < problem.n; first += 4) {
      const auto four = reference::solve_direct(manifold_of(problem, lambda, first));
      std::copy(four.lambda.begin(), four.lambda.end(), lambda.begin() + first);
    }
    if (carries(lambda)) return sweep;
  }
  return 0;
}

/// The four rows together make of a cube what a ball is. One by one they come a
/// little sooner.
static void check_cubes(Report& report) {
  const std::vector<int> balls = {1, 5, 11, 20, 31, 45, 61, 81, 102, 127};
  const std::vector<int> rows = {1, 5, 10, 18, 29, 42, 58, 76, 96, 119};
  Curve apart{"row by row", {}};
  Curve together{"four normals together", {}};
  for (int n = 1; n <= 10; ++n) {
    const reference::Assembled stack = stack_of_cubes(n);
    const std::string name = std::to_string(n) + " cubes on four points each";
    const auto at = static_cast<std::size_t>(n) - 1;
    const int by_row = sweeps_row_by_row(stack.problem);
    const int by_block = sweeps_of_blocks(stack.problem);
    report.expect("sweeps to 5 % of the force, matrix, row by row, " + name, "measured in double",
                  rows[at], by_row, 0.0);
    report.expect("sweeps to 5 % of the force, matrix, normals together, " + name,
                  "the balls' counts", balls[at], by_block, 0.0);
    apart.points.emplace_back(n, by_row);
    together.points.emplace_back(n, by_block);
  }
  report.figures.push_back({"sweeps-against-stack-height-of-cubes",
                            "Sweeps to 5 % for cubes on four points",
                            "cubes",
                            "sweeps",
                            true,
                            true,
                            {apart, together}});
}

/// How far the top ball has come down when all rests, m; positions are not corrected.
static double sink_in_space(const std::vector<double>& masses, std::uint32_t sweeps) {
  World<3> world = space::stack_of_balls(masses, velocities_only(sweeps));
  const auto top = [&] {
    return static_cast<double>(world.state().bodies[masses.size()].position[1]);
  };
  const double start = top();
  space::step(world, 900);
  return start - top();
}

static void check_sink_in_space(Report& report) {
  const double unit = kGravity * kTick * kTick;
  for (const std::uint32_t sweeps : {1u, 2u, 4u, 8u, 10u}) {
    const double rate = std::pow(10.0 / 11.0, sweeps);
    const double formula = unit * rate / (1.0 - rate);
    report.expect(
        "sink of 10 kg on 1 kg with " + std::to_string(sweeps) + " sweeps, balls in space, m",
        "g h^2 rho^K / (1 - rho^K)", formula, sink_in_space({1.0, 10.0}, sweeps),
        2.0e-6 + 1.0e-3 * formula);
  }
  report.expect("sink of ten equal balls in space with one sweep, m", "g h^2 n (n - 1) / 2",
                45.0 * unit, sink_in_space(std::vector<double>(10, 1.0), 1), 1.0e-4);
}

/// Share of the overlap with the ground that is left, without gravity.
static double overlap_left_in_space(const ShapeDef<3>& shape, Stabilisation stabilisation,
                                    double beta, int ticks) {
  Tuning tuning = velocities_only(10);
  tuning.stabilisation = stabilisation;
  tuning.contact_block = ContactBlockRows::kNormals;
  tuning.baumgarte = static_cast<float>(beta);
  tuning.slop = 0.0f;
  tuning.push_speed_max = 1000.0f;
  if (stabilisation != Stabilisation::kBaumgarte) tuning.position_sweeps = 1;
  World<3> world = space::make_world(tuning, 0.0);
  space::add_ground(world);
  const BodyId id = space::add(world, std::span(&shape, 1), 0.5 - 0.125);
  space::step(world, ticks);
  return (0.5 - static_cast<double>(require(world.body(id)).position[1])) / 0.125;
}

static void check_correction(Report& report) {
  struct Case {
    Stabilisation stabilisation;
    const char* name;
  };
  const char* const source = "Catto 2009 in discrete time: C_n = (1 - beta)^n C_0";
  const ShapeDef<3> ball = space::ball(0.5);
  const ShapeDef<3> cube = space::box(0.5, 0.5, 0.5);
  for (const double beta : {0.1, 0.2, 0.5})
    report.expect("share of a ball's overlap left after one tick, in space, beta " +
                      std::to_string(beta).substr(0, 3),
                  source, 1.0 - beta,
                  overlap_left_in_space(ball, Stabilisation::kBaumgarte, beta, 1), 2.0e-5);
  for (const Case& each : {Case{Stabilisation::kSplitImpulse, "split impulse"},
                           Case{Stabilisation::kNgs, "non-linear Gauss-Seidel"}})
    for (const double beta : {0.1, 0.2, 0.5}) {
      const std::string name =
          std::string(each.name) + ", in space, beta " + std::to_string(beta).substr(0, 3);
      report.expect("share of a ball's overlap left after 10 ticks, " + name, source,
                    std::pow(1.0 - beta, 10),
                    overlap_left_in_space(ball, each.stabilisation, beta, 10), 2.0e-5);
      report.expect("share of a cube's overlap left after 10 ticks, " + name, source,
                    std::pow(1.0 - beta, 10),
                    overlap_left_in_space(cube, each.stabilisation, beta, 10), 2.0e-5);
    }
}

Report in_space() {
  Report report{"in-space", {}, {}};
  check_balls(report);
  check_cubes(report);
  check_sink_in_space(report);
  check_correction(report);
  return report;
}

}  // namespace cycloid::experiments
