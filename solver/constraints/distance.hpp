#pragma once

#include "solver/constraints/joint_row.hpp"

namespace cycloid::solver {

/// Distance joint, rigid or a spring. With d = anchor_b - anchor_a and u = d / |d|:
///   C = |d| - length [m],  Cdot = u . (v_b + w_b x r_b - v_a - w_a x r_a),
///   J = (-u, -r_a x u, u, r_b x u),  K = J M^-1 J^T.  Impulse along u, N s, unbounded.
/// Rigid: biased sweeps use the world's joint softness. Spring: every sweep uses its own.
/// Source: Catto, "Modeling and Solving Constraints" (GDC 2009) and "Soft Constraints" (2011).
template <int D>
struct DistanceConstraint {
  static constexpr int kRows = 1;

  static void warm_start(const JointRow<D>& row, Motion<D>& a, Motion<D>& b) {
    const Vec<D> r_a = rotate(a.delta_rotation, row.r_a);
    const Vec<D> r_b = rotate(b.delta_rotation, row.r_b);
    apply_pair(row, row.impulse[0] * axis(anchor_offset(row, a, r_a, b, r_b)), r_a, r_b, a, b);
  }

  static void solve(const StepContext<D>& context, Sweep sweep, JointRow<D>& row, Motion<D>& a,
                    Motion<D>& b) {
    const Vec<D> r_a = rotate(a.delta_rotation, row.r_a);
    const Vec<D> r_b = rotate(b.delta_rotation, row.r_b);
    const Vec<D> offset = anchor_offset(row, a, r_a, b, r_b);
    const Vec<D> u = axis(offset);
    const Softness softness = row.is_spring             ? row.spring
                              : sweep == Sweep::kBiased ? context.joint
                                                        : kRigid;
    const float error = length(offset) - row.length;
    const float speed = dot(u, anchor_velocity(a, r_a, b, r_b));
    const float change = -softness.mass_scale * (speed + softness.bias_rate * error) /
                             inverse_effective_mass(row, u, r_a, r_b) -
                         softness.impulse_scale * row.impulse[0];
    row.impulse[0] += change;
    apply_pair(row, change * u, r_a, r_b, a, b);
  }

 private:
  /// The anchors of a joint that has collapsed to a point part along the first axis.
  static Vec<D> axis(const Vec<D>& offset) {
    Vec<D> fallback = Vec<D>::zero();
    fallback[0] = 1.0f;
    return normalized_or(offset, fallback);
  }
  static float inverse_effective_mass(const JointRow<D>& row, const Vec<D>& u, const Vec<D>& r_a,
                                      const Vec<D>& r_b) {
    const Spin<D> turn_a = moment(r_a, u);
    const Spin<D> turn_b = moment(r_b, u);
    return row.mass_a.inverse_mass + row.mass_b.inverse_mass +
           dot(turn_a, row.mass_a.inverse_inertia * turn_a) +
           dot(turn_b, row.mass_b.inverse_inertia * turn_b);
  }
};

}  // namespace cycloid::solver
