#pragma once

#include <Eigen/LU>

#include "solver/constraints/joint_row.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

/// Two anchors at one point: a pin in the plane, a ball joint in space.
///   C = anchor_b - anchor_a [m],  Cdot = v_b + w_b x r_b - v_a - w_a x r_a,
///   J = (-1, [r_a]x, 1, -[r_b]x),  K = (m_a^-1 + m_b^-1) 1 - [r_a]x I_a^-1 [r_a]x - [r_b]x ...
/// solved as one D x D block. In the plane also, before it, a motor (w_b - w_a = speed, |impulse|
/// <= h torque_max) and two limits (angle - lower >= 0 and upper - angle >= 0, impulse >= 0), each
/// with effective mass 1 / (I_a^-1 + I_b^-1). Impulses in N s and N m s.
/// Source: Catto, "Modeling and Solving Constraints" (GDC 2009) and "Solver2D" (2024).
template <int D>
struct RevoluteConstraint {
  static void warm_start(const JointRow<D>& row, Motion<D>& a, Motion<D>& b) {
    const Vec<D> r_a = rotate(a.delta_rotation, row.r_a);
    const Vec<D> r_b = rotate(b.delta_rotation, row.r_b);
    apply_pair(row, row.impulse, r_a, r_b, a, b);
    if constexpr (Dim<D>::kSpin == 1)
      turn(row, row.motor_impulse + row.lower_impulse - row.upper_impulse, a, b);
  }

  static void solve(const StepContext<D>& context, Sweep sweep, JointRow<D>& row, Motion<D>& a,
                    Motion<D>& b) {
    if constexpr (Dim<D>::kSpin == 1) {
      if (row.motor_enabled) solve_motor(context, row, a, b);
      if (row.limit_enabled) solve_limits(context, sweep, row, a, b);
    }
    solve_point(context, sweep, row, a, b);
  }

 private:
  static void solve_point(const StepContext<D>& context, Sweep sweep, JointRow<D>& row,
                          Motion<D>& a, Motion<D>& b) {
    const Vec<D> r_a = rotate(a.delta_rotation, row.r_a);
    const Vec<D> r_b = rotate(b.delta_rotation, row.r_b);
    const Softness softness = sweep == Sweep::kBiased ? context.joint : kRigid;
    const Vec<D> error = anchor_offset(row, a, r_a, b, r_b);
    const Vec<D> wanted = anchor_velocity(a, r_a, b, r_b) + softness.bias_rate * error;
    const Vec<D> change = -(softness.mass_scale * over_effective_mass(row, r_a, r_b, wanted)) -
                          softness.impulse_scale * row.impulse;
    row.impulse += change;
    apply_pair(row, change, r_a, r_b, a, b);
  }

  /// K^-1 v, with K built column by column: K e = (what a unit impulse along e does to Cdot).
  static Vec<D> over_effective_mass(const JointRow<D>& row, const Vec<D>& r_a, const Vec<D>& r_b,
                                    const Vec<D>& v) {
    Eigen::Matrix<float, D, D> k;
    for (int column = 0; column < D; ++column) {
      Vec<D> e = Vec<D>::zero();
      e[column] = 1.0f;
      const Vec<D> response = (row.mass_a.inverse_mass + row.mass_b.inverse_mass) * e +
                              spin_cross(row.mass_a.inverse_inertia * moment(r_a, e), r_a) +
                              spin_cross(row.mass_b.inverse_inertia * moment(r_b, e), r_b);
      for (int i = 0; i < D; ++i) k(i, column) = response[i];
    }
    const Eigen::Matrix<float, D, D> inverse = k.inverse();
    Vec<D> result = Vec<D>::zero();
    for (int i = 0; i < D; ++i)
      for (int j = 0; j < D; ++j) result[i] += inverse(i, j) * v[j];
    return result;
  }

  static float axial_mass(const JointRow<D>& row) {
    const float sum = row.mass_a.inverse_inertia.m[0] + row.mass_b.inverse_inertia.m[0];
    return sum > 0.0f ? 1.0f / sum : 0.0f;
  }
  static void turn(const JointRow<D>& row, float impulse, Motion<D>& a, Motion<D>& b) {
    a.spin[0] -= row.mass_a.inverse_inertia.m[0] * impulse;
    b.spin[0] += row.mass_b.inverse_inertia.m[0] * impulse;
  }

  static void solve_motor(const StepContext<D>& context, JointRow<D>& row, Motion<D>& a,
                          Motion<D>& b) {
    const float speed = b.spin[0] - a.spin[0] - row.motor_speed;
    const float bound = context.h * row.motor_torque_max;
    const float accumulated = clamp(row.motor_impulse - axial_mass(row) * speed, -bound, bound);
    turn(row, accumulated - row.motor_impulse, a, b);
    row.motor_impulse = accumulated;
  }

  static float angle_now(const JointRow<D>& row, const Motion<D>& a, const Motion<D>& b) {
    const Rotation<D> back = {{a.delta_rotation[0], -a.delta_rotation[1]}};
    const Rotation<D> now = compose(compose(back, b.delta_rotation), row.angle);
    return atan2(now[1], now[0]);
  }

  static void solve_limits(const StepContext<D>& context, Sweep sweep, JointRow<D>& row,
                           Motion<D>& a, Motion<D>& b) {
    const float angle = angle_now(row, a, b);
    // The lower limit pushes the angle up, the upper one down: the same row in a mirror.
    solve_limit(context, sweep, row, angle - row.lower_angle, 1.0f, row.lower_impulse, a, b);
    solve_limit(context, sweep, row, row.upper_angle - angle, -1.0f, row.upper_impulse, a, b);
  }

  static void solve_limit(const StepContext<D>& context, Sweep sweep, const JointRow<D>& row,
                          float room, float sign, float& impulse, Motion<D>& a, Motion<D>& b) {
    Softness softness = kRigid;
    float bias = 0.0f;
    if (room > 0.0f) {
      bias = room * context.inverse_h;
    } else if (sweep == Sweep::kBiased) {
      softness = context.joint;
      bias = softness.bias_rate * room;
    }
    const float speed = sign * (b.spin[0] - a.spin[0]);
    const float change =
        -axial_mass(row) * softness.mass_scale * (speed + bias) - softness.impulse_scale * impulse;
    const float accumulated = max(impulse + change, 0.0f);
    turn(row, sign * (accumulated - impulse), a, b);
    impulse = accumulated;
  }
};

}  // namespace cycloid::solver
