#include "solver/stages/island_rows.hpp"

#include "solver/constraints/contact_lanes.hpp"
#include "solver/direct/island_parts.hpp"
#include "solver/stages/pin_rows.hpp"

namespace cycloid::solver {

/// Stiffness of a row over the greatest mass of its island: what a load leaves of its impulse to
/// the next substep is a thousandth.
static constexpr float kStiffness = 1.0e3f;
/// Tension over inertia, in one substep, that the explicit step is left: so what spins slower than
/// a third of a radian per substep keeps its angular momentum.
static constexpr float kExplicit = 0.1f;

template <int D>
static Wide speed_of(const Wide (&row)[Dim<D>::kFreedoms], const Motion<D>& motion) {
  Wide speed = 0.0;
  for (int i = 0; i < D; ++i) speed += row[i] * static_cast<Wide>(motion.velocity[i]);
  for (int i = 0; i < Dim<D>::kSpin; ++i) speed += row[D + i] * static_cast<Wide>(motion.spin[i]);
  return speed;
}

template <int N, class L>
static Vec<N> lane_of(const Vec<N, L>& lanes, int lane) {
  Vec<N> one;
  for (int i = 0; i < N; ++i) one[i] = lanes[i].raw[lane];
  return one;
}

/// The rows of a contact point: its normal, and its tangents where it rubs.
/// @pre the block's arms are of the present poses.
template <int D, int W>
static void gather_point(const StepContext<D>& context, const StepScratch<D>& scratch,
                         const ContactBlock<D, W>& block,
                         const typename IslandSolver<D>::Source& source, Wide stiffness,
                         IslandRows<D>& group, IslandRow<D>* row) {
  const auto& point = block.points[source.point];
  const int lane = source.lane;
  const Motion<D>& motion_a = scratch.motions[block.body_a[lane]];
  const Motion<D>& motion_b = scratch.motions[block.body_b[lane]];
  const bool a_turns = can_turn<D>(scratch.masses[block.body_a[lane]]);
  const bool b_turns = can_turn<D>(scratch.masses[block.body_b[lane]]);
  const Vec<D> at_start = lane_of(point.r_a, lane);
  const Vec<D> r_a = at_start + lane_of(block.slide_a, lane);
  const Vec<D> r_b = (at_start - lane_of(block.between, lane)) + lane_of(block.slide_b, lane);
  for (int i = 0; i < D; ++i) {
    group.arm_a[i] = static_cast<Wide>(a_turns ? r_a[i] : 0.0f);
    group.arm_b[i] = static_cast<Wide>(b_turns ? r_b[i] : 0.0f);
  }
  group.friction = static_cast<Wide>(block.friction.raw[lane]);
  group.count = group.friction > 0.0 ? 1 + Dim<D>::kTangents : 1;
  for (int r = 0; r < group.count; ++r) {
    const Vec<D> direction = lane_of(r == 0 ? block.normal : tangent_of(block, r - 1), lane);
    const Spin<D> turn_a = moment(r_a, direction);
    const Spin<D> turn_b = moment(r_b, direction);
    for (int i = 0; i < D; ++i) {
      row[r].b[i] = static_cast<Wide>(direction[i]);
      row[r].a[i] = -row[r].b[i];
    }
    for (int i = 0; i < Dim<D>::kSpin; ++i) {
      row[r].a[D + i] = static_cast<Wide>(a_turns ? -turn_a[i] : 0.0f);
      row[r].b[D + i] = static_cast<Wide>(b_turns ? turn_b[i] : 0.0f);
    }
    row[r].missing = speed_of<D>(row[r].a, motion_a) + speed_of<D>(row[r].b, motion_b);
    row[r].closing = 0.0;
    row[r].stiffness = stiffness;
    row[r].impulse = static_cast<Wide>(r == 0 ? point.normal_impulse.raw[lane]
                                              : point.tangent_impulse[r - 1].raw[lane]);
    row[r].mass = static_cast<Wide>(r == 0 ? point.normal_mass.raw[lane]
                                           : point.tangent_mass[r - 1].raw[lane]);
  }
  const float gap = point.gap.raw[lane];
  if (gap > 0.0f) {
    row[0].missing += static_cast<Wide>(gap * context.inverse_h);
    return;
  }
  const bool both = (block.moves_a >> lane & 1) != 0 && (block.moves_b >> lane & 1) != 0;
  const float rate = both ? context.contact.bias_rate : context.contact_static.bias_rate;
  row[0].closing = static_cast<Wide>(
      max(rate * min(gap + context.tuning.slop, 0.0f), -context.tuning.push_speed_max));
}

/// r x (u x ...): a vector along which the moment of another is known.
static Vec<2> cross_moment(const Vec<2>& u, const Vec<1>& m) {
  return {{u[1] * m[0], -u[0] * m[0]}};
}
static Vec<3> cross_moment(const Vec<3>& u, const Vec<3>& m) {
  return cross(u, m);
}

/// Where a joint holds its bodies, from their centres, m: told by the moments of its first rows; 0
/// where these do not hold a point.
template <int D>
struct JointArms {
  Vec<D> a = Vec<D>::zero();
  Vec<D> b = Vec<D>::zero();
};
template <int D>
static JointArms<D> arms_of(const JointRow<D>& joint) {
  constexpr float kShare = 1.0f / static_cast<float>(D - 1);
  JointArms<D> arms;
  if (joint.rows.split < D) return arms;
  for (int r = 0; r < D; ++r) {
    const Row<D>& row = joint.rows.rows[static_cast<std::size_t>(r)];
    if (dot(row.linear_b, row.linear_b) == 0.0f) return {};
    arms.a += kShare * cross_moment(row.linear_a, row.angular_a);
    arms.b += kShare * cross_moment(row.linear_b, row.angular_b);
  }
  return arms;
}

/// How fast the point of a joint leaves its tangent, m/s, in the middle of a substep, where a body
/// turns that no solve changes: of the others the island solver foresees it.
template <int D>
static Vec<D, Wide> leaves_tangent(const StepContext<D>& context, const Motion<D>& motion, int node,
                                   const Vec<D, Wide>& arm) {
  if (node >= 0) return Vec<D, Wide>::zero();
  Vec<Dim<D>::kSpin, Wide> spin;
  for (int i = 0; i < Dim<D>::kSpin; ++i) spin[i] = static_cast<Wide>(motion.spin[i]);
  Vec<D, Wide> speed = centripetal(spin, arm);
  for (int i = 0; i < D; ++i) speed[i] *= 0.5 * static_cast<Wide>(context.h);
  return speed;
}

template <int D>
static void gather_joint(const StepContext<D>& context, const StepScratch<D>& scratch,
                         const JointRow<D>& joint, const typename IslandSolver<D>::Island& island,
                         const JointArms<D>& arms, IslandRows<D>& group, IslandRow<D>* row) {
  group.count = joint.rows.count;
  for (int i = 0; i < D; ++i) {
    group.arm_a[i] = static_cast<Wide>(arms.a[i]);
    group.arm_b[i] = static_cast<Wide>(arms.b[i]);
  }
  const Motion<D>& motion_a = scratch.motions[joint.body_a];
  const Motion<D>& motion_b = scratch.motions[joint.body_b];
  const Vec<D, Wide> bend_a = leaves_tangent(context, motion_a, group.node_a, group.arm_a);
  const Vec<D, Wide> bend_b = leaves_tangent(context, motion_b, group.node_b, group.arm_b);
  for (int r = 0; r < joint.rows.count; ++r) {
    const Row<D>& from = joint.rows.rows[static_cast<std::size_t>(r)];
    bool moves = false;
    for (int i = 0; i < D; ++i) {
      row[r].a[i] = static_cast<Wide>(from.linear_a[i]);
      row[r].b[i] = static_cast<Wide>(from.linear_b[i]);
      moves = moves || from.linear_a[i] != 0.0f || from.linear_b[i] != 0.0f;
    }
    const bool a_turns = can_turn<D>(scratch.masses[joint.body_a]);
    const bool b_turns = can_turn<D>(scratch.masses[joint.body_b]);
    for (int i = 0; i < Dim<D>::kSpin; ++i) {
      row[r].a[D + i] = static_cast<Wide>(a_turns ? from.angular_a[i] : 0.0f);
      row[r].b[D + i] = static_cast<Wide>(b_turns ? from.angular_b[i] : 0.0f);
    }
    row[r].missing = static_cast<Wide>(row_speed(from, motion_a, motion_b));
    for (int i = 0; i < D; ++i) row[r].missing += row[r].b[i] * (bend_b[i] - bend_a[i]);
    row[r].closing = static_cast<Wide>(context.joint.bias_rate * from.error);
    row[r].impulse = static_cast<Wide>(joint.impulse[r]);
    row[r].mass = 1.0;
    row[r].stiffness = static_cast<Wide>(kStiffness * (moves ? island.mass : island.inertia));
  }
}

/// What the force of a joint's point rows on one body does when that body turns: at an arm r it
/// pulls back with the impulse h r . impulse per rad/s. Taken implicitly it is stable at any load.
template <int D>
static void add_tension(const StepContext<D>& context, const JointRow<D>& joint, bool of_b,
                        const Vec<D>& arm, int node, const BodyMass<D>& mass,
                        std::vector<IslandTension<D>>& tensions) {
  if (node < 0 || !can_turn<D>(mass) || dot(arm, arm) == 0.0f) return;
  Vec<D> force = Vec<D>::zero();
  for (int r = 0; r < D; ++r) {
    const Row<D>& row = joint.rows.rows[static_cast<std::size_t>(r)];
    force += joint.impulse[r] * (of_b ? row.linear_b : row.linear_a);
  }
  const Vec<D> along = normalized_or(arm, Vec<D>::zero());
  const float* inverse = mass.inverse_inertia.m;
  float across = inverse[0];
  if constexpr (Dim<D>::kSpin == 3)
    across =
        0.5f * (inverse[0] + inverse[4] + inverse[8] - dot(along, mass.inverse_inertia * along));
  const float stiffness = context.h * dot(arm, force) - kExplicit / max(across, 1.0e-30f);
  if (stiffness > 0.0f) tensions.push_back({node, stiffness, along});
}

template <int D, int W>
void gather_island(const StepContext<D>& context, StepScratch<D>& scratch,
                   typename IslandSolver<D>::Island& island) {
  IslandSolver<D>& solver = scratch.islands_solved;
  const auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  const auto stiffness = static_cast<Wide>(kStiffness * island.mass);
  island.tensions = {static_cast<int>(solver.tensions.size()),
                     static_cast<int>(solver.tensions.size())};
  for (int g = island.groups.begin; g < island.groups.end; ++g) {
    IslandRows<D>& group = solver.groups[static_cast<std::size_t>(g)];
    const auto& source = solver.sources[static_cast<std::size_t>(g)];
    IslandRow<D>* row = &solver.rows[static_cast<std::size_t>(group.first)];
    const auto place = static_cast<std::size_t>(source.place);
    if (group.is_contact) {
      gather_point<D, W>(context, scratch, blocks[place], source, stiffness, group, row);
      continue;
    }
    unpack_pin(scratch.pins, place, scratch.joint_rows);
    const JointRow<D>& joint = scratch.joint_rows[place];
    const JointArms<D> arms = arms_of(joint);
    gather_joint(context, scratch, joint, island, arms, group, row);
    add_tension(context, joint, false, arms.a, group.node_a, scratch.masses[joint.body_a],
                solver.tensions);
    add_tension(context, joint, true, arms.b, group.node_b, scratch.masses[joint.body_b],
                solver.tensions);
  }
  island.tensions.end = static_cast<int>(solver.tensions.size());
}

template <int D, int W>
void scatter_island(StepScratch<D>& scratch, const typename IslandSolver<D>::Island& island) {
  IslandSolver<D>& solver = scratch.islands_solved;
  auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  for (int n = island.nodes.begin; n < island.nodes.end; ++n) {
    const auto node = static_cast<std::size_t>(n);
    Motion<D>& motion = scratch.motions[solver.body_of[node]];
    const bool turns = can_turn<D>(scratch.masses[solver.body_of[node]]);
    for (int i = 0; i < D; ++i) motion.velocity[i] += static_cast<float>(solver.change[node][i]);
    for (int i = 0; i < Dim<D>::kSpin && turns; ++i)
      motion.spin[i] += static_cast<float>(solver.change[node][D + i]);
  }
  for (int g = island.groups.begin; g < island.groups.end; ++g) {
    const IslandRows<D>& group = solver.groups[static_cast<std::size_t>(g)];
    const auto& source = solver.sources[static_cast<std::size_t>(g)];
    const IslandRow<D>* row = &solver.rows[static_cast<std::size_t>(group.first)];
    const auto place = static_cast<std::size_t>(source.place);
    for (int r = 0; r < group.count; ++r) {
      const auto impulse = static_cast<float>(row[r].impulse);
      if (!group.is_contact) {
        scratch.joint_rows[place].impulse[r] = impulse;
        continue;
      }
      auto& point = blocks[place].points[source.point];
      (r == 0 ? point.normal_impulse : point.tangent_impulse[r - 1]).raw[source.lane] = impulse;
    }
    if (!group.is_contact) take_impulses(scratch.joint_rows, place, scratch.pins);
  }
}

template <int D, int W>
struct InstantiateIslandRows {
  static constexpr auto kGather = &gather_island<D, W>;
  static constexpr auto kScatter = &scatter_island<D, W>;
};
template struct InstantiateIslandRows<2, 1>;
template struct InstantiateIslandRows<2, 4>;
template struct InstantiateIslandRows<2, 8>;
template struct InstantiateIslandRows<2, 16>;
template struct InstantiateIslandRows<2, kAvx2Lanes>;
template struct InstantiateIslandRows<2, kAvx512Lanes>;
template struct InstantiateIslandRows<3, 1>;
template struct InstantiateIslandRows<3, 4>;
template struct InstantiateIslandRows<3, 8>;
template struct InstantiateIslandRows<3, 16>;
template struct InstantiateIslandRows<3, kAvx2Lanes>;
template struct InstantiateIslandRows<3, kAvx512Lanes>;

}  // namespace cycloid::solver
