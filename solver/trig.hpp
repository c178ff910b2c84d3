#pragma once

#include "solver/lanes.hpp"

namespace cycloid::solver {

inline constexpr float kPi = 3.14159265358979f;

/// Sine and cosine of `angle` [rad], within 1e-7 for |angle| <= 8192; beyond 1e6 the angle is
/// clamped. Only + - * and selects, so every target gives the same bits, which no libm does.
///
/// Source: Cody and Waite's three-part reduction to [-pi/4, pi/4] and the minimax polynomials of
/// the Cephes library (Moshier, 1984).
void sin_cos(float angle, float& sine, float& cosine);

/// The angle of (x, y) in (-pi, pi], within 3e-7; 0 for (0, 0).
float atan2(float y, float x);

}  // namespace cycloid::solver
