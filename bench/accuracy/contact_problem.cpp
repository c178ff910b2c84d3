#include "bench/accuracy/contact_problem.hpp"

#include <algorithm>
#include <cmath>

#include "solver/collision/collide.hpp"
#include "solver/constraints/joint_row.hpp"
#include "solver/constraints/rows.hpp"

namespace cycloid::accuracy {

using solver::Body;
using solver::Contact;
using solver::ContactPoint;
using solver::Dim;
using solver::Joint;
using solver::JointKind;
using solver::Manifold;
using solver::Material;
using solver::Pose;
using solver::Shape;
using solver::Spin;
using solver::Vec;
using solver::WorldState;

template <int D>
using Freedoms = std::array<double, Dim<D>::kFreedoms>;

template <int D>
static Freedoms<D> freedoms_of(const Vec<D>& linear, const Spin<D>& angular) {
  Freedoms<D> all{};
  for (int i = 0; i < D; ++i) all[static_cast<std::size_t>(i)] = static_cast<double>(linear[i]);
  for (int i = 0; i < Dim<D>::kSpin; ++i)
    all[static_cast<std::size_t>(D + i)] = static_cast<double>(angular[i]);
  return all;
}

template <int D>
static double product(const Freedoms<D>& a, const Freedoms<D>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

/// M^-1 x of one body, world axes.
template <int D>
static Freedoms<D> accelerated(const Body<D>& body, const Freedoms<D>& by) {
  constexpr int kSpin = Dim<D>::kSpin;
  const auto inverse = world_inertia(body.inverse_inertia, body.rotation);
  Freedoms<D> result{};
  for (std::size_t i = 0; i < D; ++i) result[i] = static_cast<double>(body.inverse_mass) * by[i];
  for (int i = 0; i < kSpin; ++i)
    for (int j = 0; j < kSpin; ++j)
      result[static_cast<std::size_t>(D + i)] +=
          static_cast<double>(inverse.m[i * kSpin + j]) * by[static_cast<std::size_t>(D + j)];
  return result;
}

/// Completes a row from its Jacobian: the speed that the bodies have along it, and A_ii.
template <int D>
static void measure_row(const WorldState<D>& state, ProblemRow<D>& row) {
  const Body<D>& a = state.bodies[row.body_a];
  const Body<D>& b = state.bodies[row.body_b];
  row.speed += product<D>(row.jacobian_a, freedoms_of<D>(a.velocity, a.spin)) +
               product<D>(row.jacobian_b, freedoms_of<D>(b.velocity, b.spin));
  row.inverse = product<D>(row.jacobian_a, accelerated<D>(a, row.jacobian_a)) +
                product<D>(row.jacobian_b, accelerated<D>(b, row.jacobian_b));
}

/// Rows of the blocks that hold whatever it takes: a block on a spring counts as given.
template <int D>
static void add_joint(const WorldState<D>& state, const Joint<D>& joint,
                      ContactProblem<D>& problem) {
  const Body<D>& a = state.bodies[joint.body_a];
  const Body<D>& b = state.bodies[joint.body_b];
  const float time_s = static_cast<float>(state.header.tick) * state.header.tick_s;
  const auto frame = solver::make_frame(state, joint, a.position, b.position - a.position,
                                        a.rotation, b.rotation, time_s);
  solver::JointRows<D> rows;
  rows.clear();
  solver::rows_of(frame, rows);
  const solver::Springs springs = solver::springs_of(joint);
  const int begin = springs.first ? rows.split : 0;
  const int end = springs.second ? rows.split : rows.count;
  for (int i = begin; i < end; ++i) {
    const solver::Row<D>& from = rows.rows[static_cast<std::size_t>(i)];
    ProblemRow<D> row;
    row.body_a = joint.body_a;
    row.body_b = joint.body_b;
    row.jacobian_a = freedoms_of<D>(from.linear_a, from.angular_a);
    row.jacobian_b = freedoms_of<D>(from.linear_b, from.angular_b);
    row.impulse = static_cast<double>(joint.impulse[static_cast<std::size_t>(i)]);
    row.speed = static_cast<double>(from.rate);
    measure_row(state, row);
    problem.rows.push_back(row);
  }
}

/// A row along `direction` at a point of contact.
/// @param between  Centre of b from that of a, m.
template <int D>
static ProblemRow<D> contact_row(const solver::ManifoldPoint<D>& point, const Vec<D>& between,
                                 const Vec<D>& direction) {
  ProblemRow<D> row;
  row.jacobian_a = freedoms_of<D>(-direction, -moment(point.anchor_a, direction));
  row.jacobian_b = freedoms_of<D>(direction, moment(anchor_b_of(point, between), direction));
  return row;
}

/// What the solver has left at this feature; nothing where it had no such point.
template <int D>
static ContactPoint<D> impulses_at(const Contact<D>& contact, std::uint32_t feature) {
  for (std::uint32_t i = 0; i < contact.point_count; ++i)
    if (contact.points[i].feature == feature) return contact.points[i];
  ContactPoint<D> none;
  none.tangent_impulse = Vec<Dim<D>::kTangents>::zero();
  return none;
}

/// Two bodies in contact, and how they rub.
struct Touching {
  std::uint32_t body_a;
  std::uint32_t body_b;
  double friction;
};

template <int D>
static void add_point(const WorldState<D>& state, const Touching& pair, const Manifold<D>& manifold,
                      std::uint32_t index, const ContactPoint<D>& left,
                      ContactProblem<D>& problem) {
  const solver::ManifoldPoint<D>& point = manifold.points[index];
  const std::size_t normal = problem.rows.size();
  const auto add = [&](ProblemRow<D> row, float impulse) {
    row.body_a = pair.body_a;
    row.body_b = pair.body_b;
    row.impulse = static_cast<double>(impulse);
    measure_row(state, row);
    problem.rows.push_back(row);
  };
  const Vec<D> between = state.bodies[pair.body_b].position - state.bodies[pair.body_a].position;
  ProblemRow<D> row = contact_row(point, between, manifold.normal);
  row.kind = RowKind::kNormal;
  const double substep_s = static_cast<double>(state.header.tick_s) / state.header.tuning.substeps;
  row.speed = std::max(static_cast<double>(point.separation), 0.0) / substep_s;
  add(row, left.normal_impulse);
  if (!(pair.friction > 0.0)) return;
  Vec<D> tangents[Dim<D>::kTangents];
  solver::tangents(manifold.normal, tangents);
  for (int t = 0; t < Dim<D>::kTangents; ++t) {
    row = contact_row(point, between, tangents[t]);
    row.kind = RowKind::kFriction;
    row.normal = normal;
    row.friction = pair.friction;
    add(row, left.tangent_impulse[t]);
  }
}

template <int D>
static void add_points(const WorldState<D>& state, const Contact<D>& contact,
                       ContactProblem<D>& problem) {
  const Shape<D>& a = state.shapes[contact.shape_a];
  const Shape<D>& b = state.shapes[contact.shape_b];
  const Body<D>& body_a = state.bodies[a.body];
  const Body<D>& body_b = state.bodies[b.body];
  const auto manifold = collide(a, Pose<D>{body_a.position, body_a.rotation}, b,
                                Pose<D>{body_b.position, body_b.rotation},
                                state.header.tuning.speculative_distance, state.polyhedra);
  const double rubs = static_cast<double>(state.materials[a.material].friction) *
                      static_cast<double>(state.materials[b.material].friction);
  const Touching pair{a.body, b.body, std::sqrt(rubs)};
  for (std::uint32_t i = 0; i < manifold.point_count; ++i)
    add_point(state, pair, manifold, i, impulses_at(contact, manifold.points[i].feature), problem);
}

/// b = w - A lambda, by way of what the impulses do to each body.
template <int D>
static void find_free_speeds(const WorldState<D>& state, ContactProblem<D>& problem) {
  std::vector<Freedoms<D>> changes(state.bodies.size(), Freedoms<D>{});
  const auto push = [&](std::uint32_t body, const Freedoms<D>& jacobian, double impulse) {
    for (std::size_t i = 0; i < jacobian.size(); ++i) changes[body][i] += impulse * jacobian[i];
  };
  for (const ProblemRow<D>& row : problem.rows) {
    push(row.body_a, row.jacobian_a, row.impulse);
    push(row.body_b, row.jacobian_b, row.impulse);
  }
  for (std::size_t i = 0; i < changes.size(); ++i)
    changes[i] = accelerated<D>(state.bodies[i], changes[i]);
  for (ProblemRow<D>& row : problem.rows)
    row.free_speed = row.speed - product<D>(row.jacobian_a, changes[row.body_a]) -
                     product<D>(row.jacobian_b, changes[row.body_b]);
}

template <int D>
ContactProblem<D> contact_problem(const WorldState<D>& state) {
  ContactProblem<D> problem;
  for (const Joint<D>& joint : state.joints)
    if (joint.kind != JointKind::kFree) add_joint(state, joint, problem);
  for (const Contact<D>& contact : state.contacts) add_points(state, contact, problem);
  find_free_speeds(state, problem);
  return problem;
}

/// J_i M^-1 J_j^T over the bodies that both rows have.
template <int D>
static double coupling(const WorldState<D>& state, const ProblemRow<D>& i, const ProblemRow<D>& j) {
  double sum = 0.0;
  const auto through = [&](std::uint32_t body, const Freedoms<D>& with) {
    const Freedoms<D> change = accelerated<D>(state.bodies[body], with);
    if (j.body_a == body) sum += product<D>(j.jacobian_a, change);
    if (j.body_b == body) sum += product<D>(j.jacobian_b, change);
  };
  through(i.body_a, i.jacobian_a);
  through(i.body_b, i.jacobian_b);
  return sum;
}

template <int D>
reference::Mlcp dense(const ContactProblem<D>& problem, const WorldState<D>& state) {
  const auto n = problem.rows.size();
  reference::Mlcp mlcp;
  mlcp.n = static_cast<int>(n);
  mlcp.a.assign(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const ProblemRow<D>& row = problem.rows[i];
    for (std::size_t j = 0; j <= i; ++j)
      mlcp.a[i * n + j] = mlcp.a[j * n + i] = coupling(state, row, problem.rows[j]);
    mlcp.b.push_back(row.free_speed);
    mlcp.lower.push_back(row.kind == RowKind::kJoint ? -reference::kInfinity : 0.0);
    mlcp.upper.push_back(reference::kInfinity);
    mlcp.normal_of.push_back(row.kind == RowKind::kFriction ? static_cast<int>(row.normal) : -1);
    mlcp.friction.push_back(row.friction);
  }
  return mlcp;
}

template reference::Mlcp dense(const ContactProblem<2>&, const WorldState<2>&);
template reference::Mlcp dense(const ContactProblem<3>&, const WorldState<3>&);
template ContactProblem<2> contact_problem(const WorldState<2>&);
template ContactProblem<3> contact_problem(const WorldState<3>&);

}  // namespace cycloid::accuracy
