#pragma once

#include <span>

#include "solver/constraints/block.hpp"
#include "solver/constraints/joint_bounds.hpp"
#include "solver/constraints/rows.hpp"
#include "solver/direct/wide.hpp"
#include "solver/motion.hpp"
#include "solver/step_context.hpp"

namespace cycloid::solver {

/// What an impulse along one row does with the first block of equalities held: what it asks of them
/// goes with it, so that a limit at the end of a long arm is met at once.
template <int D>
struct HeldRow {
  float mass;
  float reaction[Dim<D>::kFreedoms];
};

/// The part of a joint's row that only space has.
template <int D>
struct ConeLimit {};
template <>
struct ConeLimit<3> {
  HeldRow<3> held_cone;
  float cone;  ///< rad.
  float cone_impulse;
};

/// One joint during a tick: its rows at the present poses and the impulses they accumulate.
template <int D>
struct JointRow : ConeLimit<D> {
  static constexpr int kRows = Dim<D>::kFreedoms;

  std::uint32_t joint;  ///< Slot.
  std::uint32_t body_a;
  std::uint32_t body_b;
  RowsFunction<D> rows_function;
  BodyMass<D> mass_a;
  BodyMass<D> mass_b;
  Vec<D> centre_offset;  ///< Centre of b from centre of a, at the start of the tick, m.

  Softness spring_of[2];  ///< Of the blocks; meant where is_spring.
  bool is_spring[2];
  bool has_held_spring;  ///< One block is a spring on the mass that it has with the other held.
  float impulse_max[2];  ///< N s and N m s; length of a block's impulse.
  bool holds_point;      ///< Of both bodies, its anchors, at one place (prepare_joints).
  bool parted;           ///< Its points were far apart when the tick began (prepare_joints).
  bool open;             ///< They were apart by more than a blow may open on (prepare_joints).
  bool in_island;        ///< The equalities belong to the island solver.
  bool solved_directly;  ///< They belong to it or to the tree solver.
  bool relaxes;          ///< All the same relax sweeps act on it.

  bool spring_enabled;
  bool limit_enabled;
  bool limit_near;  ///< It pushes, or may within the next substeps: only then it is solved.
  bool motor_enabled;
  Softness spring;  ///< Of the coordinate, or of a position motor.
  float spring_rest;
  float lower;
  float upper;
  float limit_reach_s;  ///< How far ahead in time a limit is near.
  float motor_speed;
  float motor_impulse_max;
  bool motor_holds_position;
  float target_rate;  ///< Of a driven target, per s.

  float impulse[kRows];
  float spring_impulse;
  float motor_impulse;
  float lower_impulse;
  float upper_impulse;

  // What evaluate_rows writes, far from what every stage asks; before that it is of another tick.
  JointRows<D> rows;
  BlockFactor<kRows> blocks[2];  ///< Of the equalities before `rows.split`, and from it on.
  HeldRow<D> axis;               ///< Of the coordinate.
  HeldRow<D> motor;
};

/// Which blocks of a joint's equalities are springs.
struct Springs {
  bool first = false;
  bool second = false;

  bool operator==(const Springs&) const = default;
};
template <int D>
Springs springs_of(const Joint<D>& joint) {
  switch (joint.kind) {
    case JointKind::kMotor:
    case JointKind::kTarget:
      return {true, true};
    case JointKind::kWeld:
      return {joint.hertz > 0.0f, joint.angular_hertz > 0.0f};
    case JointKind::kConeTwist:
      // Friction in a ball joint is a spring without stiffness: it damps all that it may.
      return {false, joint.angular_hertz > 0.0f || joint.torque_max > 0.0f};
    default:
      return {};
  }
}

/// Whether its equalities do not yield, so that an island can hold them.
template <int D>
bool is_held(const JointRow<D>& row) {
  return row.rows_function != nullptr && !row.is_spring[0] && !row.is_spring[1];
}

/// J v: how fast an error changes by what the bodies do.
template <int D>
[[gnu::always_inline]] inline float speed_of_bodies(const Row<D>& row, const Motion<D>& a,
                                                    const Motion<D>& b) {
  return (dot(row.linear_a, a.velocity) + dot(row.angular_a, a.spin)) +
         (dot(row.linear_b, b.velocity) + dot(row.angular_b, b.spin));
}

/// The same with what time does.
template <int D>
[[gnu::always_inline]] inline float row_speed(const Row<D>& row, const Motion<D>& a,
                                              const Motion<D>& b) {
  return speed_of_bodies(row, a, b) + row.rate;
}

/// The same in a sweep. What time does is for velocities: pseudo-velocities would do it again.
template <int D>
[[gnu::always_inline]] inline float row_speed_in(Sweep sweep, const Row<D>& row, const Motion<D>& a,
                                                 const Motion<D>& b) {
  return speed_of_bodies(row, a, b) + (sweep == Sweep::kPseudo ? 0.0f : row.rate);
}

/// J^T lambda of several rows: what they push both bodies with, N s and N m s.
template <int D>
struct PairImpulse {
  Vec<D> linear_a = Vec<D>::zero();
  Spin<D> angular_a = Spin<D>::zero();
  Vec<D> linear_b = Vec<D>::zero();
  Spin<D> angular_b = Spin<D>::zero();

  [[gnu::always_inline]] void add(const Row<D>& row, float impulse) {
    linear_a += impulse * row.linear_a;
    angular_a += impulse * row.angular_a;
    linear_b += impulse * row.linear_b;
    angular_b += impulse * row.angular_b;
  }
};

/// v += M^-1 J^T lambda: the inertia is met once, however many rows push.
template <int D>
[[gnu::always_inline]] inline void apply(const JointRow<D>& joint, const PairImpulse<D>& impulse,
                                         Motion<D>& a, Motion<D>& b) {
  a.velocity += joint.mass_a.inverse_mass * impulse.linear_a;
  a.spin += joint.mass_a.inverse_inertia * impulse.angular_a;
  b.velocity += joint.mass_b.inverse_mass * impulse.linear_b;
  b.spin += joint.mass_b.inverse_inertia * impulse.angular_b;
}

/// The equalities of one block.
struct BlockRows {
  int begin;
  int count;
};
template <int D>
BlockRows rows_of_block(const JointRows<D>& rows, int index) {
  if (index == 0) return {0, rows.split};
  return {rows.split, rows.count - rows.split};
}

/// The same of one row.
template <int D>
[[gnu::always_inline]] inline void apply_row(const JointRow<D>& joint, const Row<D>& row,
                                             float impulse, Motion<D>& a, Motion<D>& b) {
  a.velocity += (joint.mass_a.inverse_mass * impulse) * row.linear_a;
  a.spin += joint.mass_a.inverse_inertia * (impulse * row.angular_a);
  b.velocity += (joint.mass_b.inverse_mass * impulse) * row.linear_b;
  b.spin += joint.mass_b.inverse_inertia * (impulse * row.angular_b);
}

/// An impulse along a row that leaves the first block of equalities as satisfied as it was.
template <int D>
void apply_held(JointRow<D>& joint, const Row<D>& row, const HeldRow<D>& held, float impulse,
                Motion<D>& a, Motion<D>& b) {
  PairImpulse<D> sum;
  sum.add(row, impulse);
  for (int i = 0; i < joint.rows.split; ++i) {
    const float change = -held.reaction[i] * impulse;
    sum.add(joint.rows.rows[static_cast<std::size_t>(i)], change);
    joint.impulse[i] += change;
  }
  apply(joint, sum, a, b);
}

/// M^-1 J^T of one row, or of the impulse of several: how both bodies answer to it.
template <int D>
struct RowResponse {
  Vec<D> linear_a;
  Spin<D> angular_a;
  Vec<D> linear_b;
  Spin<D> angular_b;
};

template <int D, class Push>
[[gnu::always_inline]] inline RowResponse<D> response_to(const JointRow<D>& joint,
                                                         const Push& row) {
  return {joint.mass_a.inverse_mass * row.linear_a, joint.mass_a.inverse_inertia * row.angular_a,
          joint.mass_b.inverse_mass * row.linear_b, joint.mass_b.inverse_inertia * row.angular_b};
}

/// J_i M^-1 J_j^T.
template <int D>
[[gnu::always_inline]] inline float row_coupling(const Row<D>& i, const RowResponse<D>& j) {
  return (dot(i.linear_a, j.linear_a) + dot(i.angular_a, j.angular_a)) +
         (dot(i.linear_b, j.linear_b) + dot(i.angular_b, j.angular_b));
}

/// What a block of equalities has to push, that an impulse leaves it as satisfied as it was: to be
/// added to the block's own, N s and N m s; and adds it to that impulse.
template <int D>
void add_reaction(const JointRow<D>& joint, int index, PairImpulse<D>& impulse,
                  float (&reaction)[JointRow<D>::kRows]) {
  const RowResponse<D> response = response_to(joint, impulse);
  const BlockRows block = rows_of_block(joint.rows, index);
  const Row<D>* rows = joint.rows.rows.data() + block.begin;
  for (int i = 0; i < block.count; ++i) reaction[i] = -row_coupling(rows[i], response);
  joint.blocks[index].solve(reaction, block.count);
  for (int i = 0; i < block.count; ++i) impulse.add(rows[i], reaction[i]);
}

/// Whether spring, motor or limits do anything now. @pre evaluate_rows.
template <int D>
bool drives_act(const JointRow<D>& row) {
  return row.rows.has_axis && (row.spring_enabled || row.limit_near || row.motor_enabled);
}

/// Joints of the plane have no cone; these let the kernel say so at no cost.
inline bool has_cone(const JointRow<2>&) {
  return false;
}
inline bool has_cone(const JointRow<3>& row) {
  return row.rows.has_cone_axis;
}
inline void store_cone_impulse(const JointRow<2>&, JointImpulses<2>&) {}
inline void store_cone_impulse(const JointRow<3>& row, JointImpulses<3>& joint) {
  joint.cone_impulse = row.cone_impulse;
}
inline void forget_cone_impulse(JointRow<2>&) {}
inline void forget_cone_impulse(JointRow<3>& row) {
  row.cone_impulse = 0.0f;
}

/// A body without mass is read by joints of the same colour at the same time, so it is not written.
template <int D>
void write_back(const JointRow<D>& row, const Motion<D>& a, const Motion<D>& b,
                std::span<Motion<D>> motions) {
  if (row.mass_a.inverse_mass > 0.0f) motions[row.body_a] = a;
  if (row.mass_b.inverse_mass > 0.0f) motions[row.body_b] = b;
}

/// Rows and effective masses at the poses of `a` and `b`: once wherever positions have moved.
template <int D>
void evaluate_rows(const WorldState<D>& state, Wide time_s, const Motion<D>& a, const Motion<D>& b,
                   JointRow<D>& row);

}  // namespace cycloid::solver
