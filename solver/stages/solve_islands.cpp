#include "solver/constraints/contact_lanes.hpp"
#include "solver/stages/island_rest.hpp"
#include "solver/stages/island_rows.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// In how many ranges of blocks the warm start has left something.
struct Unrest {
  Tally misses;
  Tally stirs;
};

/// Nothing is settled that belongs to no island. Lanes of no contact go with the others, or a block
/// would be one of which only some lanes are.
template <int D, int W>
static void begin_settling(const BlockRange<D, W>& blocks, Unrest& all) {
  LaneBits misses = 0;
  LaneBits stirs = 0;
  for (ContactBlock<D, W>* block = blocks.begin; block != blocks.end; ++block) {
    block->settled = block->taken != 0 ? kAllLanes<W> & ~block->left : 0;
    if (block->taken == 0) continue;
    misses |= block->misses;
    stirs |= block->stirs;
  }
  if (misses != 0) all.misses.add(1);
  if (stirs != 0) all.stirs.add(1);
}

/// Looks for what the warm start has left to do, of contacts and of joints.
template <int D, int W>
static void look_for_rest(const StepContext<D>& context, const Lot& lot, Workers& workers,
                          StepScratch<D>& scratch, Unrest& all) {
  for_all_blocks<D, W>(lot, workers, scratch, [&](const BlockRange<D, W>& blocks) {
    ContactKernels<D, W>::look_for_rest(context, kRest, blocks);
    begin_settling(blocks, all);
  });
  with_blocks(scratch.pins, [&]<int P>(PinBlocks<D, P>& pins) {
    for_each_part_of_colors(pins.colors, {}, workers, [&](Range range) {
      PinKernels<D, P>::look_for_rest(context, kJointBounds, pin_range<D, P>(scratch, range));
    });
  });
}

/// Whether the warm start has left anything to do in an island. @pre look_for_rest.
template <int D, int W>
static bool is_restless(const StepContext<D>& context, const StepScratch<D>& scratch,
                        const Unrest& all, const typename IslandSolver<D>::Island& island) {
  const IslandSolver<D>& solver = scratch.islands_solved;
  const auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  const bool is_strict = island.stirred || island.sways;
  const bool looks = (is_strict ? all.stirs : all.misses).sum() != 0;
  for (int g = island.groups.begin; g < island.joints.begin && looks; ++g) {
    const auto& source = solver.sources[static_cast<std::size_t>(g)];
    const auto& block = blocks[static_cast<std::size_t>(source.place)];
    if (((is_strict ? block.stirs : block.misses) >> source.lane & 1) != 0) return true;
  }
  return any_joint_misses(context, scratch, island, is_strict ? kStirs : kMisses);
}

/// Tells the sweeps what is left to them of an island. Relax sweeps turn the speeds of joints into
/// where their rows have turned, and take back what closed them; in a tick whose islands have all,
/// the solve of the next substep does the first.
template <int D, int W>
static void hand_over(const typename IslandSolver<D>::Island& island, bool sweeps_joints,
                      bool sweeps_contacts, StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  for (int g = island.groups.begin; g < island.joints.begin && sweeps_contacts; ++g) {
    const auto& source = solver.sources[static_cast<std::size_t>(g)];
    blocks[static_cast<std::size_t>(source.place)].settled &= ~(LaneBits{1} << source.lane);
  }
  const bool relaxes = island.closes || !solver.has_all;
  for_each_joint(scratch.pins, solver, island.joints, [&](auto* block, int at, int g) {
    const int place = solver.sources[static_cast<std::size_t>(g)].place;
    JointRow<D>& joint = scratch.joint_rows[static_cast<std::size_t>(place)];
    joint.solved_directly = !sweeps_joints;
    joint.relaxes = relaxes;
    if (block == nullptr) return;
    const LaneBits bit = LaneBits{1} << at;
    block->settled = sweeps_joints ? block->settled & ~bit : block->settled | bit;
    block->relaxes = relaxes ? block->relaxes | bit : block->relaxes & ~bit;
  });
}

/// Whether contacts of an island that was solved as a whole are left to the sweeps. Not what they
/// miss where there are joints, for these pass the sweeps by: of a light body between a load and a
/// joint a sweep would part the joint by what the contact misses, substep by substep.
template <int D>
static bool sweeps_contacts(const IslandSolver<D>& solver,
                            const typename IslandSolver<D>::Island& island) {
  if (island.swept) return true;
  return island.joint_count == 0 && solver.leaves_for_sweeps(island, kRest.misses);
}

/// Solves one island from where the warm start has led, or leaves it to the sweeps where it has
/// cost too much in this tick.
template <int D, int W>
static void solve_island(const StepContext<D>& context, StepScratch<D>& scratch,
                         typename IslandSolver<D>::Island& island) {
  IslandSolver<D>& solver = scratch.islands_solved;
  if (island.products_left <= 0) return hand_over<D, W>(island, true, true, scratch);
  gather_island<D, W>(context, scratch, island);
  const IslandStep step{static_cast<Wide>(context.h),
                        static_cast<Wide>(context.tuning.push_speed_max)};
  const Solved solved = solver.solve(island, scratch.masses, scratch.motions, step);
  scatter_island<D, W>(scratch, island);
  const bool in_part = solved == Solved::kPartly;
  hand_over<D, W>(island, in_part, in_part || sweeps_contacts<D>(solver, island), scratch);
}

/// Solves the islands that are small enough at once, from where the warm start has led, and leaves
/// to the sweeps what it has brought to rest: a stack leans by less than an island misses at rest,
/// and only they take that back. What is solved, biased sweeps pass by; what was solved in part is
/// left to soft sweeps as well, for joints cannot wait. What only they solve has its guess weighed
/// before (weigh_guesses).
///
/// Reads and writes velocities and impulses of contacts and joints, and which lanes are settled.
/// Serial, island by island in the order of their lowest slots.
template <int D, int W>
void solve_islands(const StepContext<D>& context, const Lot& lot, Workers& workers,
                   StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  if (!solver.acts) return;
  solver.tensions.clear();
  Unrest all;
  look_for_rest<D, W>(context, lot, workers, scratch, all);
  weigh_guesses<D, W>(context, lot, workers, scratch);
  Tally stirred;
  const auto stir = [&](auto& island) {
    if (!island.taken) return;
    island.corrects = island.closes = false;
    island.stirred = is_restless<D, W>(context, scratch, all, island);
    if (island.stirred) stirred.add(1);
  };
  workers.parallel_for(static_cast<int>(solver.islands.size()), kIslandGrain, [&](Range range) {
    for (int i = range.begin; i < range.end; ++i) stir(solver.islands[static_cast<std::size_t>(i)]);
  });
  const bool any_stirred = stirred.sum() > 0;
  for (auto& island : solver.islands) {
    if (!island.taken) continue;
    if (island.stirred) {
      solve_island<D, W>(context, scratch, island);
      continue;
    }
    ++solver.work.rests;
    hand_over<D, W>(island, false, any_stirred, scratch);
  }
  for_all_blocks<D, W>(lot, workers, scratch, [&](const BlockRange<D, W>& blocks) {
    for (ContactBlock<D, W>* block = blocks.begin; block != blocks.end; ++block)
      if (!any_stirred || (block->settled & block->taken) == 0) block->settled = 0;
  });
}

/// Moves out of overlap what was solved at once, and leaves its velocities alone.
///
/// Reads corrections; writes deltas of positions and rotations.
template <int D>
void correct_islands(const StepContext<D>& context, StepScratch<D>& scratch) {
  const IslandSolver<D>& solver = scratch.islands_solved;
  if (!solver.acts) return;
  for (const auto& island : solver.islands) {
    for (int n = island.nodes.begin; n < island.nodes.end && island.taken && island.corrects; ++n) {
      const auto node = static_cast<std::size_t>(n);
      Motion<D>& motion = scratch.motions[solver.body_of[node]];
      Spin<D> turn;
      for (int i = 0; i < D; ++i)
        motion.delta_position[i] += context.h * static_cast<float>(solver.correction[node][i]);
      for (int i = 0; i < Dim<D>::kSpin; ++i)
        turn[i] = context.h * static_cast<float>(solver.correction[node][D + i]);
      if (can_turn<D>(scratch.masses[solver.body_of[node]])) turn_by(turn, motion);
    }
  }
}

template void correct_islands(const StepContext<2>&, StepScratch<2>&);
template void correct_islands(const StepContext<3>&, StepScratch<3>&);

template <int D, int W>
struct InstantiateIslands {
  decltype(&solve_islands<D, W>) solve = &solve_islands<D, W>;
};
template struct AtEveryWidth<InstantiateIslands>;

}  // namespace cycloid::solver
