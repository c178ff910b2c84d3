#include "solver/constraints/joint_row.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// No bound on an impulse: more than any bounded world can ask for, and its square is finite.
static constexpr float kUnbounded = 1.0e18f;

/// Which blocks of equalities are springs, and how much each may push.
template <int D>
static void set_blocks(const StepContext<D>& context, const Joint<D>& joint, JointRow<D>& row) {
  const bool yields = joint.kind == JointKind::kMotor || joint.kind == JointKind::kTarget;
  const Springs are_springs = springs_of(joint);
  row.is_spring[0] = are_springs.first;
  row.is_spring[1] = are_springs.second;
  const bool springs = joint.kind == JointKind::kConeTwist && joint.angular_hertz > 0.0f;
  const bool rubs = joint.kind == JointKind::kConeTwist && !springs && joint.torque_max > 0.0f;
  // Friction has no frequency, and so needs no mass of its own.
  row.has_held_spring = are_springs.first != are_springs.second && !rubs;
  row.spring_of[0] = joint.hertz > 0.0f
                         ? spring_softness(joint.hertz, joint.damping_ratio, context.h)
                         : context.motor;
  row.spring_of[1] =
      joint.angular_hertz > 0.0f
          ? spring_softness(joint.angular_hertz, joint.angular_damping_ratio, context.h)
      : rubs ? kRigid
             : context.motor;
  row.impulse_max[0] = yields ? context.h * joint.force_max : kUnbounded;
  const bool bounded =
      joint.kind == JointKind::kMotor || rubs || (springs && joint.torque_max > 0.0f);
  row.impulse_max[1] = bounded ? context.h * joint.torque_max : kUnbounded;
}

/// What acts along the coordinate.
template <int D>
static void set_axis(const StepContext<D>& context, const Joint<D>& joint, JointRow<D>& row) {
  const bool of_position = joint.kind == JointKind::kWeld || joint.kind == JointKind::kMotor ||
                           joint.kind == JointKind::kTarget || joint.kind == JointKind::kConeTwist;
  row.motor_holds_position = joint.motor == MotorKind::kPosition;
  row.motor_enabled = joint.motor != MotorKind::kOff;
  row.spring_enabled = joint.hertz > 0.0f && !of_position && !row.motor_holds_position;
  row.limit_enabled = joint.limit_enabled != 0;
  row.spring = joint.hertz > 0.0f ? spring_softness(joint.hertz, joint.damping_ratio, context.h)
                                  : context.motor;
  const bool springs_to_length = joint.kind == JointKind::kDistance && !row.motor_holds_position;
  row.spring_rest = springs_to_length ? joint.length : joint.target;
  row.target_rate = 0.0f;
  row.lower = joint.lower;
  row.upper = joint.upper;
  row.limit_reach_s = kLimitReach_substeps * context.h;
  row.motor_speed = joint.motor_speed;
  row.motor_impulse_max = context.h * joint.motor_max;
}

/// Impulses of what is switched off are forgotten, or they would come back as a kick; those of
/// equalities once it is known how many there are (evaluate_rows).
template <int D>
static void take_impulses(float share, const Joint<D>& joint, JointRow<D>& row) {
  for (int i = 0; i < JointRow<D>::kRows; ++i)
    row.impulse[i] = share * joint.impulse[static_cast<std::size_t>(i)];
  row.spring_impulse = row.spring_enabled ? share * joint.spring_impulse : 0.0f;
  row.motor_impulse = row.motor_enabled ? share * joint.motor_impulse : 0.0f;
  row.lower_impulse = row.limit_enabled ? share * joint.lower_impulse : 0.0f;
  row.upper_impulse = row.limit_enabled ? share * joint.upper_impulse : 0.0f;
}

static void set_cone(float, const Joint<2>&, JointRow<2>&) {}
static void set_cone(float share, const Joint<3>& joint, JointRow<3>& row) {
  row.cone = joint.cone;
  row.cone_impulse = row.limit_enabled ? share * joint.cone_impulse : 0.0f;
}

/// How far apart the points of a joint may be when a tick begins for it to be left to sweeps, or to
/// fewer substeps, m. Both close it late, when the next blow has come: a chain that begins at twice
/// its length then never quite comes together. From 0.02 to 0.1 is all the same.
static constexpr float kParted = 0.08f;

/// The same for it to be left to fewer substeps while something flies that may come down on it, m:
/// a taut bridge that is still closing when its load comes sags by 13 mm instead of 1.
static constexpr float kOpen = 0.0005f;

/// How far apart the points are that a user's joint holds together, by its first rows, m; 0 where
/// those are fewer than a point has. @pre its function is registered.
template <int D>
static float apart_by_rows(const StepContext<D>& context, const WorldState<D>& state,
                           const JointRow<D>& row) {
  const auto tick = static_cast<std::int64_t>(state.header.tick);
  const JointRows<D> rows = rows_between_ticks(state, state.joints[row.joint], row.rows_function,
                                               static_cast<float>(tick) * context.tick_s);
  Vec<D> apart = Vec<D>::zero();
  for (int i = 0; i < D && rows.split >= D; ++i)
    apart[i] = rows.rows[static_cast<std::size_t>(i)].error;
  return length(apart);
}

/// Whether joints of this kind hold the anchor on one body at that on the other.
static bool holds_anchors(JointKind kind) {
  return kind == JointKind::kRevolute || kind == JointKind::kWeld || kind == JointKind::kHinge ||
         kind == JointKind::kConeTwist;
}

/// Whether a joint holds its anchors together, and whether they are far apart. That of a user does
/// where its rows are as far from where they belong as its anchors are.
template <int D>
static void look_at_anchors(const StepContext<D>& context, const WorldState<D>& state,
                            JointRow<D>& row) {
  constexpr float kSame = 1.0e-4f;  // m
  const Joint<D>& joint = state.joints[row.joint];
  row.holds_point = holds_anchors(joint.kind);
  row.parted = row.open = false;
  const bool is_users = joint.kind == JointKind::kUser && row.rows_function != nullptr;
  if (!row.holds_point && !is_users) return;
  float apart =
      length(row.centre_offset + (rotate(state.bodies[row.body_b].rotation, joint.anchor_b) -
                                  rotate(state.bodies[row.body_a].rotation, joint.anchor_a)));
  if (is_users) {
    const float by_rows = apart_by_rows(context, state, row);
    row.holds_point = abs(by_rows - apart) < kSame;
    apart = by_rows;
  }
  row.parted = apart > kParted;
  row.open = apart > kOpen;
}

/// @param row  May be of another joint and tick: everything is written but what evaluate_rows
/// writes, which is a good part of it.
template <int D>
static void set_row(const StepContext<D>& context, const WorldState<D>& state,
                    const StepScratch<D>& scratch, std::uint32_t slot, JointRow<D>& row) {
  const Joint<D>& joint = state.joints[slot];
  row.joint = slot;
  row.body_a = joint.body_a;
  row.body_b = joint.body_b;
  row.rows_function = joint.kind == JointKind::kUser
                          ? find_rows_function<D>(scratch.kept->user_rows, joint.user_kind)
                          : &rows_of<D>;
  row.mass_a = scratch.masses[joint.body_a];
  row.mass_b = scratch.masses[joint.body_b];
  row.centre_offset = state.bodies[joint.body_b].position - state.bodies[joint.body_a].position;
  set_blocks(context, joint, row);
  set_axis(context, joint, row);
  take_impulses(context.tuning.warm_starting, joint, row);
  set_cone(context.tuning.warm_starting, joint, row);
  look_at_anchors(context, state, row);
  row.in_island = row.solved_directly = row.relaxes = row.limit_near = false;
  row.rows.drop();
}

/// One row per live joint, in the order of the colouring.
///
/// Reads joints, poses and masses; writes joint_rows, each from its own joint.
template <int D>
void prepare_joints(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                    StepScratch<D>& scratch) {
  const std::vector<int>& order = scratch.joint_coloring.order;
  scratch.joint_rows.resize(order.size());
  workers.parallel_for(static_cast<int>(order.size()), kJointGrain, [&](Range range) {
    for (int i = range.begin; i < range.end; ++i) {
      const auto place = static_cast<std::size_t>(i);
      set_row(context, state, scratch, static_cast<std::uint32_t>(order[place]),
              scratch.joint_rows[place]);
    }
  });
}

template void prepare_joints(const StepContext<2>&, const WorldState<2>&, Workers&,
                             StepScratch<2>&);
template void prepare_joints(const StepContext<3>&, const WorldState<3>&, Workers&,
                             StepScratch<3>&);

}  // namespace cycloid::solver
