#pragma once

#include "solver/dim.hpp"
#include "solver/direct/wide.hpp"
#include "solver/state.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

/// The angle of `rotation` that is nearest to `last` [rad]: whole turns are counted as long as a
/// body turns less than half a turn between two calls.
inline float unwrapped_angle(const Rotation<2>& rotation, float last) {
  float sine = 0.0f;
  float cosine = 0.0f;
  sin_cos(last, sine, cosine);
  const Rotation<2> since = compose(Rotation<2>{{cosine, -sine}}, rotation);
  return last + atan2(since[1], since[0]);
}
/// Gears are planar; space has no one angle.
inline float unwrapped_angle(const Rotation<3>&, float last) {
  return last;
}

/// `angle` [rad, within 1e7] by whole turns as near to `near` [rad] as it comes: itself, to the
/// bit, where that is within half a turn, or no number. What a cast to int makes of no number is
/// not the same on every machine, so none gets there.
inline float nearest_turn(float angle, float near) {
  constexpr Wide kTurn = 6.283185307179586;
  const Wide turns = (static_cast<Wide>(angle) - static_cast<Wide>(near)) / kTurn;
  const bool is_beyond = turns > 0.5 || turns < -0.5;
  if (!is_beyond) return angle;
  const auto whole = static_cast<int>(turns + (turns < 0.0 ? -0.5 : 0.5));
  return static_cast<float>(static_cast<Wide>(angle) - static_cast<Wide>(whole) * kTurn);
}

/// `angle` [rad, in (-pi, pi]] within half a turn of `middle` [rad, within 3.2]: itself, to the
/// bit, where it is so already.
inline float angle_near(float angle, float middle) {
  const float beyond = angle - middle;
  if (beyond > kPi) return angle - 2.0f * kPi;
  return beyond < -kPi ? angle + 2.0f * kPi : angle;
}

/// An angle between limits is that of the turn in which these lie: past half a turn it would leap
/// to the far side of both, and the one that it has passed would push it on.
template <int D>
float angle_between_limits(float angle, const Joint<D>& joint) {
  return joint.limit_enabled != 0 ? angle_near(angle, 0.5f * (joint.lower + joint.upper)) : angle;
}

}  // namespace cycloid::solver
