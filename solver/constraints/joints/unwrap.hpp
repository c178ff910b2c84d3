#pragma once

#include "solver/dim.hpp"
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

}  // namespace cycloid::solver
