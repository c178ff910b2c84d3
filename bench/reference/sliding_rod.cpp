#include "bench/reference/sliding_rod.hpp"

#include <cmath>

namespace cycloid::reference {

static double cosine_of(const SlidingRod& rod) {
  return 1.0 / std::sqrt(1.0 + rod.slope * rod.slope);
}

double normal_force_over_weight(const SlidingRod& rod) {
  // With c^2 = 1 / (1 + slope^2) and s c = slope c^2 no angle is rounded.
  const double cosine_squared = 1.0 / (1.0 + rod.slope * rod.slope);
  const double below = 1.0 + 3.0 * cosine_squared - 3.0 * rod.friction * rod.slope * cosine_squared;
  return below == 0.0 ? kInfinity : 1.0 / below;
}

double critical_friction(const SlidingRod& rod) {
  const double cosine_squared = 1.0 / (1.0 + rod.slope * rod.slope);
  return (1.0 + 3.0 * cosine_squared) / (3.0 * rod.slope * cosine_squared);
}

Assembled one_step(const SlidingRod& rod, double gravity, double step_s) {
  const double across = rod.half_length_m * cosine_of(rod);
  const double up = across * rod.slope;
  const double inertia = rod.mass_kg * rod.half_length_m * rod.half_length_m / 3.0;
  // The end lies at (-across, -up) from the centre: rotation moves it by (up, -across).
  Assembled assembled = assemble(2, {0.0, 1.0, -across, 1.0, 0.0, up},
                                 {1.0 / rod.mass_kg, 1.0 / rod.mass_kg, 1.0 / inertia},
                                 {rod.speed, -gravity * step_s, 0.0});
  assembled.problem.normal_of[1] = 0;
  assembled.problem.friction[1] = rod.friction;
  return assembled;
}

double kinetic_energy(const Assembled& assembled, const std::vector<double>& velocity) {
  double energy = 0.0;
  for (int d = 0; d < assembled.dof; ++d)
    energy += 0.5 * velocity[d] * velocity[d] / assembled.inverse_mass[d];
  return energy;
}

}  // namespace cycloid::reference
