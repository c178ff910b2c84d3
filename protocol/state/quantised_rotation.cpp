#include "protocol/state/quantised_rotation.hpp"

#include <algorithm>
#include <cstdlib>

#include "solver/lanes.hpp"
#include "solver/trig.hpp"

namespace cycloid::protocol {

static constexpr float kSqrtHalf = 0.70710678f;

/// To the nearest integer. @pre |value| < 2^31.
static std::int32_t rounded(float value) {
  return static_cast<std::int32_t>(value + (value < 0.0f ? -0.5f : 0.5f));
}

QuantisedRotation quantise_rotation(const solver::Rotation<3>& q) {
  QuantisedRotation rotation;
  for (std::uint8_t i = 1; i < 4; ++i)
    if (solver::abs(q[i]) > solver::abs(q[rotation.largest])) rotation.largest = i;
  const float scale = (q[rotation.largest] < 0.0f ? -1.0f : 1.0f) * kRotationParts / kSqrtHalf;
  std::size_t at = 0;
  for (int i = 0; i < 4; ++i)
    if (i != rotation.largest)
      rotation.parts[at++] = static_cast<std::int16_t>(
          std::clamp(rounded(scale * q[i]), -kRotationParts, kRotationParts));
  return rotation;
}

QuantisedRotation quantise_rotation(const solver::Rotation<2>& q) {
  const float steps = solver::atan2(q[1], q[0]) * (0.5f * kAngleSteps / solver::kPi);
  QuantisedRotation rotation;
  rotation.parts[0] = static_cast<std::int16_t>((rounded(steps) + kAngleSteps) % kAngleSteps);
  return rotation;
}

std::array<float, 4> quaternion_of(const QuantisedRotation& rotation, std::uint8_t dimension) {
  std::array<float, 4> q{0.0f, 0.0f, 0.0f, 1.0f};
  if (dimension == 2) {
    // Half of the angle, in (-pi/2, pi/2], so that w is not negative.
    std::int32_t steps = rotation.parts[0];
    if (2 * steps > kAngleSteps) steps -= kAngleSteps;
    solver::sin_cos(static_cast<float>(steps) * (solver::kPi / kAngleSteps), q[2], q[3]);
    return q;
  }
  float square = 0.0f;
  std::size_t at = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (i == rotation.largest) continue;
    q[i] = static_cast<float>(rotation.parts[at++]) * (kSqrtHalf / kRotationParts);
    square += q[i] * q[i];
  }
  q[rotation.largest & 3u] = solver::sqrt(solver::max(0.0f, 1.0f - square));
  // Parts that no rotation has may be longer than 1 without it.
  const float scale = 1.0f / solver::sqrt(solver::max(1.0f, square));
  for (float& part : q) part *= scale;
  return q;
}

bool is_on_grid(const QuantisedRotation& rotation, std::uint8_t dimension) {
  const auto& parts = rotation.parts;
  if (dimension == 2)
    return rotation.largest == 0 && parts[0] >= 0 && parts[0] < kAngleSteps && parts[1] == 0 &&
           parts[2] == 0;
  return rotation.largest < 4 && std::all_of(parts.begin(), parts.end(), [](std::int32_t part) {
           return std::abs(part) <= kRotationParts;
         });
}

/// The largest integer whose square is not above.
static std::int32_t root_of(std::int64_t square) {
  std::int32_t root = 0;
  for (std::int32_t bit = 1 << 15; bit > 0; bit >>= 1)
    if (std::int64_t{root + bit} * (root + bit) <= square) root += bit;
  return root;
}

std::array<std::int32_t, 3> parts_without(const QuantisedRotation& rotation, std::uint8_t largest) {
  std::array<std::int32_t, 3> parts{rotation.parts[0], rotation.parts[1], rotation.parts[2]};
  if (largest == rotation.largest) return parts;
  std::array<std::int32_t, 4> all{};
  // Wide, because what is heard may hold any parts until it is refused.
  std::int64_t square = 2 * kRotationParts * kRotationParts;
  std::size_t at = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (i == rotation.largest) continue;
    all[i] = parts[at++];
    square -= std::int64_t{all[i]} * all[i];
  }
  all[rotation.largest] = root_of(std::max<std::int64_t>(0, square));
  const std::int32_t sign = all[largest] < 0 ? -1 : 1;
  at = 0;
  for (std::size_t i = 0; i < 4; ++i)
    if (i != largest) parts[at++] = sign * all[i];
  return parts;
}

}  // namespace cycloid::protocol
