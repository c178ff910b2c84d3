#pragma once

#include <span>
#include <vector>

#include "solver/collision/bounds_tree.hpp"
#include "solver/particles/links.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// Memory that move_particles keeps from tick to tick. It holds nothing that the next tick reads.
template <int D>
struct ParticleScratch {
  std::vector<ParticleMotion<D>> motions;  ///< Per particle.
  std::vector<std::uint32_t> held;         ///< Per particle: 1 where a pin holds it.
  std::vector<Vec<D>> targets;  ///< Per held particle: its offset at the end of the tick, m.
  std::vector<float> lambdas;   ///< Per link.
  std::vector<typename BoundsTree<D>::Leaf> leaves;
  std::vector<std::uint32_t> unbounded;  ///< Half-spaces, by slot.
  BoundsTree<D> tree;
  TreeRoom<D> tree_room;
  std::vector<std::uint32_t> nearby;  ///< Shapes that one particle may meet, by slot.
};

/// Advances live particles by one tick of position-based dynamics. Per substep of h = tick_s / n:
/// predict x* = x + h (v + h g) / (1 + h damping); `sweeps` sweeps over the links; each particle
/// flies from x towards where that left it and is stopped by shapes; v = (x' - x) / h. There is no
/// velocity solver: an impact is inelastic, and friction shortens the displacement along the
/// surface, relative to the body's surface, by at most mu times what the shape took from it along
/// the normal. mu mixes the two materials as contacts do; restitution is not used.
///
/// Coupling is one way: bodies push particles and hold pins; particles and links do not act on
/// bodies. Particles do not collide with each other, and a rope does not cut a shape that it spans
/// between two of its particles. Held and pinned particles do not collide. Pins move their particle
/// to the anchor at an even pace over the tick; of several pins the lowest slot holds.
///
/// No particle passes a static shape at any speed: flight is swept against the signed distance
/// (shape_distance.hpp). `state` has bodies at the end of the tick. A particle that a body's motion
/// has swallowed is led out at an even pace over the tick, at the speed at which the body entered;
/// it leaves through the nearest surface, so a body that moves further in a tick than half its
/// thickness can leave a particle behind.
///
/// Deterministic: particles and links in the order of their slots, shapes met by slot, no history
/// but the state. Results do not depend on `scratch`. Reads gravity [m/s^2] from the argument, not
/// from the state.
/// @pre tick_s > 0 [s]; slots named by live records exist; values are within the bounds of
/// validate.hpp. Leaving them is for the caller to check afterwards: nothing here fails.
/// Source: Mueller et al., "Position Based Dynamics" (2006); Macklin et al., "XPBD" (MIG 2016) and
/// "Small Steps in Physics Simulation" (SCA 2019); friction: Macklin et al., "Unified Particle
/// Physics for Real-Time Applications" (SIGGRAPH 2014); Catto, "Understanding Constraints" (GDC
/// 2014).
template <int D>
void move_particles(float tick_s, const Vec<D>& gravity, const ParticleTuning& tuning,
                    const WorldState<D>& state, std::span<Particle<D>> particles,
                    std::span<const Link> links, std::span<const Pin<D>> pins,
                    ParticleScratch<D>& scratch);

}  // namespace cycloid::solver
