#pragma once

#include <span>

#include "solver/particles/particle.hpp"

namespace cycloid::solver {

/// What a tick changes of a particle. Both are differences, so a short substep far from the origin
/// keeps its digits: at 100 m, h^2 g of a 1 ms substep is less than one place of a float.
template <int D>
struct ParticleMotion {
  Vec<D> offset;        ///< Moved since the start of the tick, up to this substep, m.
  Vec<D> displacement;  ///< Moved in this substep, m.
  float inverse_mass;   ///< 1/kg; 0 where a pin holds the particle.
};

/// One sweep over the live links in the order of their slots, each solved as if it were alone:
///   C = |x_b - x_a| - length [m],  u = (x_b - x_a) / |x_b - x_a|,  a' = compliance / h^2 [1/kg],
///   dlambda = -(C + a' lambda) / (w_a + w_b + a'),  dx_a = -w_a dlambda u,  dx_b = w_b dlambda u.
/// For compliance 0 that removes C at once, shared in the ratio of the inverse masses w. Particles
/// that coincide part along the first axis. Momentum is conserved: the two moves cancel in mass.
///
/// `particles` gives the positions at the start of the tick; writes displacements and `lambdas`
/// [kg m], one per link, which the caller zeroes at the start of each substep. Links with a free
/// particle, or without any mass to move, do nothing.
/// @pre h > 0 [s]; particle_a and particle_b of live links are slots of `particles`.
/// Source: Jakobsen, "Advanced Character Physics" (GDC 2001); Mueller et al., "Position Based
/// Dynamics" (2006); Macklin et al., "XPBD" (MIG 2016).
template <int D>
void project_links(float h, std::span<const Particle<D>> particles, std::span<const Link> links,
                   std::span<ParticleMotion<D>> motions, std::span<float> lambdas);

}  // namespace cycloid::solver
