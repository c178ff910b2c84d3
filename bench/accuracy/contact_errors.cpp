#include <algorithm>
#include <cmath>

#include "bench/accuracy/contact_problem.hpp"
#include "bench/reference/direct.hpp"
#include "bench/trials/motions.hpp"

namespace cycloid::accuracy {

using reference::Mlcp;
using reference::Residual;
using solver::Dim;
using solver::WorldState;

/// What counts as nothing beside the sizes of a direct solution.
static constexpr double kRounding = 1e-6;

/// The friction of one point: as many rows as there are tangents, from `first` on.
template <int D>
struct Rubbing {
  double impulse = 0.0;  ///< Length, N s.
  double bound = 0.0;    ///< N s
  double map = 0.0;      ///< Length of lambda - projection(lambda - w / A), N s.
  double work = 0.0;     ///< |lambda . w + bound |w||, J: 0 where friction opposes all it can.
};

template <int D>
static Rubbing<D> rubbing_at(const ContactProblem<D>& problem, std::size_t first) {
  const ProblemRow<D>* rows = &problem.rows[first];
  Rubbing<D> rubbing;
  rubbing.bound = rows->friction * std::max(problem.rows[rows->normal].impulse, 0.0);
  double inverse = 0.0;
  for (int t = 0; t < Dim<D>::kTangents; ++t) inverse = std::max(inverse, rows[t].inverse);
  double impulse = 0.0;
  double speed = 0.0;
  double wanted = 0.0;
  double along = 0.0;
  const auto stepped = [&](int t) { return rows[t].impulse - rows[t].speed / inverse; };
  for (int t = 0; t < Dim<D>::kTangents; ++t) {
    impulse += rows[t].impulse * rows[t].impulse;
    speed += rows[t].speed * rows[t].speed;
    along += rows[t].impulse * rows[t].speed;
    wanted += stepped(t) * stepped(t);
  }
  const double length = std::sqrt(wanted);
  const double share = length > rubbing.bound ? rubbing.bound / length : 1.0;
  double map = 0.0;
  for (int t = 0; t < Dim<D>::kTangents; ++t) {
    const double off = rows[t].impulse - share * stepped(t);
    map += off * off;
  }
  rubbing.impulse = std::sqrt(impulse);
  rubbing.map = std::sqrt(map);
  rubbing.work = std::abs(along + rubbing.bound * std::sqrt(speed));
  return rubbing;
}

template <int D>
Residual residual_of(const ContactProblem<D>& problem) {
  Residual residual;
  const auto take = [&](double map, double work) {
    residual.natural_map = std::max(residual.natural_map, map);
    residual.complementarity = std::max(residual.complementarity, work);
  };
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    const ProblemRow<D>& row = problem.rows[i];
    if (!(row.inverse > 0.0)) continue;
    residual.impulse_scale = std::max(
        {residual.impulse_scale, std::abs(row.impulse), std::abs(row.free_speed) / row.inverse});
    const double stepped = row.impulse - row.speed / row.inverse;
    if (row.kind == RowKind::kJoint)
      take(std::abs(row.impulse - stepped), std::abs(row.impulse * row.speed));
    if (row.kind == RowKind::kNormal) {
      take(std::abs(row.impulse - std::max(stepped, 0.0)), std::abs(row.impulse * row.speed));
      residual.outside = std::max(residual.outside, -row.impulse);
    }
    if (row.kind != RowKind::kFriction) continue;
    const Rubbing<D> rubbing = rubbing_at(problem, i);
    take(rubbing.map, rubbing.work);
    residual.outside = std::max(residual.outside, rubbing.impulse - rubbing.bound);
    i += Dim<D>::kTangents - 1;
  }
  if (residual.natural_map > 0.0) residual.relative = residual.natural_map / residual.impulse_scale;
  return residual;
}

template <int D>
double cone_excess(const ContactProblem<D>& problem) {
  double excess = 0.0;
  double largest = 0.0;
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    const ProblemRow<D>& row = problem.rows[i];
    if (row.kind == RowKind::kNormal) largest = std::max(largest, row.impulse);
    if (row.kind != RowKind::kFriction) continue;
    const Rubbing<D> rubbing = rubbing_at(problem, i);
    excess = std::max(excess, rubbing.impulse - rubbing.bound);
    i += Dim<D>::kTangents - 1;
  }
  return largest > 0.0 ? excess / largest : 0.0;
}

/// Whether a friction of the solution is one of a round cone: it holds, or it pushes against the
/// slip with all it can. In the plane every one is.
template <int D>
static bool is_round(const ContactProblem<D>& problem, const reference::DirectResult& direct) {
  if (D == 2) return true;
  double largest_speed = 0.0;
  for (const ProblemRow<D>& row : problem.rows)
    largest_speed = std::max(largest_speed, std::abs(row.free_speed));
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    const ProblemRow<D>& row = problem.rows[i];
    if (row.kind != RowKind::kFriction) continue;
    double impulse = 0.0;
    double speed = 0.0;
    for (std::size_t t = 0; t < Dim<D>::kTangents; ++t) {
      impulse += direct.lambda[i + t] * direct.lambda[i + t];
      speed += direct.w[i + t] * direct.w[i + t];
    }
    const double bound = row.friction * std::max(direct.lambda[row.normal], 0.0);
    if (std::sqrt(impulse) > bound * (1.0 + kRounding)) return false;
    if (bound > 0.0 && std::sqrt(speed) > kRounding * largest_speed) return false;
    i += Dim<D>::kTangents - 1;
  }
  return true;
}

/// n x dof, row-major: body after body, of those that respond.
template <int D>
static std::vector<double> jacobian_of(const ContactProblem<D>& problem,
                                       const WorldState<D>& state) {
  constexpr std::size_t kFreedoms = Dim<D>::kFreedoms;
  const std::size_t dof = state.bodies.size() * kFreedoms;
  std::vector<double> jacobian(problem.rows.size() * dof, 0.0);
  for (std::size_t i = 0; i < problem.rows.size(); ++i) {
    const ProblemRow<D>& row = problem.rows[i];
    const auto add = [&](std::uint32_t body, const auto& part) {
      if (!trials::responds(state.bodies[body])) return;
      for (std::size_t k = 0; k < kFreedoms; ++k)
        jacobian[i * dof + body * kFreedoms + k] += part[k];
    };
    add(row.body_a, row.jacobian_a);
    add(row.body_b, row.jacobian_b);
  }
  return jacobian;
}

template <int D>
std::optional<DirectErrors> direct_errors(const ContactProblem<D>& problem,
                                          const WorldState<D>& state, std::uint32_t rows_max) {
  if (problem.rows.empty() || problem.rows.size() > rows_max) return {};
  const Mlcp mlcp = dense(problem, state);
  const reference::DirectResult direct = reference::solve_direct(mlcp);
  if (!direct.converged || !is_round(problem, direct)) return {};
  std::vector<double> lambda;
  for (const ProblemRow<D>& row : problem.rows) lambda.push_back(row.impulse);
  const std::size_t dof = state.bodies.size() * Dim<D>::kFreedoms;
  DirectErrors errors;
  if (!direct.rank_deficient) errors.impulse = reference::impulse_error(lambda, direct.lambda).max;
  errors.wrench = reference::wrench_error(jacobian_of(problem, state), static_cast<int>(dof),
                                          lambda, direct.lambda);
  errors.velocity = reference::velocity_error(mlcp, lambda, direct.lambda);
  return errors;
}

template Residual residual_of(const ContactProblem<2>&);
template Residual residual_of(const ContactProblem<3>&);
template double cone_excess(const ContactProblem<2>&);
template double cone_excess(const ContactProblem<3>&);
template std::optional<DirectErrors> direct_errors(const ContactProblem<2>&, const WorldState<2>&,
                                                   std::uint32_t);
template std::optional<DirectErrors> direct_errors(const ContactProblem<3>&, const WorldState<3>&,
                                                   std::uint32_t);

}  // namespace cycloid::accuracy
