#pragma once

#include <span>

#include "solver/motion.hpp"
#include "solver/step_context.hpp"

namespace cycloid::solver {

/// One joint during a tick: what `prepare` computed of it and the impulses it accumulates.
template <int D>
struct JointRow {
  std::uint32_t joint;  ///< Slot.
  JointKind kind;
  std::uint32_t body_a;
  std::uint32_t body_b;
  BodyMass<D> mass_a;
  BodyMass<D> mass_b;
  Vec<D> r_a;  ///< Anchors from the centres, world axes, at the start of the tick, m.
  Vec<D> r_b;
  Vec<D> centre_offset;  ///< Centre of b from centre of a, at the start of the tick, m.
  Rotation<D> angle;     ///< Of b relative to a since creation, at the start of the tick.
  float length;
  Softness spring;  ///< Distance with hertz > 0; kRigid otherwise.
  bool is_spring;
  bool limit_enabled;
  bool motor_enabled;
  float lower_angle;
  float upper_angle;
  float motor_speed;
  float motor_torque_max;
  Vec<D> impulse;
  float motor_impulse;
  float lower_impulse;
  float upper_impulse;
};

/// Applies +impulse to b at r_b and -impulse to a at r_a.
template <int D>
void apply_pair(const JointRow<D>& row, const Vec<D>& impulse, const Vec<D>& r_a, const Vec<D>& r_b,
                Motion<D>& a, Motion<D>& b) {
  a.velocity -= row.mass_a.inverse_mass * impulse;
  a.spin -= row.mass_a.inverse_inertia * moment(r_a, impulse);
  b.velocity += row.mass_b.inverse_mass * impulse;
  b.spin += row.mass_b.inverse_inertia * moment(r_b, impulse);
}

/// v_b + w_b x r_b - v_a - w_a x r_a.
template <int D>
Vec<D> anchor_velocity(const Motion<D>& a, const Vec<D>& r_a, const Motion<D>& b,
                       const Vec<D>& r_b) {
  return (b.velocity + spin_cross(b.spin, r_b)) - (a.velocity + spin_cross(a.spin, r_a));
}

/// Anchor b from anchor a now, m.
template <int D>
Vec<D> anchor_offset(const JointRow<D>& row, const Motion<D>& a, const Vec<D>& r_a,
                     const Motion<D>& b, const Vec<D>& r_b) {
  return (b.delta_position - a.delta_position) + row.centre_offset + (r_b - r_a);
}

/// A body without mass is read by joints of the same colour at the same time, so it is not written.
template <int D>
void write_back(const JointRow<D>& row, const Motion<D>& a, const Motion<D>& b,
                std::span<Motion<D>> motions) {
  if (row.mass_a.inverse_mass > 0.0f) motions[row.body_a] = a;
  if (row.mass_b.inverse_mass > 0.0f) motions[row.body_b] = b;
}

}  // namespace cycloid::solver
