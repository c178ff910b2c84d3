#include <algorithm>
#include <cmath>
#include <cstddef>

#include "bench/experiments/reports.hpp"
#include "bench/experiments/worlds.hpp"
#include "bench/reference/direct.hpp"
#include "bench/reference/projected_gauss_seidel.hpp"

namespace cycloid::experiments {

using namespace solver;

struct Point {
  double x = 0.0;
  double y = 0.0;
};

/// What one contact of balls is: the unit normal from a to b and the arms from either centre.
struct Geometry {
  Point normal;
  Point arm_a;
  Point arm_b;
};

static Point centre_of(const WorldState<2>& state, std::uint32_t body) {
  return {static_cast<double>(state.bodies[body].position[0]),
          static_cast<double>(state.bodies[body].position[1])};
}

/// Shape a is the ground under y = 0 or a ball, shape b a ball; the point lies midway in the
/// overlap.
static Geometry geometry_of(const WorldState<2>& state, const Contact<2>& contact) {
  const Shape<2>& a = state.shapes[contact.shape_a];
  const Shape<2>& b = state.shapes[contact.shape_b];
  const Point from = centre_of(state, a.body);
  const Point to = centre_of(state, b.body);
  const auto radius_b = static_cast<double>(b.radius);
  if (a.kind == ShapeKind::kHalfSpace) {
    const double arm = radius_b + 0.5 * (to.y - radius_b);
    return {{0.0, 1.0}, {to.x - from.x, to.y - arm - from.y}, {0.0, -arm}};
  }
  const auto radius_a = static_cast<double>(a.radius);
  const Point way = {to.x - from.x, to.y - from.y};
  const double distance = std::hypot(way.x, way.y);
  const Point normal = {way.x / distance, way.y / distance};
  const double arm = radius_a + 0.5 * (distance - radius_a - radius_b);
  return {normal,
          {arm * normal.x, arm * normal.y},
          {(arm - distance) * normal.x, (arm - distance) * normal.y}};
}

/// J of one row along `direction`, as 3 numbers per body.
static void write_row(const Contact<2>& contact, const WorldState<2>& state, const Geometry& at,
                      const Point& direction, double* row) {
  double* a = row + 3 * std::size_t{state.shapes[contact.shape_a].body};
  double* b = row + 3 * std::size_t{state.shapes[contact.shape_b].body};
  a[0] -= direction.x;
  a[1] -= direction.y;
  a[2] -= at.arm_a.x * direction.y - at.arm_a.y * direction.x;
  b[0] += direction.x;
  b[1] += direction.y;
  b[2] += at.arm_b.x * direction.y - at.arm_b.y * direction.x;
}

/// A = J M^-1 J^T over all contacts of a world of balls, in double: per contact its normal and then
/// its friction. `contacts` are those of the coming tick, `state` the poses before it.
static reference::Assembled assemble_world(const WorldState<2>& state,
                                           const std::vector<Contact<2>>& contacts,
                                           double friction) {
  const std::size_t dof = 3 * state.bodies.size();
  std::vector<double> inverse_mass(dof);
  std::vector<double> velocity(dof);
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    const Body<2>& body = state.bodies[i];
    inverse_mass[3 * i] = inverse_mass[3 * i + 1] = static_cast<double>(body.inverse_mass);
    inverse_mass[3 * i + 2] = static_cast<double>(body.inverse_inertia.m[0]);
    velocity[3 * i] = static_cast<double>(body.velocity[0]);
    velocity[3 * i + 1] = static_cast<double>(body.velocity[1]);
    velocity[3 * i + 2] = static_cast<double>(body.spin[0]);
    if (body.inverse_mass > 0.0f) velocity[3 * i + 1] -= kTickSpeed;
  }
  std::vector<double> jacobian(2 * contacts.size() * dof, 0.0);
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Geometry at = geometry_of(state, contacts[i]);
    Vec<2> tangent[1];
    tangents(Vec<2>{{static_cast<float>(at.normal.x), static_cast<float>(at.normal.y)}}, tangent);
    // The turn by which the solver makes the tangent, applied to the normal in double.
    const double side = static_cast<double>(tangent[0][0]) * at.normal.y -
                        static_cast<double>(tangent[0][1]) * at.normal.x;
    const double sign = side > 0.0 ? 1.0 : -1.0;
    write_row(contacts[i], state, at, at.normal, &jacobian[2 * i * dof]);
    write_row(contacts[i], state, at, {sign * at.normal.y, -sign * at.normal.x},
              &jacobian[(2 * i + 1) * dof]);
  }
  const int rows = static_cast<int>(2 * contacts.size());
  reference::Assembled assembled = reference::assemble(rows, jacobian, inverse_mass, velocity);
  for (int i = 0; i < rows; i += 2) {
    assembled.problem.normal_of[static_cast<std::size_t>(i) + 1] = i;
    assembled.problem.friction[static_cast<std::size_t>(i) + 1] = friction;
  }
  return assembled;
}

/// Normal, friction, normal, ... in the order of the contacts, N s.
static std::vector<double> all_impulses(const World<2>& world) {
  std::vector<double> impulses;
  for (const Contact<2>& contact : world.state().contacts) {
    impulses.push_back(static_cast<double>(contact.points[0].normal_impulse));
    impulses.push_back(static_cast<double>(contact.points[0].tangent_impulse[0]));
  }
  return impulses;
}

/// Largest difference between the world's impulses and the matrix's after each sweep, over the
/// largest impulse.
template <class Real>
static double largest_difference_of_world(World<2>& world, double friction, int sweeps) {
  const WorldState<2> before = world.state();
  step(world);
  const std::vector<Contact<2>> contacts = world.state().contacts;
  const reference::Assembled assembled = assemble_world(before, contacts, friction);
  const auto history = reference::pgs_history<Real>(assembled.problem, {.sweeps = sweeps});
  double worst = 0.0;
  for (int sweep = 1; sweep <= sweeps; ++sweep) {
    world.restore(before);
    require(world.set_tuning(velocities_only(static_cast<std::uint32_t>(sweep))));
    step(world);
    const std::vector<double> now = all_impulses(world);
    const std::vector<Real>& matrix = history[static_cast<std::size_t>(sweep) - 1];
    double largest = 0.0;
    double difference = 0.0;
    for (std::size_t i = 0; i < now.size(); ++i) {
      largest = std::max(largest, std::abs(now[i]));
      difference = std::max(difference, std::abs(now[i] - static_cast<double>(matrix[i])));
    }
    worst = std::max(worst, difference / largest);
  }
  world.restore(before);
  return worst;
}

/// Balls in a triangle of `base` on the ground, 1 mm into each other, of unequal masses, spinning
/// and drifting. They touch their lower neighbours and not those beside them.
static World<2> pyramid(int base, double friction) {
  World<2> world = make_world(velocities_only(1), {static_cast<float>(friction)});
  add_ground(world);
  const double wide = 1.1;
  const double rise = std::sqrt(0.999 * 0.999 - 0.25 * wide * wide);
  int count = 0;
  for (int row = 0; row < base; ++row)
    for (int i = 0; i < base - row; ++i, ++count) {
      const BodyId id =
          add(world, ball(0.5), wide * (i + 0.5 * row), 0.499 + rise * row, 1.0 + (7 * count) % 5);
      require(world.set_velocity(id, {{0.1f * static_cast<float>(count % 3), 0.0f}},
                                 {{0.5f * static_cast<float>(count % 4 - 1)}}));
    }
  return world;
}

Report explicit_matrix() {
  Report report{"explicit-matrix", {}, {}};
  const char* const source = "Catto 2014: sequential impulses are PGS on an explicit A";
  for (const int n : {2, 4, 8}) {
    World<2> world =
        stack_of_balls(std::vector<double>(static_cast<std::size_t>(n), 1.0), velocities_only(1));
    const std::string name = ", stack of " + std::to_string(n);
    report.expect("largest difference of impulses over 30 sweeps, float matrix" + name, source, 0.0,
                  largest_difference_of_world<float>(world, 0.0, 30), 2.0e-5);
    report.expect("largest difference of impulses over 30 sweeps, double matrix" + name, source,
                  0.0, largest_difference_of_world<double>(world, 0.0, 30), 2.0e-5);
  }
  for (const double friction : {0.0, 0.3, 0.6})
    for (const int base : {2, 4}) {
      World<2> world = pyramid(base, friction);
      const std::string name = ", pyramid of base " + std::to_string(base) + ", friction " +
                               std::to_string(friction).substr(0, 3);
      report.expect("largest difference of impulses over 30 sweeps, float matrix" + name, source,
                    0.0, largest_difference_of_world<float>(world, friction, 30), 2.0e-5);
      report.expect("largest difference of impulses over 30 sweeps, double matrix" + name, source,
                    0.0, largest_difference_of_world<double>(world, friction, 30), 2.0e-5);
      report.expect(
          "contacts" + name, "a triangle of balls", 0.5 * base * (base - 1) * 2 + base,
          [&] {
            step(world);
            return static_cast<double>(world.state().contacts.size());
          }(),
          0.0);
    }
  return report;
}

}  // namespace cycloid::experiments
