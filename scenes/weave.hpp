#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "scenes/scene.hpp"
#include "solver/world.hpp"

namespace cycloid::scenes {

/// Most particles of all cloths of a scene together: a cloth is a few numbers, which would
/// otherwise ask for any amount of memory.
inline constexpr std::uint32_t kClothParticlesMax = 1u << 16;

/// The particles of a cloth in a world, row after row.
using Weave = std::vector<solver::ParticleId>;

/// Makes the particles and links of a cloth: particles row after row, then the links along rows,
/// along columns, and across each cell. @pre the material is an index of the world.
/// @returns the field of the cloth that is in the way, or "" and the particles in `weave`. A cloth
/// that does not fit the world's limits is refused before anything is made.
template <int D>
std::string weave_cloth(const Cloth& cloth, std::uint32_t material, solver::World<D>& world,
                        Weave& weave);

}  // namespace cycloid::scenes
