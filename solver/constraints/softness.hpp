#pragma once

#include "solver/trig.hpp"

namespace cycloid::solver {

/// How a row corrects its error: impulse = -mass_scale K^-1 (Cdot + bias_rate C) - impulse_scale
/// accumulated. The same three numbers are a rigid row, Baumgarte's bias and a damped spring.
struct Softness {
  float bias_rate;  ///< 1/s
  float mass_scale;
  float impulse_scale;
};

/// How far a row of effective mass 1 gives way for good under an impulse of 1 in every substep, s:
/// 1 / (h omega^2); 0 of what is rigid.
inline float yield_of(const Softness& softness) {
  if (softness.impulse_scale == 0.0f) return 0.0f;
  return softness.impulse_scale / (softness.mass_scale * softness.bias_rate);
}

inline constexpr Softness kRigid = {0.0f, 1.0f, 0.0f};

/// bias = (beta / h) C. Source: Baumgarte (1972), as in Catto, GDC 2006.
inline Softness baumgarte_softness(float beta, float h) {
  return {beta / h, 1.0f, 0.0f};
}

/// A spring of frequency `hertz` and damping ratio `zeta` on the row's own effective mass, in
/// implicit Euler with step h: never unstable, the same for every mass.
/// Source: Catto, "Soft Constraints" (GDC 2011), in the form of "Solver2D" (2024).
inline Softness spring_softness(float hertz, float zeta, float h) {
  if (hertz == 0.0f) return kRigid;
  const float omega = 2.0f * kPi * hertz;
  const float a1 = 2.0f * zeta + h * omega;
  const float a2 = h * omega * a1;
  const float a3 = 1.0f / (1.0f + a2);
  return {omega / a1, a2 * a3, a3};
}

}  // namespace cycloid::solver
