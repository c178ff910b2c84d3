#pragma once

#include "solver/dim.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// What a substep changes of a body, in one record that a lane gathers: 32 bytes in the plane.
/// Positions are deltas since the start of the tick, so they keep their digits far from the origin.
template <int D>
struct alignas(Dim<D>::kMotionFloats * 4) Motion {
  Vec<D> velocity;        ///< m/s
  Spin<D> spin;           ///< rad/s
  Vec<D> delta_position;  ///< m
  Rotation<D> delta_rotation;
};

static_assert(sizeof(Motion<2>) == 32 && sizeof(Motion<3>) == 64);

template <int D>
inline constexpr int kMotionComponents = 2 * D + Dim<D>::kSpin + Dim<D>::kRotation;
/// Groups of four floats that hold velocity and spin, and the first components of the position.
template <int D>
inline constexpr int kVelocityQuads = (D + Dim<D>::kSpin + 3) / 4;
template <int D>
inline constexpr int kPoseQuads = (kMotionComponents<D> + 3) / 4;

/// How a substep of h changes the floats of a motion's velocity quads: x' = factor (x + h rate).
/// The factor 1 and the rate -0 leave a float as it is, to the bit.
template <int D>
struct alignas(16) Acceleration {
  float factor[4 * kVelocityQuads<D>];
  float rate[4 * kVelocityQuads<D>];
};

/// What the sweeps need of a body besides its motion, constant during a tick. In whole quads, for
/// lanes to gather.
template <int D>
struct alignas(16) BodyMass {
  float inverse_mass;
  Inertia<D> inverse_inertia;  ///< World frame at the start of the tick.
};

template <int D>
bool can_turn(const BodyMass<D>& mass) {
  for (const float value : mass.inverse_inertia.m)
    if (value != 0.0f) return true;
  return false;
}

/// Half a radian, squared: below it, which is all but every turn of a substep, four terms of the
/// series of sine and cosine are exact to rounding, and cost neither a root nor a division.
inline constexpr float kSmallTurnSquare = 0.25f;

/// The rotation by `turn` [rad], whose square is given, T being a float or lanes of them.
/// @pre square < kSmallTurnSquare.
template <class T>
Vec<4, T> small_rotation_by(const Vec<3, T>& turn, T square) {
  const T x = T(0.25f) * square;
  const T sine =
      T(0.5f) * (T(1.0f) - x * (T(1.0f / 6.0f) - x * (T(1.0f / 120.0f) - x * T(1.0f / 5040.0f))));
  const T cosine =
      T(1.0f) -
      x * (T(0.5f) - x * (T(1.0f / 24.0f) - x * (T(1.0f / 720.0f) - x * T(1.0f / 40320.0f))));
  return {{sine * turn[0], sine * turn[1], sine * turn[2], cosine}};
}

/// The rotation by the vector `turn` [rad], exact and not its linearisation: a body that spins
/// freely keeps its rate.
Rotation<2> rotation_by(const Spin<2>& turn);
Rotation<3> rotation_by(const Spin<3>& turn);

/// The rotation vector of q, rad, the shorter way: the inverse of rotation_by.
Spin<2> turn_of(const Rotation<2>& q);
Spin<3> turn_of(const Rotation<3>& q);

/// q' = exp(turn) q, at unit length.
template <int D>
void turn_by(const Spin<D>& turn, Motion<D>& motion) {
  if (dot(turn, turn) == 0.0f) return;
  motion.delta_rotation =
      normalized_or(compose(rotation_by(turn), motion.delta_rotation), motion.delta_rotation);
}

}  // namespace cycloid::solver
