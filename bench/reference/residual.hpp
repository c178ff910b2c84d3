#pragma once

#include <vector>

#include "bench/reference/problem.hpp"

namespace cycloid::reference {

/// How far impulses are from solving a problem; all 0 exactly at solutions.
struct Residual {
  /// Max over rows of |lambda - clamp(lambda - w / A_ii, lower, upper)|, in units of impulse (N s).
  /// Rows with A_ii == 0 take the largest A_jj instead. The natural map: Facchinei and Pang 2003,
  /// "Finite-Dimensional Variational Inequalities", 1.5.2.
  double natural_map = 0.0;
  /// The same divided by impulse_scale, so that units of mass and length cancel.
  double relative = 0.0;
  /// Max over rows of the work that a row does against its bounds, in J: |(lambda - lower) w| where
  /// w > 0 and |(upper - lambda) w| where w < 0; |lambda w| where that bound is infinite.
  double complementarity = 0.0;
  /// Max over rows of how far lambda lies outside its bounds (N s).
  double outside = 0.0;
  /// The size of impulses here: max over rows of |lambda| and |b| / A_ii (N s).
  double impulse_scale = 0.0;
};

/// One row's term of Residual::natural_map, with its sign (N s).
double natural_map(const Mlcp& problem, const std::vector<double>& lambda, int row);

/// All measures at once. Preconditions: lambda has n entries, none of them nan.
Residual residual_of(const Mlcp& problem, const std::vector<double>& lambda);

/// Relative errors of impulses against those of a direct solution (no unit).
struct ImpulseError {
  double max;  ///< The slowest contact: max over rows of |lambda - exact| / |exact|.
  double l2;   ///< |lambda - exact| / |exact|, Euclidean.
};

/// Rows whose exact impulse is 0 (below 1e-12 of the largest) are measured against the largest.
/// Both errors are 0 where all impulses are 0, and infinite where only the exact ones are.
/// Meaningful only where the impulses are unique: else wrench_error or velocity_error.
ImpulseError impulse_error(const std::vector<double>& lambda, const std::vector<double>& exact);

/// |J^T (lambda - exact)| / |J^T exact| (no unit): what the impulses do to the bodies, which is
/// unique without friction even where A is singular and the impulses are not.
/// Euclidean over the degrees of freedom, so that N s and N m s are added as numbers: compare only
/// within one scene. Preconditions: jacobian is n x dof, row-major.
/// 0 where both are 0, infinite where only the exact wrench is.
double wrench_error(const std::vector<double>& jacobian, int dof, const std::vector<double>& lambda,
                    const std::vector<double>& exact);

/// sqrt(d^T A d / exact^T A exact) with d = lambda - exact (no unit): the same in the norm of
/// kinetic energy, where units agree. Equals the change of velocity in the M-norm.
double velocity_error(const Mlcp& problem, const std::vector<double>& lambda,
                      const std::vector<double>& exact);

}  // namespace cycloid::reference
