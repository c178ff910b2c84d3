#include "solver/constraints/contact_block.hpp"
#include "solver/constraints/single_lanes.hpp"
#include "solver/lane_widths.hpp"
#include "solver/stages/island_rows.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// As fast as the bodies of an island at rest move at most, along any axis and beside its mean, and
/// as its points of contact come nearer to the ground or part from it, m/s. With 0.2 a stack of
/// thirty sinks by half as much again before it is held, with 0.1 so does a weight on a pebble;
/// with 0.5 a heap that lands costs a sixth more (docs/stability.md).
static constexpr float kAtRest = 0.3f;

/// Whether it depends on rest whether an island is solved at once: it is wanted, and has no joint,
/// which sweeps would let part.
template <int D>
static bool needs_rest(const typename IslandSolver<D>::Island& island) {
  return island.wanted && island.joint_count == 0;
}

/// How fast the points of a contact come nearer or part, m/s, of those that do so fastest.
/// @pre nothing has moved since the tick began.
template <int D, int W>
static float speed_along_normal(const ContactBlock<D, W>& block, int lane, const Motion<D>& a,
                                const Motion<D>& b) {
  const Vec<D> normal = lane_of(block.normal, lane);
  const Vec<D> between = lane_of(block.between, lane);
  float fastest = 0.0f;
  for (std::uint32_t p = 0; p < block.point_count; ++p) {
    if (!(lane_of(block.points[p].normal_mass, lane) > 0.0f)) continue;
    const Vec<D> r_a = lane_of(block.points[p].r_a, lane);
    const Vec<D> of_a = a.velocity + spin_cross(a.spin, r_a);
    const Vec<D> of_b = b.velocity + spin_cross(b.spin, r_a - between);
    fastest = max(fastest, abs(dot(of_b - of_a, normal)));
  }
  return fastest;
}

/// Finds which islands touch ground, of what has no mass, and which come down on it.
template <int D, int W>
static void look_at_ground(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  const auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  for (std::size_t i = 0; i < solver.held.size(); ++i) {
    const HeldPair& pair = solver.held[i];
    if (solver.held_in[i] < 0 || (pair.a_moves && pair.b_moves)) continue;
    auto& island = solver.islands[static_cast<std::size_t>(solver.held_in[i])];
    if (!needs_rest<D>(island) || island.lands) continue;
    island.stands = true;
    const auto& block = blocks[static_cast<std::size_t>(pair.place)];
    island.lands = speed_along_normal<D, W>(block, pair.lane, scratch.motions[pair.a],
                                            scratch.motions[pair.b]) > kAtRest;
  }
}

/// Calls act(island, its number, velocity) for each body of the islands that may be at rest still.
template <int D, class Act>
static void for_each_velocity(StepScratch<D>& scratch, Act&& act) {
  IslandSolver<D>& solver = scratch.islands_solved;
  for (std::size_t slot = 0; slot < scratch.masses.size(); ++slot) {
    if (solver.island_of[slot] < 0) continue;
    const auto at = static_cast<std::size_t>(solver.island_of[slot]);
    auto& island = solver.islands[at];
    if (needs_rest<D>(island) && !island.lands) act(island, at, scratch.motions[slot].velocity);
  }
}

/// Finds the islands of which a body moves beside the others.
template <int D>
static void look_at_bodies(StepScratch<D>& scratch) {
  std::vector<Vec<D>>& mean = scratch.islands_solved.mean_velocity;
  mean.assign(scratch.islands_solved.islands.size(), Vec<D>::zero());
  for_each_velocity(scratch, [&](const auto& island, std::size_t at, const Vec<D>& velocity) {
    mean[at] += (1.0f / static_cast<float>(island.bodies)) * velocity;
  });
  for_each_velocity(scratch, [&](auto& island, std::size_t at, const Vec<D>& velocity) {
    const Vec<D> beside = velocity - mean[at];
    for (int i = 0; i < D; ++i) island.lands = island.lands || abs(beside[i]) > kAtRest;
  });
}

/// Lets the sweeps have what lands, rigidly.
template <int D, int W>
static void mark_landing(StepScratch<D>& scratch) {
  const IslandSolver<D>& solver = scratch.islands_solved;
  auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  for (std::size_t i = 0; i < solver.held.size(); ++i) {
    if (solver.held_in[i] < 0) continue;
    if (!solver.islands[static_cast<std::size_t>(solver.held_in[i])].lands) continue;
    const HeldPair& pair = solver.held[i];
    blocks[static_cast<std::size_t>(pair.place)].landing |= LaneBits{1} << pair.lane;
  }
}

template <int D, int W>
bool find_landing(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  look_at_ground<D, W>(scratch);
  look_at_bodies(scratch);
  bool any_lands = false;
  bool any_wanted = false;
  for (auto& island : solver.islands) {
    if (needs_rest<D>(island) && !island.stands) island.lands = true;
    island.wanted = island.wanted && !island.lands;
    any_lands = any_lands || island.lands;
    any_wanted = any_wanted || island.wanted;
  }
  if (any_lands) mark_landing<D, W>(scratch);
  return any_wanted;
}

template <int D, int W>
struct InstantiateLanding {
  decltype(&find_landing<D, W>) find = &find_landing<D, W>;
};
template struct AtEveryWidth<InstantiateLanding>;

}  // namespace cycloid::solver
