#pragma once

#include "solver/constraints/block.hpp"

namespace cycloid::solver {

/// In the plane there is one direction to slide.
template <class L>
void turn_against_slip(const L&, const L&, const L (&)[2][2], const L (&)[2], L (&)[2], L&) {}

/// Turns the direction of friction, inverse_size times slide[1] and slide[2], against the slip that
/// it leaves. Few projected steps: the slip of one point is not far from the sticking impulse.
template <class L>
void turn_against_slip(const L& friction, const L& bounced, const L (&k)[3][3], const L (&d)[3],
                       L (&slide)[3], L& inverse_size) {
  for (int i = 1; i < 3; ++i) slide[i] = inverse_size * slide[i];
  inverse_size = L(1.0f);
  constexpr int kSteps = 6;
  const L zero(0.0f);
  const L most = max(k[1][1], k[2][2]);
  const L step = select(most > zero, L(1.0f) / select(most > zero, most, L(1.0f)), zero);
  for (int pass = 0; pass < kSteps; ++pass) {
    const L lifts = friction * (slide[1] * k[0][1] + slide[2] * k[0][2]);
    const L k_slide = k[0][0] + lifts;
    const auto pushes = k_slide > zero;
    const L arrives = -d[0] - bounced * lifts;
    const L normal = select(pushes, max(arrives / select(pushes, k_slide, L(1.0f)), zero), zero);
    const L rubs = friction * (normal + bounced);
    L next[3];
    for (int i = 1; i < 3; ++i) {
      const L slip = d[i] + k[i][0] * normal + rubs * (k[i][1] * slide[1] + k[i][2] * slide[2]);
      next[i] = rubs * slide[i] - step * slip;
    }
    const L size = sqrt(next[1] * next[1] + next[2] * next[2]);
    const auto has_size = size > L(1.0e-30f);
    for (int i = 1; i < 3; ++i)
      slide[i] = select(has_size, next[i] / max(size, L(1.0e-30f)), slide[i]);
  }
}

/// The tangents that stick where the normal has no impulse.
template <int N, class L>
void stick_alone(const L (&k)[N][N], const L (&d)[N], L (&stick)[N]) {
  L k_tangents[N - 1][N - 1];
  L tangents[N - 1];
  for (int i = 1; i < N; ++i) {
    tangents[i - 1] = -d[i];
    for (int j = 1; j < N; ++j) k_tangents[i - 1][j - 1] = k[i][j];
  }
  BlockFactor<N - 1, L> factor;
  factor.factor(k_tangents, N - 1);
  factor.solve(tangents, N - 1);
  stick[0] = L(0.0f);
  for (int i = 1; i < N; ++i) stick[i] = tangents[i - 1];
}

/// x with K x + d = 0 where it sticks; see solve_points_coupled. `bounced` is an impulse along the
/// normal that friction may use beside x[0]: where that alone parts the bodies, they rub without
/// pushing.
template <int N, class L>
void solve_cone(const L& friction, const L& bounced, const L (&k)[N][N], const L (&d)[N],
                L (&x)[N]) {
  const L zero(0.0f);
  BlockFactor<N, L> factor;
  factor.factor(k, N);
  L stick[N];
  for (int i = 0; i < N; ++i) stick[i] = -d[i];
  factor.solve(stick, N);
  L alone[N];
  stick_alone(k, d, alone);
  const L parts = select(stick[0] > zero, zero, bounced);
  for (int i = 0; i < N; ++i) stick[i] = select(parts > zero, alone[i], stick[i]);
  L square = zero;
  for (int i = 1; i < N; ++i) square += stick[i] * stick[i];
  const L size = sqrt(square);
  L inverse_size = L(1.0f) / max(size, L(1.0e-30f));
  L along[N];
  for (int i = 1; i < N; ++i) along[i] = stick[i];
  turn_against_slip(friction, bounced, k, d, along, inverse_size);
  L lifts = zero;
  L k_slide = k[0][0];
  for (int i = 1; i < N; ++i) {
    const L lift = friction * inverse_size * along[i] * k[0][i];
    lifts += lift;
    k_slide += lift;
  }
  const L pushes = stick[0] + bounced;
  // A slide that would need no normal impulse to stop the approach does not exist: stick instead.
  const L slides = select(size > friction * pushes, select(k_slide > zero, L(1.0f), zero), zero);
  const L arrives = -d[0] - bounced * lifts;
  const L slide_normal = max(arrives / select(k_slide > zero, k_slide, L(1.0f)), zero);
  x[0] = select(slides > zero, slide_normal, max(stick[0], zero));
  for (int i = 1; i < N; ++i) {
    const L slide = friction * (slide_normal + bounced) * inverse_size * along[i];
    x[i] = select(slides > zero, slide, select(pushes > zero, stick[i], zero));
  }
}

}  // namespace cycloid::solver
