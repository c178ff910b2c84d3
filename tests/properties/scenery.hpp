#pragma once

#include <utility>
#include <vector>

#include "tests/properties/definitions.hpp"

namespace cycloid::properties {

/// What the commands make that came after those of definitions.hpp, whose meaning stays.

/// A floor, and 66 to 101 bodies that lie or fall on it: a wall, a block, a heap, a pavement or
/// towers. Most of them fall asleep where a tuning lets them.
template <int D>
std::vector<Piece<D>> crowd_of(const Command& command);
/// A static body with a mesh, a chain, a height field or a half-space, turned and out of place.
template <int D>
Piece<D> land_of(const Command& command);
/// A dynamic body of many corners, or of many shapes that differ in all that shapes can.
template <int D>
Piece<D> solid_of(const Command& command);

/// Particles in rows, and which of them are linked.
template <int D>
struct Cloth {
  std::vector<solver::ParticleDef<D>> particles;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> links;
  float length = 0.0f;      ///< m, of each link.
  float compliance = 0.0f;  ///< m/N.
};
template <int D>
Cloth<D> cloth_of(const Command& command);

/// joint_of with other axes, springs, curves, targets and steering.
template <int D>
solver::JointDef<D> drive_of(const Command& command);
/// Any restitution from 0 to 1, with or without friction and resistances.
solver::Material surface_of(const Command& command);

}  // namespace cycloid::properties
