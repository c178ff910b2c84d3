#include "solver/stages/in_chunks.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// How far the spring of a soft contact or joint may give way under its load before its island is
/// solved at once, m, were it as stiff at first as it is later: contacts give way by half of that
/// (make_step_context). Half as much holds no more contacts and solves more than twice as many
/// islands in a room of players, and three quarters as much for joints a ninth more in piles of
/// ragdolls. Twice as much for contacts lets stacks of ten sink by 6 mm instead of 2, and half as
/// much again for joints leaves a bridge to the sweeps now and then, which part its joints.
static constexpr float kYield = 2.0e-3f;
/// Masses over one another across a joint of which sweeps carry so little that the lighter one does
/// not tell what it is to hold until it is late: a chain that swept joints have stretched to 3 mm
/// each is nearly straight, and closing it is what throws it about. From 10 to 50 is all the same.
static constexpr float kJointMassRatio = 30.0f;

template <int D>
static bool is_of_unequal_masses(const JointRow<D>& row) {
  const float a = row.mass_a.inverse_mass;
  const float b = row.mass_b.inverse_mass;
  return min(a, b) > 0.0f && max(a, b) > kJointMassRatio * min(a, b);
}

/// Whether what a joint carries, N s in every substep, would move its spring by more than the
/// bound, or may soon, or what it holds is far from where it belongs. Of the first rows alone:
/// those hold a point together, and their impulses are forces.
template <int D>
static bool is_loaded(const StepContext<D>& context, const JointRow<D>& row) {
  if (!is_held(row)) return false;
  if (row.parted || is_of_unequal_masses(row)) return true;
  float square = 0.0f;
  for (int i = 0; i < D; ++i) square += row.impulse[i] * row.impulse[i];
  const float inverse_mass = row.mass_a.inverse_mass + row.mass_b.inverse_mass;
  return sqrt(square) * inverse_mass * yield_of(context.joint) > kYield;
}

template <int D>
LoadBounds load_bounds(const StepContext<D>& context) {
  if (!solves_loaded_islands(context.tuning)) return {};
  return {true, yield_of(context.contact), yield_of(context.contact_static), kYield};
}

/// Undoes the division into lots where contacts are loaded: whether an island is solved at once is
/// asked of all blocks, and those of lots do not stand in memory together.
///
/// Reads live contacts, their impulses and masses; writes the lots. Any split into ranges finds the
/// same.
template <int D, int W>
void join_loaded_lots(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                      StepScratch<D>& scratch) {
  const LoadBounds bounds = load_bounds(context);
  if (scratch.lots.all.empty() || !bounds.asked) return;
  const ContactInputs<D> inputs = contact_inputs(context, state, scratch);
  Tally loaded;
  workers.parallel_for(static_cast<int>(scratch.live.size()), kLookGrain, [&](Range range) {
    if (!loaded.is_over() &&
        ContactKernels<D, W>::any_loaded(bounds, inputs, range.begin, range.end))
      loaded.add(1);
  });
  if (loaded.is_over()) scratch.lots.all.clear();
}

/// Looks for what soft contacts and joints cannot hold up: with them overlap is load over frequency
/// squared, whatever the number of substeps. The load is that of the last tick, which the state
/// has; of joints between unequal masses, and of those that have parted, it is not waited for. What
/// is divided into lots was looked at: join_loaded_lots.
///
/// Reads masses, the loaded lanes of blocks and the impulses of joint rows; writes the loaded
/// slots, one of each such pair, and whether islands are solved at all in this tick. Which slots
/// there are does not depend on the order.
template <int D, int W>
void find_loaded(const StepContext<D>& context, Workers& workers, StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  solver.loaded.clear();
  solver.acts = context.tuning.contact_block == ContactBlockRows::kIsland;
  if (solver.acts || !solves_islands(context.tuning) || !scratch.lots.all.empty()) return;
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::vector<std::uint32_t>& loaded) {
    loaded.push_back(scratch.masses[a].inverse_mass > 0.0f ? a : b);
  };
  const auto& contacts = std::get<ContactBlocks<D, W>>(scratch.contact_blocks);
  const auto list_contacts = [&](Range range, std::vector<std::uint32_t>& loaded) {
    for (int i = range.begin; i < range.end; ++i) {
      const ContactBlock<D, W>& block = contacts.blocks[static_cast<std::size_t>(i)];
      for (int lane = 0; lane < kLaneCount<W> && block.loaded >> lane != 0; ++lane)
        if ((block.loaded >> lane & 1) != 0) add(block.body_a[lane], block.body_b[lane], loaded);
    }
  };
  list_by_color(std::span<const Range>(contacts.colors), contacts.overflow, workers,
                scratch.slot_chunks, solver.loaded, list_contacts);
  const auto list_joints = [&](Range range, std::vector<std::uint32_t>& loaded) {
    for (int i = range.begin; i < range.end; ++i) {
      const JointRow<D>& row = scratch.joint_rows[static_cast<std::size_t>(i)];
      if (is_loaded(context, row)) add(row.body_a, row.body_b, loaded);
    }
  };
  list_in_chunks(workers, static_cast<int>(scratch.joint_rows.size()), kLookGrain,
                 scratch.slot_chunks, solver.loaded, list_joints);
  solver.acts = !solver.loaded.empty();
}

template LoadBounds load_bounds(const StepContext<2>&);
template LoadBounds load_bounds(const StepContext<3>&);

template <int D, int W>
struct InstantiateLoaded {
  decltype(&join_loaded_lots<D, W>) join = &join_loaded_lots<D, W>;
  decltype(&find_loaded<D, W>) find = &find_loaded<D, W>;
};
template struct AtEveryWidth<InstantiateLoaded>;

}  // namespace cycloid::solver
