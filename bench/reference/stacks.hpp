#pragma once

#include <vector>

#include "bench/reference/problem.hpp"
#include "bench/reference/projected_gauss_seidel.hpp"

namespace cycloid::reference {

/// Circles of these masses (kg, > 0), the first on the ground, each one on the one before, in one
/// vertical line: n degrees of freedom, n central contacts without friction, contact 0 with the
/// ground. All move with -gravity * step_s (m/s), as after one step of free fall.
/// Source: Catto 2014, "Understanding Constraints", and its script for convergence over mass ratio.
Assembled stack_of_circles(const std::vector<double>& masses, double gravity, double step_s);

/// A square box of mass 1 kg and half width `half_width` (m, > 0) on two contacts at
/// -+ `contact_offset` (m) from its middle, contact 0 at the left; it falls with `speed` (m/s). Its
/// inertia is 2/3 m half_width^2. Degrees of freedom: height (m), angle (rad).
/// Source: Catto 2014, "Understanding Constraints", box on a pole.
Assembled box_on_pole(double half_width, double contact_offset, double speed = 1.0);

/// Sweeps of projected Gauss-Seidel from zero, in the arithmetic of `Real` (float, double), until
/// the relative error of the slowest contact against the direct solution (ImpulseError::max) is at
/// most `tolerance`. Independent of units of mass and of gravity and step, up to rounding.
/// options.sweeps is the most that are tried. Returns 0 where they do not suffice, or where the
/// direct solution did not converge or is not unique. The definition of accuracy that reproduces
/// the figures of Catto 2014 at tolerance 0.05, bottom-up.
template <class Real>
int sweeps_to(const Mlcp& problem, double tolerance, const PgsOptions& options);

}  // namespace cycloid::reference
