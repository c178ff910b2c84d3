#include "solver/constraints/single_lanes.hpp"
#include "solver/direct/island_parts.hpp"
#include "solver/stages/island_rows.hpp"
#include "solver/stages/pin_rows.hpp"

namespace cycloid::solver {

/// Tension over inertia, in one substep, that the explicit step is left: so what spins slower than
/// a third of a radian per substep keeps its angular momentum.
static constexpr float kExplicit = 0.1f;

/// r x (u x ...): a vector along which the moment of another is known.
static Vec<2> cross_moment(const Vec<2>& u, const Vec<1>& m) {
  return {{u[1] * m[0], -u[0] * m[0]}};
}
static Vec<3> cross_moment(const Vec<3>& u, const Vec<3>& m) {
  return cross(u, m);
}

/// The equalities of a joint, as its row has them.
template <int D, class Joint = JointRow<D>>
struct RowSource {
  Joint& joint;

  int count() const { return joint.rows.count; }
  const Row<D>& row(int i) const { return joint.rows.rows[static_cast<std::size_t>(i)]; }
  Vec<D> direction(int i) const { return row(i).linear_b; }
  Spin<D> angular_a(int i) const { return row(i).angular_a; }
  Spin<D> angular_b(int i) const { return row(i).angular_b; }
  float error(int i) const { return row(i).error; }
  float rate(int i) const { return row(i).rate; }
  float impulse(int i) const { return joint.impulse[i]; }
  void set_impulse(int i, float impulse) const { joint.impulse[i] = impulse; }
};

/// The same of a pin in its lane.
template <int D, class Block>
struct LaneSource {
  Block& block;
  int lane;

  int count() const { return equalities_of<D>(block.form); }
  Vec<D> direction(int i) const { return lane_of(block.direction[i], lane); }
  Spin<D> angular_a(int i) const { return lane_of(block.angular_a[i], lane); }
  Spin<D> angular_b(int i) const { return lane_of(block.angular_b[i], lane); }
  float error(int i) const { return lane_of(block.error[i], lane); }
  float rate(int) const { return 0.0f; }
  float impulse(int i) const { return lane_of(block.impulse[i], lane); }
  void set_impulse(int i, float impulse) const { set_lane(block.impulse[i], lane, impulse); }
};

/// Where a joint holds its bodies, from their centres, m: told by the moments of its first rows.
template <int D>
struct JointArms {
  Vec<D> a = Vec<D>::zero();
  Vec<D> b = Vec<D>::zero();
};
template <int D, class Source>
static JointArms<D> arms_of(const Source& from) {
  constexpr float kShare = 1.0f / static_cast<float>(D - 1);
  JointArms<D> arms;
  for (int i = 0; i < D; ++i) {
    arms.a -= kShare * cross_moment(from.direction(i), from.angular_a(i));
    arms.b += kShare * cross_moment(from.direction(i), from.angular_b(i));
  }
  return arms;
}

/// Whether the first rows of a joint hold a point of one body at a point of the other.
template <int D>
static bool holds_point(const JointRow<D>& joint) {
  constexpr float kSame = 1.0e-4f;
  if (joint.rows.split < D) return false;
  const RowSource<D, const JointRow<D>> from{joint};
  const JointArms<D> arms = arms_of<D>(from);
  for (int i = 0; i < D; ++i) {
    const Vec<D> direction = from.direction(i);
    const Vec<D> both = direction + from.row(i).linear_a;
    if (dot(both, both) > 0.0f) return false;
    for (int j = 0; j <= i; ++j)
      if (abs(dot(direction, from.direction(j)) - (i == j ? 1.0f : 0.0f)) > kSame) return false;
    const Spin<D> off_a = moment(arms.a, direction) + from.angular_a(i);
    const Spin<D> off_b = moment(arms.b, direction) - from.angular_b(i);
    const float size = 1.0f + dot(arms.a, arms.a) + dot(arms.b, arms.b);
    if (dot(off_a, off_a) + dot(off_b, off_b) > kSame * kSame * size) return false;
  }
  return true;
}

/// The bodies of a joint.
template <int D>
struct JointedBodies {
  const Motion<D>& motion_a;
  const Motion<D>& motion_b;
  const BodyMass<D>& mass_a;
  const BodyMass<D>& mass_b;
};

/// How fast the point of a joint leaves its tangent, m/s, in the middle of a substep, where a body
/// turns by a spin that no solve changes: of the others the island solver foresees it.
template <int D>
static Vec<D, Wide> leaves_tangent(Wide h, const Motion<D>& motion, const Vec<D>& arm) {
  Vec<D, Wide> speed = centripetal(widened(motion.spin), widened(arm));
  for (int i = 0; i < D; ++i) speed[i] *= 0.5 * h;
  return speed;
}

/// What the force of a joint's point on one body does when that body turns: at an arm r it pulls
/// back with the impulse h r . force per rad/s. Taken implicitly it is stable at any load.
template <int D>
static void add_tension(Wide h, const Vec<D, Wide>& impulse, const Vec<D>& arm, int node,
                        const BodyMass<D>& mass, std::vector<IslandTension<D>>& tensions) {
  Vec<D> along = Vec<D>::zero();
  const float* inverse = mass.inverse_inertia.m;
  float across = inverse[0];
  if constexpr (Dim<D>::kSpin == 3) {
    along = normalized_or(arm, Vec<D>::zero());
    across =
        0.5f * (inverse[0] + inverse[4] + inverse[8] - dot(along, mass.inverse_inertia * along));
  }
  const auto pull = static_cast<float>(h * dot(widened(arm), impulse));
  if (!(pull * across > kExplicit)) return;
  tensions.push_back({node, pull - kExplicit / across, along});
}

/// The rows of a joint's point along the axes of the world, and its tensions.
template <int D, class Source>
static void gather_point_of_joint(const StepContext<D>& context, const JointedBodies<D>& bodies,
                                  const Source& from, Wide stiffness, IslandRows<D>& group,
                                  IslandRow<D>* row, std::vector<IslandTension<D>>& tensions) {
  const JointArms<D> arms = arms_of<D>(from);
  const bool a_turns = can_turn<D>(bodies.mass_a);
  const bool b_turns = can_turn<D>(bodies.mass_b);
  const auto h = static_cast<Wide>(context.h);
  Vec<D, Wide> impulse = Vec<D, Wide>::zero();
  Vec<D, Wide> error = Vec<D, Wide>::zero();
  Vec<D, Wide> missing =
      speed_at(bodies.motion_b, widened(arms.b)) - speed_at(bodies.motion_a, widened(arms.a));
  if (!b_turns) missing += leaves_tangent(h, bodies.motion_b, arms.b);
  if (!a_turns) missing -= leaves_tangent(h, bodies.motion_a, arms.a);
  for (int i = 0; i < D; ++i) {
    const Vec<D, Wide> direction = widened(from.direction(i));
    impulse += static_cast<Wide>(from.impulse(i)) * direction;
    error += static_cast<Wide>(from.error(i)) * direction;
    missing += static_cast<Wide>(from.rate(i)) * direction;
  }
  group.points = D;
  group.arm_a = a_turns ? widened(arms.a) : Vec<D, Wide>::zero();
  group.arm_b = b_turns ? widened(arms.b) : Vec<D, Wide>::zero();
  for (int i = 0; i < D; ++i) {
    row[i].missing = missing[i];
    row[i].closing = static_cast<Wide>(context.joint.bias_rate) * error[i];
    row[i].impulse = impulse[i];
    row[i].stiffness = stiffness;
  }
  if (a_turns && group.node_a >= 0)
    add_tension(h, -impulse, arms.a, group.node_a, bodies.mass_a, tensions);
  if (b_turns && group.node_b >= 0)
    add_tension(h, impulse, arms.b, group.node_b, bodies.mass_b, tensions);
}

/// A row of a joint that is of no point.
template <int D>
static void gather_row(const StepContext<D>& context, const JointedBodies<D>& bodies,
                       const Row<D>& from, float impulse,
                       const typename IslandSolver<D>::Island& island, IslandRow<D>& row) {
  bool moves = false;
  for (int i = 0; i < D; ++i) {
    row.a[i] = static_cast<Wide>(from.linear_a[i]);
    row.b[i] = static_cast<Wide>(from.linear_b[i]);
    moves = moves || from.linear_a[i] != 0.0f || from.linear_b[i] != 0.0f;
  }
  const bool a_turns = can_turn<D>(bodies.mass_a);
  const bool b_turns = can_turn<D>(bodies.mass_b);
  for (int i = 0; i < Dim<D>::kSpin; ++i) {
    row.a[D + i] = static_cast<Wide>(a_turns ? from.angular_a[i] : 0.0f);
    row.b[D + i] = static_cast<Wide>(b_turns ? from.angular_b[i] : 0.0f);
  }
  row.missing = static_cast<Wide>(row_speed(from, bodies.motion_a, bodies.motion_b));
  row.closing = static_cast<Wide>(context.joint.bias_rate * from.error);
  row.impulse = static_cast<Wide>(impulse);
  row.stiffness = static_cast<Wide>(kStiffness * (moves ? island.mass : island.inertia));
}

/// The row of an equality that turns two bodies against each other: of a pin behind its point.
template <int D, class Source>
static Row<D> turning_row(const Source& from, int i) {
  Row<D> row;
  row.angular_a = from.angular_a(i);
  row.angular_b = from.angular_b(i);
  row.error = from.error(i);
  return row;
}

template <int D>
static void gather_joint(const StepContext<D>& context, StepScratch<D>& scratch, JointRow<D>& joint,
                         const typename IslandSolver<D>::Island& island, IslandRows<D>& group,
                         IslandRow<D>* row) {
  const JointedBodies<D> bodies{scratch.motions[joint.body_a], scratch.motions[joint.body_b],
                                scratch.masses[joint.body_a], scratch.masses[joint.body_b]};
  const RowSource<D> from{joint};
  group.count = from.count();
  group.points = 0;
  group.arm_a = group.arm_b = Vec<D, Wide>::zero();
  if (holds_point(joint))
    gather_point_of_joint(context, bodies, from, static_cast<Wide>(kStiffness * island.mass), group,
                          row, scratch.islands_solved.tensions);
  for (int r = group.points; r < group.count; ++r)
    gather_row(context, bodies, from.row(r), joint.impulse[r], island, row[r]);
}

template <int D, class Block>
static void gather_pin(const StepContext<D>& context, StepScratch<D>& scratch, Block& block,
                       int lane, const typename IslandSolver<D>::Island& island,
                       IslandRows<D>& group, IslandRow<D>* row) {
  const std::uint32_t a = block.body_a[lane];
  const std::uint32_t b = block.body_b[lane];
  const JointedBodies<D> bodies{scratch.motions[a], scratch.motions[b], scratch.masses[a],
                                scratch.masses[b]};
  const LaneSource<D, Block> from{block, lane};
  group.count = from.count();
  gather_point_of_joint(context, bodies, from, static_cast<Wide>(kStiffness * island.mass), group,
                        row, scratch.islands_solved.tensions);
  for (int r = D; r < group.count; ++r)
    gather_row(context, bodies, turning_row<D>(from, r), from.impulse(r), island, row[r]);
}

template <int D>
void gather_joints(const StepContext<D>& context, StepScratch<D>& scratch,
                   const typename IslandSolver<D>::Island& island) {
  IslandSolver<D>& solver = scratch.islands_solved;
  for_each_joint(scratch.pins, solver, island.joints, [&](auto* block, int at, int g) {
    IslandRows<D>& group = solver.groups[static_cast<std::size_t>(g)];
    IslandRow<D>* row = &solver.rows[static_cast<std::size_t>(group.first)];
    if (block == nullptr)
      gather_joint(context, scratch, scratch.joint_rows[static_cast<std::size_t>(at)], island,
                   group, row);
    else
      gather_pin(context, scratch, *block, at, island, group, row);
  });
}

/// Impulses of a joint's rows, those of a point along its own directions.
template <int D, class Source>
static void scatter_impulses(const Source& to, const IslandRows<D>& group,
                             const IslandRow<D>* row) {
  for (int i = 0; i < group.points; ++i) {
    Wide impulse = 0.0;
    for (int j = 0; j < D; ++j) impulse += static_cast<Wide>(to.direction(i)[j]) * row[j].impulse;
    to.set_impulse(i, static_cast<float>(impulse));
  }
  for (int r = group.points; r < group.count; ++r)
    to.set_impulse(r, static_cast<float>(row[r].impulse));
}

template <int D>
void scatter_joints(StepScratch<D>& scratch, const typename IslandSolver<D>::Island& island) {
  const IslandSolver<D>& solver = scratch.islands_solved;
  for_each_joint(scratch.pins, solver, island.joints, [&](auto* block, int at, int g) {
    const IslandRows<D>& group = solver.groups[static_cast<std::size_t>(g)];
    const IslandRow<D>* row = &solver.rows[static_cast<std::size_t>(group.first)];
    if (block == nullptr)
      scatter_impulses(RowSource<D>{scratch.joint_rows[static_cast<std::size_t>(at)]}, group, row);
    else
      scatter_impulses(LaneSource<D, std::remove_pointer_t<decltype(block)>>{*block, at}, group,
                       row);
  });
}

template void gather_joints(const StepContext<2>&, StepScratch<2>&, const IslandSolver<2>::Island&);
template void gather_joints(const StepContext<3>&, StepScratch<3>&, const IslandSolver<3>::Island&);
template void scatter_joints(StepScratch<2>&, const IslandSolver<2>::Island&);
template void scatter_joints(StepScratch<3>&, const IslandSolver<3>::Island&);

}  // namespace cycloid::solver
