#pragma once

#include <vector>

#include "bench/reference/problem.hpp"

namespace cycloid::reference {

/// Painleve's rod: uniform, its lower end on the ground, the rest above and towards +x. It shows
/// why accelerations are not solved for: their equations may have no solution, those of velocities
/// over one step always do.
struct SlidingRod {
  double mass_kg = 1.0;        ///< > 0.
  double half_length_m = 1.0;  ///< > 0.
  double slope = 2.0;          ///< Tangent of the angle to the ground, > 0; 2 is 63.435 degrees.
  double friction = 0.0;       ///< Coefficient, >= 0.
  /// Of the rod along x, without rotation (m/s). Below 0 the end digs in: friction presses it into
  /// the ground. Above 0 friction lifts it, which is called harmless.
  double speed = -10.0;
};

/// The normal force over the weight, N / (m g), while the end digs in and its acceleration towards
/// the ground is 0: 1 / (1 + 3 c^2 - 3 mu s c) with the cosine c and sine s of the angle, before
/// it rotates. Without bound as mu nears (1 + 3 c^2) / (3 s c), and negative above it (no
/// solution); exactly there +infinity. Source: Painleve 1895; Baraff 1991, "Coping with friction".
double normal_force_over_weight(const SlidingRod& rod);

/// The coefficient of friction from which on no forces exist: (1 + 3 c^2) / (3 s c), 4/3 at slope
/// 2. The same number is K_nn / |K_nt|, where Gauss-Seidel over normal and friction cycles.
double critical_friction(const SlidingRod& rod);

/// One step of velocities: row 0 the normal, row 1 its friction. Degrees of freedom x, y (m), angle
/// (rad); gravity (m/s^2) has acted for step_s.
Assembled one_step(const SlidingRod& rod, double gravity, double step_s);

/// Of these velocities of the bodies (J): v^T M v / 2.
/// Preconditions: velocity has assembled.dof entries.
double kinetic_energy(const Assembled& assembled, const std::vector<double>& velocity);

}  // namespace cycloid::reference
