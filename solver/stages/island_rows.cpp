#include "solver/stages/island_rows.hpp"

#include "solver/constraints/contact_lanes.hpp"
#include "solver/constraints/single_lanes.hpp"

namespace cycloid::solver {

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
  const Vec<D, Wide> apart = speed_at(motion_b, widened(r_b)) - speed_at(motion_a, widened(r_a));
  group.arm_a = a_turns ? widened(r_a) : Vec<D, Wide>::zero();
  group.arm_b = b_turns ? widened(r_b) : Vec<D, Wide>::zero();
  group.friction = static_cast<Wide>(block.friction.raw[lane]);
  group.count = group.points = group.friction > 0.0 ? 1 + Dim<D>::kTangents : 1;
  for (int r = 0; r < group.count; ++r) {
    const Vec<D, Wide> direction =
        widened(lane_of(r == 0 ? block.normal : tangent_of(block, r - 1), lane));
    for (int i = 0; i < D; ++i) row[r].b[i] = direction[i];
    row[r].missing = dot(direction, apart);
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

/// Whether a body of a contact moves that no impulse moves: the ground that somebody rides on.
template <int D, int W>
static bool is_on_moving_ground(const StepScratch<D>& scratch, const ContactBlock<D, W>& block,
                                int lane) {
  const auto is_ground_and_moves = [&](std::uint32_t slot) {
    return scratch.masses[slot].inverse_mass == 0.0f && is_moving(scratch.motions[slot]);
  };
  return is_ground_and_moves(block.body_a[lane]) || is_ground_and_moves(block.body_b[lane]);
}

template <int D, int W>
void gather_island(const StepContext<D>& context, StepScratch<D>& scratch,
                   typename IslandSolver<D>::Island& island) {
  IslandSolver<D>& solver = scratch.islands_solved;
  const auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  const auto stiffness = static_cast<Wide>(kStiffness * island.mass);
  island.tensions = {static_cast<int>(solver.tensions.size()),
                     static_cast<int>(solver.tensions.size())};
  for (int g = island.groups.begin; g < island.joints.begin; ++g) {
    IslandRows<D>& group = solver.groups[static_cast<std::size_t>(g)];
    const auto& source = solver.sources[static_cast<std::size_t>(g)];
    const auto& block = blocks[static_cast<std::size_t>(source.place)];
    gather_point<D, W>(context, scratch, block, source, stiffness, group,
                       &solver.rows[static_cast<std::size_t>(group.first)]);
    if (is_on_moving_ground(scratch, block, source.lane)) island.calm = false;
  }
  gather_joints(context, scratch, island);
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
  for (int g = island.groups.begin; g < island.joints.begin; ++g) {
    const IslandRows<D>& group = solver.groups[static_cast<std::size_t>(g)];
    const auto& source = solver.sources[static_cast<std::size_t>(g)];
    const IslandRow<D>* row = &solver.rows[static_cast<std::size_t>(group.first)];
    auto& point = blocks[static_cast<std::size_t>(source.place)].points[source.point];
    for (int r = 0; r < group.count; ++r)
      (r == 0 ? point.normal_impulse : point.tangent_impulse[r - 1]).raw[source.lane] =
          static_cast<float>(row[r].impulse);
  }
  scatter_joints(scratch, island);
}

template <int D, int W>
struct InstantiateIslandRows {
  decltype(&gather_island<D, W>) gather = &gather_island<D, W>;
  decltype(&scatter_island<D, W>) scatter = &scatter_island<D, W>;
};
template struct AtEveryWidth<InstantiateIslandRows>;

}  // namespace cycloid::solver
