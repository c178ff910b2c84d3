#pragma once

#include <array>
#include <cstdint>

#include "protocol/state/quantised.hpp"
#include "solver/dim.hpp"

namespace cycloid::protocol {

/// @pre q has length 1, but for rounding.
QuantisedRotation quantise_rotation(const solver::Rotation<3>& q);
QuantisedRotation quantise_rotation(const solver::Rotation<2>& q);

/// Unit quaternion x, y, z, w; in the plane about z. Whatever the parts, finite and of length 1.
std::array<float, 4> quaternion_of(const QuantisedRotation& rotation, std::uint8_t dimension);

/// Whether the numbers are ones that quantise_rotation gives for that dimension.
bool is_on_grid(const QuantisedRotation& rotation, std::uint8_t dimension);

/// The parts that the rotation would have if component `largest` were left out: the guess for a
/// body whose largest component has become another. In integers, so that both ends guess alike.
std::array<std::int32_t, 3> parts_without(const QuantisedRotation& rotation, std::uint8_t largest);

}  // namespace cycloid::protocol
