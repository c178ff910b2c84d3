#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "scenes/simulation.hpp"

namespace cycloid::protocol {

// The grid of the quantised profile. All of them are part of the format: the numbers that travel
// are multiples of these steps.

/// m. A captured position is within half of it (and the rounding of a float) of the exact one, on
/// each axis, up to kPositionLimit_m from the origin; farther away it is clamped to that.
inline constexpr float kPositionStep_m = 1.0f / 512.0f;
inline constexpr float kPositionLimit_m = 4.0e6f;

/// In space a rotation is its three smallest components, in steps of sqrt(1/2) / kRotationParts.
/// The one left out is at least 1/2, so an error e of each of the three turns the body by at most
/// 4 sqrt(3) e and terms of e^2: for half a step less than 0.0049 rad, a third of a degree.
inline constexpr std::int32_t kRotationParts = 511;
inline constexpr float kRotationErrorMax_rad = 0.0049f;

/// In the plane it is an angle, in so many steps a turn: within half a step, 0.00077 rad.
inline constexpr std::int32_t kAngleSteps = 4096;
inline constexpr float kAngleErrorMax_rad = 0.00077f;

/// m/s and rad/s; within half of it up to kVelocityLimit, where it is clamped.
inline constexpr float kVelocityStep = 1.0f / 32.0f;
inline constexpr float kVelocityLimit = 1000.0f;

/// In space: `largest` says which component of the quaternion is left out and positive, `parts` are
/// the others in order. In the plane: parts[0] is the angle in steps, from 0; the rest is 0.
struct QuantisedRotation {
  std::uint8_t largest = 0;
  std::array<std::int16_t, 3> parts{};
  friend bool operator==(const QuantisedRotation&, const QuantisedRotation&) = default;
};

struct QuantisedBody {
  std::uint32_t index = 0;
  std::uint32_t generation = 0;
  std::array<std::int32_t, 3> position{};  ///< Of the body's frame, in steps.
  QuantisedRotation rotation;
  std::array<std::int16_t, 3> velocity{};  ///< Of that point, in steps; 0 where left out.
  std::array<std::int16_t, 3> spin{};
  bool at_rest = false;  ///< Static, asleep, or a kinematic body that stands still.
  friend bool operator==(const QuantisedBody&, const QuantisedBody&) = default;
};

struct QuantisedCharacter {
  std::array<std::int32_t, 3> position{};
  std::array<std::int16_t, 3> velocity{};
  bool grounded = false;
  friend bool operator==(const QuantisedCharacter&, const QuantisedCharacter&) = default;
};

/// What a client with the quantised profile sees of a world after one tick.
struct QuantisedState {
  std::uint64_t tick = 0;
  std::uint8_t dimension = 3;
  std::vector<QuantisedBody> bodies;           ///< By rising index, each index once.
  std::vector<QuantisedBody> particles;        ///< The same; without rotation and spin.
  std::vector<QuantisedCharacter> characters;  ///< In the scene's order.

  friend bool operator==(const QuantisedState&, const QuantisedState&) = default;
};

struct CaptureOptions {
  bool velocities = false;  ///< For clients that extrapolate; about two bytes more a moving body.
};

/// The state as it is now, on the grid.
QuantisedState capture(const scenes::Simulation& simulation, const CaptureOptions& options = {});

/// XXH3 over dimension, tick and all that `==` compares: protocol::StateDelta::digest of the
/// quantised profile.
std::uint64_t digest_of(const QuantisedState& state);

/// Whether two states show the same, whatever their ticks.
bool shows_the_same(const QuantisedState& a, const QuantisedState& b);

/// Bytes that the state takes in memory, for a history's bound.
std::size_t size_bytes(const QuantisedState& state);

/// The middle of the grid's cell, as a viewer needs it. The rotation has length 1.
scenes::Pose pose_of(const QuantisedBody& body, std::uint8_t dimension);
scenes::CharacterPose pose_of(const QuantisedCharacter& character);
std::array<float, 3> velocity_of(const QuantisedBody& body);  ///< m/s
std::array<float, 3> spin_of(const QuantisedBody& body);      ///< rad/s

}  // namespace cycloid::protocol
