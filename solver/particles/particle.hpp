#pragma once

#include <type_traits>

#include "solver/definitions.hpp"

namespace cycloid::solver {

/// The records below are state: flat, trivially copyable, and every field has 4 bytes, so there is
/// no padding. They include definitions.hpp alone, so that state.hpp can hold arrays of them.

/// A point mass that moves by position-based dynamics. Particles collide with shapes, not with
/// each other.
template <int D>
struct Particle {
  std::uint32_t generation = 0;
  std::uint32_t kind = 0;            ///< 0: the slot is free, 1: live.
  std::uint32_t material = 0;        ///< Index of a material of the world: its friction.
  std::uint32_t group = 0;           ///< The user's own: which rope or cloth it is of.
  Filter filter;                     ///< Which shapes it meets.
  Vec<D> position = Vec<D>::zero();  ///< World, m.
  Vec<D> velocity = Vec<D>::zero();  ///< m/s.
  float inverse_mass = 1.0f;         ///< 1/kg; 0: pinned, moves only with a Pin.
  float radius = 0.01f;              ///< m, > 0.
};

/// Keeps two particles at a distance: C = |x_b - x_a| - length.
struct Link {
  std::uint32_t generation = 0;
  std::uint32_t kind = 0;  ///< 0: the slot is free, 1: live.
  std::uint32_t particle_a = 0xffffffffu;
  std::uint32_t particle_b = 0xffffffffu;
  float length = 0.0f;      ///< m, >= 0.
  float compliance = 0.0f;  ///< m/N; 0 is rigid.
};

/// Holds a particle to a point of a body. The body does not feel it.
template <int D>
struct Pin {
  std::uint32_t generation = 0;
  std::uint32_t kind = 0;  ///< 0: the slot is free, 1: live.
  std::uint32_t particle = 0xffffffffu;
  std::uint32_t body = 0xffffffffu;
  Vec<D> anchor = Vec<D>::zero();  ///< Body frame, from the centre of mass, m.
};

/// Of a tick, `substeps` of tick_s / substeps with `sweeps` over the links in each. One substep
/// more does more against stretching than one sweep more: the error of a hanging cloth falls with
/// the square of the substeps. Source: Macklin et al., "Small Steps in Physics Simulation"
/// (SCA 2019).
struct ParticleTuning {
  std::uint32_t substeps = 40;  ///< >= 1
  std::uint32_t sweeps = 2;     ///< >= 1
  float damping = 0.0f;         ///< Of the velocity against the world, 1/s, >= 0.
};

static_assert(std::is_trivially_copyable_v<Particle<2>> && sizeof(Particle<2>) == 4 * 13);
static_assert(std::is_trivially_copyable_v<Particle<3>> && sizeof(Particle<3>) == 4 * 15);
static_assert(std::is_trivially_copyable_v<Link> && sizeof(Link) == 4 * 6);
static_assert(std::is_trivially_copyable_v<Pin<2>> && sizeof(Pin<2>) == 4 * 6);
static_assert(std::is_trivially_copyable_v<Pin<3>> && sizeof(Pin<3>) == 4 * 7);
static_assert(std::is_trivially_copyable_v<ParticleTuning>);

}  // namespace cycloid::solver
