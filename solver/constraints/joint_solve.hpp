#pragma once

#include "solver/constraints/joint_row.hpp"

namespace cycloid::solver {

/// The one kernel of all joints: whatever the kind, its rows are solved as written here.

inline void add_cone_impulse(const JointRow<2>&, PairImpulse<2>&) {}
inline void add_cone_impulse(const JointRow<3>& row, PairImpulse<3>& sum) {
  if (has_cone(row)) sum.add(row.rows.cone_axis, -row.cone_impulse);
}

/// J^T lambda of a joint's equalities.
template <int D>
PairImpulse<D> impulse_of_equalities(const JointRow<D>& row) {
  PairImpulse<D> sum;
  for (int i = 0; i < row.rows.count; ++i)
    sum.add(row.rows.rows[static_cast<std::size_t>(i)], row.impulse[i]);
  return sum;
}

/// J^T lambda of all its rows.
template <int D>
PairImpulse<D> impulse_of_all(const JointRow<D>& row) {
  PairImpulse<D> sum = impulse_of_equalities(row);
  if (!row.rows.has_axis) return sum;
  sum.add(row.rows.axis, row.spring_impulse + row.lower_impulse - row.upper_impulse);
  sum.add(row.rows.has_motor_axis ? row.rows.motor_axis : row.rows.axis, row.motor_impulse);
  add_cone_impulse(row, sum);
  return sum;
}

/// The square of how fast a guess may turn a body, rad/s: by its torque, and by its force about the
/// arm, however the two stand to one another. Over the rows of a point the sum of J_w I^-1 J_w^T is
/// (D - 1) r^2 / I, and that of J_w J_w^T is (D - 1) r^2.
/// @param angular_of  J_w of the first rows, as many as a point has.
template <int D, class AngularOf>
float turn_square_of_guess(const Inertia<D>& inverse_inertia, int count, AngularOf&& angular_of,
                           float force_square, const Spin<D>& torque) {
  float answers = 0.0f;
  float arms = 1.0e-12f;
  for (int i = 0; i < count; ++i) {
    const Spin<D> angular = angular_of(i);
    answers += dot(angular, inverse_inertia * angular);
    arms += dot(angular, angular);
  }
  const Spin<D> turn = inverse_inertia * torque;
  const float by_force = force_square * answers * answers / (static_cast<float>(D - 1) * arms);
  return max(by_force, dot(turn, turn));
}

/// How much of a joint's guess is stable, from 0 to 1: it turns no body faster than `spin_max`.
template <int D>
float stable_share(float spin_max, const JointRow<D>& row, const PairImpulse<D>& guess) {
  const int count = row.rows.split < D ? row.rows.split : D;
  const auto equality = [&](int i) -> const Row<D>& {
    return row.rows.rows[static_cast<std::size_t>(i)];
  };
  float square = 0.0f;
  for (int i = 0; i < count; ++i) square += row.impulse[i] * row.impulse[i];
  const float turn_a = turn_square_of_guess<D>(
      row.mass_a.inverse_inertia, count, [&](int i) { return equality(i).angular_a; }, square,
      guess.angular_a);
  const float turn_b = turn_square_of_guess<D>(
      row.mass_b.inverse_inertia, count, [&](int i) { return equality(i).angular_b; }, square,
      guess.angular_b);
  const float turn = max(turn_a, turn_b);
  return turn > spin_max * spin_max ? spin_max / sqrt(turn) : 1.0f;
}

inline void scale_cone_impulse(float, JointRow<2>&) {}
inline void scale_cone_impulse(float share, JointRow<3>& row) {
  row.cone_impulse *= share;
}

template <int D>
void scale_impulses(float share, JointRow<D>& row) {
  for (float& impulse : row.impulse) impulse *= share;
  for (float* impulse :
       {&row.spring_impulse, &row.motor_impulse, &row.lower_impulse, &row.upper_impulse})
    *impulse *= share;
  scale_cone_impulse(share, row);
}

/// v += M^-1 J^T lambda, of as much of lambda as is stable; of what is solved at once that is all,
/// for it takes such forces implicitly (IslandTension).
template <int D>
void warm_start(float spin_max, JointRow<D>& row, Motion<D>& a, Motion<D>& b) {
  PairImpulse<D> sum = impulse_of_all(row);
  const float share = row.solved_directly ? 1.0f : stable_share(spin_max, row, sum);
  if (share < 1.0f) {
    scale_impulses(share, row);
    sum = impulse_of_all(row);
  }
  apply(row, sum, a, b);
}

/// What a joint's spring has asked of its rigid block, which is no load that this gives way to;
/// zeros where there is none. @param asked  N s or N m s, by equality of the block.
template <int D>
void asked_by_spring(const JointRow<D>& row, int index, float (&asked)[JointRow<D>::kRows]) {
  for (float& impulse : asked) impulse = 0.0f;
  if (!row.has_held_spring || row.is_spring[index]) return;
  const BlockRows spring = rows_of_block(row.rows, 1 - index);
  PairImpulse<D> sum;
  for (int i = spring.begin; i < spring.begin + spring.count; ++i)
    sum.add(row.rows.rows[static_cast<std::size_t>(i)], row.impulse[i]);
  add_reaction(row, index, sum, asked);
}

/// Has the rigid block of a joint answer to what its spring is about to push.
template <int D>
void answer_spring(JointRow<D>& row, int index, PairImpulse<D>& sum) {
  float reaction[JointRow<D>::kRows];
  add_reaction(row, 1 - index, sum, reaction);
  const BlockRows rigid = rows_of_block(row.rows, 1 - index);
  for (int i = 0; i < rigid.count; ++i) row.impulse[rigid.begin + i] += reaction[i];
}

inline float less_asked_by_cone(const JointRow<2>&, int, float load) {
  return load;
}
inline float less_asked_by_cone(const JointRow<3>& row, int i, float load) {
  const bool acts = has_cone(row) && row.limit_near;
  return acts ? load - row.held_cone.reaction[i] * row.cone_impulse : load;
}

/// The impulse of equality i of the first block without what spring, motor and limits have asked of
/// it (apply_held), N s or N m s. @pre drives_act.
template <int D>
float load_of_equality(const JointRow<D>& row, int i) {
  const float along = row.spring_impulse + (row.lower_impulse - row.upper_impulse);
  const float asked = row.axis.reaction[i] * along + row.motor.reaction[i] * row.motor_impulse;
  return less_asked_by_cone(row, i, row.impulse[i] + asked);
}

/// lambda' = lambda - mass_scale K^-1 (Jv + bias_rate C) - impulse_scale load over the equalities
/// [begin, end), held to the block's bound.
///
/// A soft constraint gives way to its load. What a joint's own drives and spring ask of its
/// equalities is none: to give way to that would turn the body by what it gives, against the drive,
/// and where a long arm makes the reaction large, further than the drive turns it (`LongArms.*`).
template <int D>
void solve_block(const StepContext<D>& context, Sweep sweep, int index, JointRow<D>& row,
                 Motion<D>& a, Motion<D>& b) {
  const auto [begin, count] = rows_of_block(row.rows, index);
  if (count == 0) return;
  // A spring acts in every sweep, a correction in the biased ones; pseudo-velocities know no
  // spring.
  if (sweep == Sweep::kPseudo && row.is_spring[index]) return;
  const Softness softness = row.is_spring[index]      ? row.spring_of[index]
                            : sweep == Sweep::kRelax  ? kRigid
                            : sweep == Sweep::kPseudo ? context.pseudo
                                                      : context.joint;
  float change[JointRow<D>::kRows];
  for (int i = 0; i < count; ++i) {
    const Row<D>& equality = row.rows.rows[static_cast<std::size_t>(begin + i)];
    change[i] = row_speed_in(sweep, equality, a, b) + softness.bias_rate * equality.error;
  }
  row.blocks[index].solve(change, count);
  float asked[JointRow<D>::kRows];
  asked_by_spring(row, index, asked);
  const bool is_driven =
      index == 0 && sweep == Sweep::kBiased && !row.is_spring[0] && drives_act(row);
  float size = 0.0f;
  for (int i = 0; i < count; ++i) {
    const float old = row.impulse[begin + i];
    const float load = (is_driven ? load_of_equality(row, i) : old) - asked[i];
    change[i] = old - context.tuning.over_relaxation *
                          (softness.mass_scale * change[i] + softness.impulse_scale * load);
    size += change[i] * change[i];
  }
  const float bound = row.impulse_max[index];
  const float scale = size > bound * bound ? bound / sqrt(size) : 1.0f;
  PairImpulse<D> sum;
  for (int i = 0; i < count; ++i) {
    const float accumulated = scale * change[i];
    sum.add(row.rows.rows[static_cast<std::size_t>(begin + i)],
            accumulated - row.impulse[begin + i]);
    row.impulse[begin + i] = accumulated;
  }
  if (row.has_held_spring && row.is_spring[index]) answer_spring(row, index, sum);
  apply(row, sum, a, b);
}

/// Spring, motor and position motor: |lambda| <= bound.
template <int D>
void solve_drives(JointRow<D>& row, Motion<D>& a, Motion<D>& b) {
  if (row.spring_enabled) {
    const float error = row.rows.axis.error - row.spring_rest;
    const float change = -row.axis.mass * row.spring.mass_scale *
                             (row_speed(row.rows.axis, a, b) + row.spring.bias_rate * error) -
                         row.spring.impulse_scale * row.spring_impulse;
    row.spring_impulse += change;
    apply_held(row, row.rows.axis, row.axis, change, a, b);
  }
  if (!row.motor_enabled) return;
  const Row<D>& axis = row.rows.has_motor_axis ? row.rows.motor_axis : row.rows.axis;
  const float bound = row.motor_impulse_max;
  const Softness softness = row.motor_holds_position ? row.spring : kRigid;
  const float bias = row.motor_holds_position
                         ? softness.bias_rate * (axis.error - row.spring_rest) - row.target_rate
                         : -row.motor_speed;
  const float wanted = row.motor_impulse -
                       row.motor.mass * softness.mass_scale * (row_speed(axis, a, b) + bias) -
                       softness.impulse_scale * row.motor_impulse;
  const float accumulated = clamp(wanted, -bound, bound);
  apply_held(row, axis, row.motor, accumulated - row.motor_impulse, a, b);
  row.motor_impulse = accumulated;
}

/// What the motor presses a limit with, N s or N m s: at most what the limit bears. The limit is
/// soft to all else and bears this rigidly, or a strong motor would push it in by its force over
/// frequency squared.
/// @param sign  As of solve_limit.
template <int D>
float pressed_by_motor(const JointRow<D>& row, float sign, float impulse) {
  if (row.rows.has_motor_axis) return 0.0f;
  return max(min(-sign * row.motor_impulse, impulse), 0.0f);
}

/// One limit along `axis`: `room` is what is left until it [m or rad], the impulse pushes away from
/// it.
/// @param pressed  Of the impulse, what the limit does not give way to (pressed_by_motor).
template <int D>
void solve_limit(const StepContext<D>& context, Sweep sweep, JointRow<D>& row, const Row<D>& axis,
                 const HeldRow<D>& held, float room, float sign, float pressed, float& impulse,
                 Motion<D>& a, Motion<D>& b) {
  Softness softness = kRigid;
  float bias = 0.0f;
  if (room > 0.0f) {
    bias = room * context.inverse_h;
  } else if (sweep != Sweep::kRelax) {
    softness = sweep == Sweep::kPseudo ? context.pseudo : context.joint;
    bias = softness.bias_rate * room;
  }
  const float speed = sign * row_speed_in(sweep, axis, a, b);
  const float change = -held.mass * softness.mass_scale * (speed + bias) -
                       softness.impulse_scale * (impulse - pressed);
  const float accumulated = max(impulse + change, 0.0f);
  apply_held(row, axis, held, sign * (accumulated - impulse), a, b);
  impulse = accumulated;
}

inline void solve_cone(const StepContext<2>&, Sweep, JointRow<2>&, Motion<2>&, Motion<2>&) {}
inline void solve_cone(const StepContext<3>& context, Sweep sweep, JointRow<3>& row, Motion<3>& a,
                       Motion<3>& b) {
  if (!has_cone(row)) return;
  solve_limit(context, sweep, row, row.rows.cone_axis, row.held_cone,
              row.cone - row.rows.cone_axis.error, -1.0f, 0.0f, row.cone_impulse, a, b);
}

/// One sweep over a joint. The limit comes after the motor, so it wins; the equalities come last,
/// so they are what is exact when the sweep ends. What rubs in a cone counts as a motor.
template <int D>
void solve(const StepContext<D>& context, Sweep sweep, JointRow<D>& row, Motion<D>& a,
           Motion<D>& b) {
  const bool rubs_first = has_cone(row);
  if (rubs_first) solve_block(context, sweep, 1, row, a, b);
  if (row.rows.has_axis) {
    if (sweep != Sweep::kPseudo) solve_drives(row, a, b);
    if (row.limit_near) {
      const float coordinate = row.rows.axis.error;
      solve_limit(context, sweep, row, row.rows.axis, row.axis, coordinate - row.lower, 1.0f,
                  pressed_by_motor(row, 1.0f, row.lower_impulse), row.lower_impulse, a, b);
      solve_limit(context, sweep, row, row.rows.axis, row.axis, row.upper - coordinate, -1.0f,
                  pressed_by_motor(row, -1.0f, row.upper_impulse), row.upper_impulse, a, b);
    }
    if (row.limit_near) solve_cone(context, sweep, row, a, b);
  }
  if (row.solved_directly && !(row.relaxes && sweep == Sweep::kRelax)) return;
  solve_block(context, sweep, 0, row, a, b);
  if (!rubs_first) solve_block(context, sweep, 1, row, a, b);
}

/// x += M^-1 J^T lambda on poses, rotations exactly.
template <int D>
void move_by_row(const JointRow<D>& joint, const Row<D>& row, float lambda, Motion<D>& a,
                 Motion<D>& b) {
  a.delta_position += (joint.mass_a.inverse_mass * lambda) * row.linear_a;
  b.delta_position += (joint.mass_b.inverse_mass * lambda) * row.linear_b;
  turn_by(joint.mass_a.inverse_inertia * (lambda * row.angular_a), a);
  turn_by(joint.mass_b.inverse_inertia * (lambda * row.angular_b), b);
}

/// Moves along a row and leaves the first block of equalities as satisfied as it was.
template <int D>
void move_held(JointRow<D>& row, const Row<D>& along, const HeldRow<D>& held, float lambda,
               Motion<D>& a, Motion<D>& b) {
  move_by_row(row, along, lambda, a, b);
  for (int i = 0; i < row.rows.split; ++i)
    move_by_row(row, row.rows.rows[static_cast<std::size_t>(i)], -held.reaction[i] * lambda, a, b);
}

inline void correct_cone(float, JointRow<2>&, Motion<2>&, Motion<2>&) {}
inline void correct_cone(float most, JointRow<3>& row, Motion<3>& a, Motion<3>& b) {
  if (!has_cone(row)) return;
  const float beyond = max(row.rows.cone_axis.error - row.cone, 0.0f);
  if (beyond == 0.0f) return;
  move_held(row, row.rows.cone_axis, row.held_cone, -row.held_cone.mass * min(beyond, most), a, b);
}

/// Non-linear Gauss-Seidel: lambda = -K^-1 C with C and J at the present poses, C held to the
/// largest correction; what is satisfied is not touched. @pre rows were evaluated at these poses.
/// Source: Catto, "Understanding Constraints" (GDC 2014).
template <int D>
void correct_joint(const StepContext<D>& context, JointRow<D>& row, Motion<D>& a, Motion<D>& b) {
  const float most = context.tuning.correction_max;
  if (row.rows.has_axis && row.limit_near) {
    const float coordinate = row.rows.axis.error;
    const float beyond = min(coordinate - row.lower, 0.0f) + max(coordinate - row.upper, 0.0f);
    const float lambda = -row.axis.mass * clamp(beyond, -most, most);
    if (beyond != 0.0f) move_held(row, row.rows.axis, row.axis, lambda, a, b);
    correct_cone(most, row, a, b);
  }
  for (int index = 0; index < 2; ++index) {
    const auto [begin, count] = rows_of_block(row.rows, index);
    if (row.is_spring[index]) continue;
    float change[JointRow<D>::kRows];
    for (int i = 0; i < count; ++i)
      change[i] = clamp(row.rows.rows[static_cast<std::size_t>(begin + i)].error, -most, most);
    row.blocks[index].solve(change, count);
    for (int i = 0; i < count; ++i)
      move_by_row(row, row.rows.rows[static_cast<std::size_t>(begin + i)], -change[i], a, b);
  }
}

}  // namespace cycloid::solver
