#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "bench/reference/problem.hpp"
#include "bench/reference/residual.hpp"
#include "solver/state.hpp"

namespace cycloid::accuracy {

enum class RowKind { kJoint, kNormal, kFriction };

/// One row of the problem, between two bodies.
template <int D>
struct ProblemRow {
  RowKind kind = RowKind::kJoint;
  std::uint32_t body_a = 0;
  std::uint32_t body_b = 0;
  std::array<double, solver::Dim<D>::kFreedoms> jacobian_a{};  ///< Linear, then angular; world.
  std::array<double, solver::Dim<D>::kFreedoms> jacobian_b{};
  double impulse = 0.0;     ///< As the solver has left it, N s or N m s.
  double speed = 0.0;       ///< w, as the solver has left it, m/s or rad/s; >= 0 of a normal.
  double free_speed = 0.0;  ///< b: what it would be without the impulses of all rows.
  double inverse = 0.0;     ///< A_ii = J M^-1 J^T, 1/kg or 1/(kg m^2).
  std::size_t normal = 0;   ///< Of kFriction: the row of its normal, which comes before it.
  double friction = 0.0;    ///< Of kFriction: the coefficient.
};

/// What the last substep had to solve, told from the state after it: the equalities of joints, and
/// for each contact point w_n >= 0 against lambda_n >= 0 and |lambda_t| <= mu lambda_n against the
/// tangential speed (Coulomb). Every other force and impulse (motors, limits, gravity, equalities
/// that yield as a soft weld's do, or what rubs in a cone-twist) counts as given, and so do the
/// joints of users. A point with a gap may close it within the substep, so w_n of it is the speed
/// beyond that; overlap asks for no speed. Errors of a bounce count in full.
template <int D>
struct ContactProblem {
  std::vector<ProblemRow<D>> rows;  ///< A normal, then its kTangents friction rows.
};

/// @param state  after a step. A row's impulse is that of the last substep of that step.
template <int D>
ContactProblem<D> contact_problem(const solver::WorldState<D>& state);

/// The natural map and complementarity of what the solver has left, as reference::Residual defines
/// them; in space the two friction rows of a point are one, on the disc that the cone leaves them.
template <int D>
reference::Residual residual_of(const ContactProblem<D>& problem);

/// The most by which friction exceeds its cone over the largest normal impulse, no unit; 0 without
/// normals that push.
template <int D>
double cone_excess(const ContactProblem<D>& problem);

/// The same problem with its matrix, and b so that the solver's impulses lead to its speeds. Square
/// in the number of rows. In space the cone has become a pyramid.
template <int D>
reference::Mlcp dense(const ContactProblem<D>& problem, const solver::WorldState<D>& state);

/// Errors against the direct solution, no unit.
struct DirectErrors {
  std::optional<double> impulse;  ///< reference::impulse_error's maximum; absent: not unique.
  double wrench = 0.0;            ///< reference::wrench_error.
  double velocity = 0.0;          ///< reference::velocity_error.
};

/// Nothing where there is no row, where more than `rows_max` are, where the reference finds no
/// solution, or where a contact of space slips in it: its bound is then no round cone.
template <int D>
std::optional<DirectErrors> direct_errors(const ContactProblem<D>& problem,
                                          const solver::WorldState<D>& state,
                                          std::uint32_t rows_max);

}  // namespace cycloid::accuracy
