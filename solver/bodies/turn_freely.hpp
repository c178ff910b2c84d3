#pragma once

#include "solver/motion.hpp"

namespace cycloid::solver {

// How a free body turns in space, one body at a time or one in each lane: the same formulas, so the
// same bits.

/// Rows times a vector, T being a float or lanes of them.
template <class T>
Vec<3, T> times(const T (&m)[9], const Vec<3, T>& v) {
  Vec<3, T> product = Vec<3, T>::zero();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) product[i] = product[i] + m[i * 3 + j] * v[j];
  return product;
}

/// exp(-turn) v - v, as a difference that keeps its digits. @pre |turn| is below half a radian.
template <class T>
Vec<3, T> small_turned_back_change(const Vec<3, T>& turn, const Vec<3, T>& v) {
  const T square = dot(turn, turn);
  const T sine =
      T(1.0f) - square * (T(1.0f / 6.0f) - square * (T(1.0f / 120.0f) - square / T(5040.0f)));
  const T versine =
      T(0.5f) - square * (T(1.0f / 24.0f) - square * (T(1.0f / 720.0f) - square / T(40320.0f)));
  const Vec<3, T> across = cross(turn, v);
  return versine * cross(turn, across) - sine * across;
}

/// A power of two, which rounds nothing, that brings the third power of moments from 1e-21 to
/// 1e26 kg m^2 into the range of a float. Those of most bodies are there: 1.
template <class T>
T scale_into_range(const T (&m)[9]) {
  const T greatest = max(m[0], max(m[4], m[8]));
  const T not_small = select(greatest > T(0x1p28f), T(0x1p-54f), T(1.0f));
  return select(greatest < T(0x1p-24f), T(0x1p40f), not_small);
}

/// (I + [a]x)^-1 b by Cramer's rule: regular for every a, since its determinant is
/// det I + a . I a > 0.
template <class T>
Vec<3, T> solve_turning(const T (&m)[9], const Vec<3, T>& a, const Vec<3, T>& b) {
  const T scale = scale_into_range(m);
  const Vec<3, T> x = scale * Vec<3, T>{{m[0], m[3] + a[2], m[6] - a[1]}};
  const Vec<3, T> y = scale * Vec<3, T>{{m[1] - a[2], m[4], m[7] + a[0]}};
  const Vec<3, T> z = scale * Vec<3, T>{{m[2] + a[1], m[5] - a[0], m[8]}};
  const Vec<3, T> across = cross(y, z);
  const T inverse = scale / dot(x, across);
  return {{inverse * dot(b, across), inverse * dot(b, cross(z, x)), inverse * dot(b, cross(x, y))}};
}

/// Most of them; two or three are the rule, a needle across its length at 1 rad per substep takes
/// all.
inline constexpr int kMidpointIterations = 8;
/// Where they end: |moved|^2 over |spin|^2.
inline constexpr float kMidpointAccuracy = 1.0e-14f;

/// How far a body that tumbles turns at once, rad, and into how many parts a substep is divided so
/// that it turns no further. Beyond a whole turn there are spins of the middle that answer to other
/// energies, and Newton's method may find one of those. Lanes leave to this whatever would turn by
/// 1 rad at its spin (kSmallTurnSquare, of half a step), give or take rounding: this bound has to
/// stay above that, or a body near it would move otherwise alone than in lanes.
inline constexpr float kTurnMost = 1.1f;
inline constexpr int kTurnParts = 256;

/// Whether a body turns as any other, for whose inertia all axes are alike, or does not turn.
bool keeps_its_spin(const Body<3>& body);

/// In space a body keeps its angular momentum L = I w, so the spin changes as the inertia turns
/// with the body. In the body's frame L' = exp(-h m) L, where m, the spin of the step's middle,
/// answers to exp(-h m / 2) L: the implicit midpoint rule, symmetric in time, so that L is kept to
/// rounding and the energy without drift. The explicit term h w x I w gains energy, Catto's
/// implicit one (GDC 2015) loses it. By Newton's method: simple iteration diverges for needles,
/// whose small moment answers to the large momentum.
///
/// Only changes of the spin pass through I^-1 and the frame of the body: whole spins would take
/// their rounding along in every substep.
void turn_freely(float h, const Body<3>& body, Motion<3>& motion);

}  // namespace cycloid::solver
