#pragma once

#include "solver/motion.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

/// Whether two bodies can pass through one another in a tick, T being a float or lanes of them.

/// A body on its way through the tick.
template <int D, class T>
struct PassingBody {
  Vec<D, T> position;  ///< At the start, m.
  T extent;            ///< m.
  T thickness;         ///< m; of what does not yield, kUnyielding.
  Spin<D, T> spin;
  Vec<D, T> delta_position;
  Rotation<D, T> delta_rotation;
};

/// Thicker than anything.
inline constexpr float kUnyielding = 3.0e38f;

/// Whether a body's final rotation does not say any more how far it turned in the tick.
template <int N, class T>
[[gnu::always_inline]] inline auto winds(T tick_s, const Vec<N, T>& spin) {
  const Vec<N, T> spun = tick_s * spin;
  return dot(spun, spun) > T(kPi * kPi);
}

/// The most that a rotation may turn, rad, or more: without a function of trigonometry.
template <class T>
[[gnu::always_inline]] inline T turn_bound(const Vec<2, T>& q) {
  const T sine = select(q[1] < T(0.0f), -q[1], q[1]);
  return select(q[0] < T(0.0f), T(2.0f * kPi), T(1.6f) * sine + T(1.0e-5f));
}
template <class T>
[[gnu::always_inline]] inline T turn_bound(const Vec<4, T>& q) {
  const T sine = length(Vec<3, T>{{q[0], q[1], q[2]}});
  return select(q[3] < T(0.0f), T(2.0f * kPi), T(3.2f) * sine + T(1.0e-5f));
}

/// By how much at most the way of a point, m, leaves its chord as seen from a body that turns by
/// `turn`, rad: an eighth of its greatest acceleration (w^2 r across, 2 w v along). It starts at
/// the distance `from` and goes `size`, m.
template <class T>
[[gnu::always_inline]] inline T bulge_of(T turn, T from, T size) {
  return T(0.125f) * turn * (turn * (from + size) + T(2.0f) * size);
}

/// The farthest that a point of b may move past a in the tick, m, seen from a, which turns: the
/// centre of b along a curve, and b by its turn less that of a. @pre neither winds.
template <int D, class T>
[[gnu::always_inline]] inline T way_past(const PassingBody<D, T>& a, const PassingBody<D, T>& b) {
  const Vec<D, T> from = b.position - a.position;
  const Vec<D, T> way = b.delta_position - a.delta_position;
  const Vec<D, T> seen = rotate_back(a.delta_rotation, from + way) - from;
  const T bulge = bulge_of(turn_bound(a.delta_rotation), length(from), length(way));
  const Rotation<D, T> relative = compose(conjugate(a.delta_rotation), b.delta_rotation);
  return length(seen) + bulge + b.extent * turn_bound(relative);
}

/// 1 where two bodies may move past one another so far that one passes through the other, or over
/// its corner: by half the thickness of the thinner one, or of the one that yields; else 0. What
/// flies side by side does not, however fast: stopped at its neighbours a crowd would lose its way
/// for nothing, and what drives it from behind would run over it.
template <int D, class T>
[[gnu::always_inline]] inline T can_pass(T tick_s, const PassingBody<D, T>& a,
                                         const PassingBody<D, T>& b) {
  const T one = T(1.0f);
  const T enough = T(0.5f) * min(a.thickness, b.thickness);
  const T past = min(way_past(a, b), way_past(b, a));
  const T passes = select(past > enough, one, T(0.0f));
  return select(winds(tick_s, a.spin), one, select(winds(tick_s, b.spin), one, passes));
}

}  // namespace cycloid::solver
