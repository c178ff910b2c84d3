#include <algorithm>
#include <span>
#include <utility>

#include "solver/stages/island_rows.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Block products per pair of bodies that an island may take to factor once: beyond, as a net of
/// 100 x 100 pins is, it is left to the sweeps.
static constexpr int kProductsPerPair = 128;
/// The same, of all that it is factored in a tick: then it is left to the sweeps until the next. So
/// what is large may be solved when it is disturbed, and not in all rounds of every substep.
static constexpr int kProductsPerPairAndTick = 960;

/// Pairs in each body of an island that is thin, and beyond them: so it costs little to factor. A
/// stack, a bridge and an arch have as many pairs as bodies, heaps and nets twice as many.
static constexpr float kThinPairsPerBody = 1.25f;
static constexpr int kThinPairsMore = 2;

static bool would_be_thin(int pairs, int bodies) {
  return pairs <= static_cast<int>(kThinPairsPerBody * static_cast<float>(bodies)) + kThinPairsMore;
}

template <int D>
static bool is_thin(const typename IslandSolver<D>::Island& island) {
  return would_be_thin(island.pairs, island.bodies);
}

/// Whether the guess of an island that the sweeps have may be of a tick that solved it at once, and
/// so be weighed: without its contacts it would be thin, as a chain is that lies on itself and a
/// net is not. A few joints in a large heap are not worth to gather all of it in every substep.
template <int D>
static bool may_be_weighed(const typename IslandSolver<D>::Island& island) {
  constexpr int kSmall = 256;
  const bool many_joints = 4 * island.joint_count >= island.bodies;
  return island.joint_count > 0 && would_be_thin(island.joint_count, island.bodies) &&
         (many_joints || island.bodies <= kSmall);
}

/// Which islands are to be solved or weighed in this tick. @returns whether any is.
/// @pre find_held_islands.
template <int D>
static bool want_islands(IslandSolver<D>& solver) {
  for (auto& island : solver.islands) {
    island.wanted = !solver.only_thin;
    island.stands = island.lands = false;
  }
  if (!solver.only_thin) return true;
  bool any = false;
  int last = -1;
  for (const std::uint32_t slot : solver.loaded) {
    const int at = solver.island_of[slot];
    if (at < 0 || at == last) continue;  // A heap is loaded in thousands of places.
    last = at;
    auto& island = solver.islands[static_cast<std::size_t>(at)];
    if (island.wanted) continue;
    island.wanted = is_thin<D>(island) || may_be_weighed<D>(island);
    any = any || island.wanted;
  }
  return any;
}

/// Numbers the nodes of what may be solved, island after island, in the order of the slots.
template <int D>
static void number_nodes(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  int next = 0;
  for (auto& island : solver.islands) {
    island.nodes = {next, next};
    if (island.numbered) next += island.bodies;
  }
  const auto count = static_cast<std::size_t>(next);
  solver.body_of.resize(count);
  solver.change.resize(count);
  solver.correction.resize(count);
  solver.node_of.assign(scratch.masses.size(), -1);
  for (std::uint32_t slot = 0; slot < scratch.masses.size(); ++slot) {
    if (solver.island_of[slot] < 0) continue;
    auto& island = solver.islands[static_cast<std::size_t>(solver.island_of[slot])];
    if (!island.numbered) continue;
    solver.node_of[slot] = island.nodes.end;
    solver.body_of[static_cast<std::size_t>(island.nodes.end++)] = slot;
  }
}

/// What holds in terms of nodes. @returns whether it is as before, so that what was planned for it
/// still stands.
template <int D>
static bool list_pairs(IslandSolver<D>& solver) {
  std::swap(solver.pairs, solver.pairs_before);
  solver.pairs.clear();
  const int contacts_before = std::exchange(solver.contact_pairs, 0);
  for (std::size_t i = 0; i < solver.held.size(); ++i) {
    if (!solver.is_numbered(i)) continue;
    const HeldPair& pair = solver.held[i];
    const int a = solver.node_of[pair.a];
    const int b = solver.node_of[pair.b];
    solver.pairs.push_back({a, b});
    if (pair.lane >= 0) ++solver.contact_pairs;
  }
  solver.pairs_before.reserve(solver.pairs.size());
  return solver.pairs == solver.pairs_before && solver.contact_pairs == contacts_before;
}

/// Joins the nodes and plans each island. Those that touch something come last: a solve finds out
/// which contacts hold in a few passes, and joints always do.
template <int D>
static void plan_islands(IslandSolver<D>& solver) {
  const auto contacts = static_cast<std::size_t>(solver.contact_pairs);
  solver.matrix.begin(static_cast<int>(solver.body_of.size()));
  solver.beside.clear();
  for (const auto& [a, b] : solver.pairs)
    solver.beside.push_back(a >= 0 && b >= 0 ? solver.matrix.join(a, b) : -1);
  for (const auto& [a, b] : std::span(solver.pairs).first(contacts)) {
    if (a >= 0) solver.matrix.put_last(a);
    if (b >= 0) solver.matrix.put_last(b);
  }
  solver.plans.clear();
  for (const auto& island : solver.islands) {
    if (!island.numbered) continue;
    auto& plan = solver.plans.emplace_back();
    plan.solvable =
        solver.matrix.analyse(island.nodes, kProductsPerPair * island.pairs, plan.steps);
    if (!plan.solvable) continue;
    plan.contact_steps = solver.matrix.last_of(plan.steps);
    plan.products = solver.matrix.products(plan.steps);
    plan.contact_products = solver.matrix.products(plan.contact_steps);
  }
}

template <int D>
static void follow_plans(IslandSolver<D>& solver) {
  auto plan = solver.plans.begin();
  for (auto& island : solver.islands) {
    island.solvable = false;
    if (!island.numbered) continue;
    island.steps = plan->steps;
    island.contact_steps = plan->contact_steps;
    island.products = plan->products;
    island.contact_products = plan->contact_products;
    island.solvable = plan->solvable;
    ++plan;
  }
}

/// Plans what is wanted, beside what was in the ticks before where the same still holds. Lets go of
/// what would cost too much.
template <int D>
static void plan_wanted(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  bool more = false;
  for (auto& island : solver.islands) {
    more = more || (island.wanted && !island.planned);
    island.planned = island.planned || island.wanted;
    island.numbered = island.planned && (!solver.only_thin || is_thin<D>(island));
  }
  if (!more) return;
  number_nodes(scratch);
  if (!list_pairs(solver)) plan_islands(solver);
  follow_plans(solver);
  list_groups(scratch);
}

/// What is each island's own in this tick: whether it is solved, its greatest mass and inertia, and
/// how much it may cost. @returns whether any is solved or weighed.
template <int D>
static bool begin_islands(StepScratch<D>& scratch) {
  bool any = false;
  for (auto& island : scratch.islands_solved.islands) {
    island.taken = island.wanted && island.solvable;
    island.weighed = island.wanted && !island.solvable && may_be_weighed<D>(island);
    island.products_left = std::int64_t{kProductsPerPairAndTick} * island.pairs;
    island.swept = island.stirred = island.corrects = false;
    if (!island.taken && !island.weighed) continue;
    find_heaviest(scratch, island);
    if (island.joint_count > 0) scratch.islands_solved.guess.resize(scratch.motions.size());
    any = true;
  }
  return any;
}

/// Forgets what is kept of islands where the tuning asks for other islands than it was made for.
template <int D>
static void begin_grouping(const Tuning& tuning, IslandSolver<D>& solver) {
  const bool only_thin = tuning.contact_block == ContactBlockRows::kLoadedIsland;
  if (solver.only_thin == only_thin) return;
  solver.only_thin = only_thin;
  solver.held_words.clear();
  solver.pairs.clear();
}

/// Says of which island each pair that holds is.
template <int D>
static void place_held(IslandSolver<D>& solver) {
  solver.held_in.resize(solver.held.size());
  for (std::size_t i = 0; i < solver.held.size(); ++i) {
    const HeldPair& pair = solver.held[i];
    solver.held_in[i] = solver.island_of[pair.a_moves ? pair.a : pair.b];
  }
}

/// Sorts what touches or is jointed into islands and plans how each that is wanted is solved at
/// once. What holds the same as before is sorted as it was: a cache, which changes no bit. It is
/// taken down pair by pair only where some island is wanted.
///
/// Reads contact blocks, joint rows, masses, motions and which bodies are loaded; writes the island
/// solver, and which lanes of blocks land. Serial, in the order of the colouring and of the slots.
template <int D, int W>
void group_islands(const StepContext<D>& context, Workers& workers, StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  begin_grouping(context.tuning, solver);
  find_held_islands(scratch);
  solver.acts = want_islands(solver);
  if (!solver.acts) return;
  if (!list_held<D, W>(workers, scratch)) {
    place_held(solver);
    for (auto& island : solver.islands) island.planned = false;
    solver.is_sorted = false;
  }
  if (solver.only_thin) solver.acts = find_landing<D, W>(scratch);
  if (!solver.acts) return;
  plan_wanted(scratch);
  solver.acts = begin_islands(scratch);
}

template <int D, int W>
struct InstantiateGroups {
  decltype(&group_islands<D, W>) group = &group_islands<D, W>;
};
template struct AtEveryWidth<InstantiateGroups>;

}  // namespace cycloid::solver
