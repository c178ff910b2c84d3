#include <algorithm>

#include "solver/stages/stages.hpp"
#include "solver/union_find.hpp"

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

template <int D>
static bool moves(const StepScratch<D>& scratch, std::uint32_t slot) {
  return scratch.masses[slot].inverse_mass > 0.0f && scratch.awake[slot] != 0;
}

/// Takes down what holds: every contact in the order of the colouring, which is the same whatever
/// the lanes, then every joint that does not yield. @returns whether it is what held before, in a
/// world of as many slots, so that all that was made of it still stands.
template <int D, int W>
static bool list_held(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  bool same = solver.island_of.size() == scratch.masses.size();
  std::size_t count = 0;
  const auto add = [&](std::uint32_t a, std::uint32_t b, int place, int lane, int points) {
    const HeldPair pair{a, b, place, lane, points, moves(scratch, a), moves(scratch, b)};
    if (count == solver.held.size()) solver.held.emplace_back();
    same = same && solver.held[count] == pair;
    solver.held[count++] = pair;
  };
  const auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const ContactBlock<D, W>& block = blocks[i];
    for (int lane = 0; lane < kLaneCount<W>; ++lane) {
      if (block.contact[lane] == kNone) continue;
      const auto points = static_cast<int>(scratch.contacts[block.contact[lane]].point_count);
      add(block.body_a[lane], block.body_b[lane], static_cast<int>(i), lane, points);
    }
  }
  for (std::size_t i = 0; i < scratch.joint_rows.size(); ++i) {
    const JointRow<D>& row = scratch.joint_rows[i];
    if (is_held(row)) add(row.body_a, row.body_b, static_cast<int>(i), -1, 1);
  }
  same = same && count == solver.held.size();
  solver.held.resize(count);
  return same;
}

/// Islands in the order of their lowest slots, their nodes in the order of the slots.
template <int D>
static void find_islands(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  const std::size_t slots = scratch.masses.size();
  solver.tree.resize(slots);
  solver.island_of.assign(slots, -1);
  for (std::uint32_t slot = 0; slot < slots; ++slot) solver.tree[slot] = slot;
  for (const HeldPair& pair : solver.held) {
    if (pair.a_moves) solver.island_of[pair.a] = 0;
    if (pair.b_moves) solver.island_of[pair.b] = 0;
    if (!pair.a_moves || !pair.b_moves) continue;
    const std::uint32_t a = root_of(solver.tree, pair.a);
    const std::uint32_t b = root_of(solver.tree, pair.b);
    solver.tree[std::max(a, b)] = std::min(a, b);
  }
  solver.islands.clear();
  for (std::uint32_t slot = 0; slot < slots; ++slot) {
    if (solver.island_of[slot] < 0) continue;
    const std::uint32_t root = root_of(solver.tree, slot);
    if (root == slot) {
      solver.island_of[slot] = static_cast<int>(solver.islands.size());
      solver.islands.emplace_back();
    }
    solver.island_of[slot] = solver.island_of[root];
    ++solver.islands[static_cast<std::size_t>(solver.island_of[root])].nodes.end;
  }
}

template <int D>
static void count_pairs(IslandSolver<D>& solver) {
  for (const HeldPair& pair : solver.held) {
    if (!pair.a_moves && !pair.b_moves) continue;
    const std::uint32_t slot = pair.a_moves ? pair.a : pair.b;
    auto& island = solver.islands[static_cast<std::size_t>(solver.island_of[slot])];
    ++island.pairs;
    island.jointed = island.jointed || pair.lane < 0;
  }
}

/// Numbers the nodes, island after island.
template <int D>
static void number_nodes(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  int next = 0;
  for (auto& island : solver.islands) {
    const int count = island.nodes.end;
    island.nodes = {next, next};
    next += count;
  }
  const auto count = static_cast<std::size_t>(next);
  solver.body_of.resize(count);
  solver.change.resize(count);
  solver.correction.resize(count);
  solver.node_of.assign(scratch.masses.size(), -1);
  for (std::uint32_t slot = 0; slot < scratch.masses.size(); ++slot) {
    if (solver.island_of[slot] < 0) continue;
    auto& island = solver.islands[static_cast<std::size_t>(solver.island_of[slot])];
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
  for (const HeldPair& pair : solver.held) {
    const int a = solver.node_of[pair.a];
    const int b = solver.node_of[pair.b];
    solver.pairs.push_back({a, b});
  }
  solver.pairs_before.reserve(solver.pairs.size());
  return solver.pairs == solver.pairs_before;
}

template <int D>
static bool is_thin(const typename IslandSolver<D>::Island& island) {
  const auto bodies = static_cast<float>(island.nodes.end - island.nodes.begin);
  return island.pairs <= static_cast<int>(kThinPairsPerBody * bodies) + kThinPairsMore;
}

/// Joins the nodes and plans each island; lets go of those that would cost too much, but for the
/// guess of what is jointed: a chain that touches itself in one tick more than in the last, when it
/// was solved at once and took a blow, would begin the sweeps with impulses that throw it away.
template <int D>
static void plan_islands(IslandSolver<D>& solver) {
  solver.matrix.begin(static_cast<int>(solver.body_of.size()));
  solver.beside.clear();
  for (const auto& [a, b] : solver.pairs)
    solver.beside.push_back(a >= 0 && b >= 0 ? solver.matrix.join(a, b) : -1);
  solver.plans.clear();
  for (const auto& island : solver.islands) {
    auto& plan = solver.plans.emplace_back();
    const std::uint64_t before = solver.matrix.products();
    plan = {false, false, {0, 0}, 0};
    if (!solver.only_thin || is_thin<D>(island))
      plan.taken = solver.matrix.analyse(island.nodes, kProductsPerPair * island.pairs, plan.steps);
    plan.weighed = !plan.taken && island.jointed;
    plan.products = static_cast<int>(solver.matrix.products() - before);
  }
}

template <int D>
static void follow_plans(IslandSolver<D>& solver) {
  for (std::size_t i = 0; i < solver.islands.size(); ++i) {
    auto& island = solver.islands[i];
    island.steps = solver.plans[i].steps;
    island.products = solver.plans[i].products;
    const bool has_groups = solver.plans[i].taken || solver.plans[i].weighed;
    for (int n = island.nodes.begin; n < island.nodes.end && !has_groups; ++n)
      solver.island_of[solver.body_of[static_cast<std::size_t>(n)]] = -1;
  }
}

/// The island of a pair, or -1 where it is left to the sweeps.
template <int D>
static int island_of(const IslandSolver<D>& solver, const HeldPair& pair) {
  if (solver.node_of[pair.a] >= 0) return solver.island_of[pair.a];
  return solver.node_of[pair.b] >= 0 ? solver.island_of[pair.b] : -1;
}

/// Where the groups of each island begin; counts of groups and joints become ranges.
template <int D>
static void place_groups(IslandSolver<D>& solver) {
  solver.held_in.clear();
  for (const HeldPair& pair : solver.held) {
    const int at = island_of(solver, pair);
    solver.held_in.push_back(at);
    if (at < 0) continue;
    auto& island = solver.islands[static_cast<std::size_t>(at)];
    island.groups.end += pair.points;
    if (pair.lane < 0) ++island.joints.end;
  }
  int next = 0;
  for (auto& island : solver.islands) {
    const int count = island.groups.end;
    island.groups = {next, next};
    next += count;
    island.joints = {next - island.joints.end, next};
  }
  solver.groups.resize(static_cast<std::size_t>(next));
  solver.sources.resize(static_cast<std::size_t>(next));
}

/// Lists the groups of rows, island after island, each with room for all the rows it may have.
template <int D>
static void list_groups(IslandSolver<D>& solver) {
  place_groups(solver);
  solver.group_of.clear();
  for (std::size_t i = 0; i < solver.held.size(); ++i) {
    const HeldPair& pair = solver.held[i];
    solver.group_of.push_back(-1);
    if (solver.held_in[i] < 0) continue;
    auto& island = solver.islands[static_cast<std::size_t>(solver.held_in[i])];
    solver.group_of.back() = island.groups.end;
    const int a = solver.node_of[pair.a];
    const int b = solver.node_of[pair.b];
    for (int point = 0; point < pair.points; ++point) {
      const auto group = static_cast<std::size_t>(island.groups.end++);
      solver.groups[group] = {a, b, solver.beside[i], 0, 0, pair.lane >= 0, 0.0, {}, {}};
      solver.sources[group] = {pair.place, pair.lane, point};
    }
  }
  int rows = 0;
  for (IslandRows<D>& group : solver.groups) {
    group.first = rows;
    rows += group.is_contact ? 1 + Dim<D>::kTangents : Dim<D>::kFreedoms;
  }
  solver.rows.resize(static_cast<std::size_t>(rows));
  solver.tensions.reserve(2 * solver.groups.size());
}

/// Whether an island is solved at once in this tick, or its guess weighed, if it is `wanted`.
template <int D>
static void begin_island(const IslandSolver<D>& solver, bool wanted, std::size_t at,
                         typename IslandSolver<D>::Island& island) {
  const bool any = wanted && island.groups.begin < island.groups.end;
  island.taken = any && solver.plans[at].taken;
  island.weighed = any && solver.plans[at].weighed;
}

/// What is each island's own in this tick: its greatest mass and inertia, and how much it may cost.
template <int D>
static void begin_islands(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  for (std::size_t at = 0; at < solver.islands.size(); ++at) {
    auto& island = solver.islands[at];
    island.products_left = std::int64_t{kProductsPerPairAndTick} * island.pairs;
    begin_island(solver, !solver.only_thin, at, island);
    island.swept = island.stirred = island.corrects = false;
    island.mass = island.inertia = 0.0f;
    for (int n = island.nodes.begin; n < island.nodes.end; ++n) {
      const BodyMass<D>& mass = scratch.masses[solver.body_of[static_cast<std::size_t>(n)]];
      island.mass = max(island.mass, 1.0f / mass.inverse_mass);
      for (int i = 0; i < Dim<D>::kSpin; ++i)
        if (const float inverse = mass.inverse_inertia.m[i * (Dim<D>::kSpin + 1)]; inverse > 0.0f)
          island.inertia = max(island.inertia, 1.0f / inverse);
    }
  }
}

/// Whether any island is to be solved, before it is planned. @pre find_islands and count_pairs.
template <int D>
static bool any_wanted(const IslandSolver<D>& solver) {
  if (!solver.only_thin) return true;
  return std::any_of(solver.loaded.begin(), solver.loaded.end(), [&](std::uint32_t slot) {
    const int at = solver.island_of[slot];
    if (at < 0) return false;
    const auto& island = solver.islands[static_cast<std::size_t>(at)];
    return island.jointed || is_thin<D>(island);
  });
}

/// Takes the islands of loaded bodies. @pre begin_islands.
template <int D>
static void take_loaded(IslandSolver<D>& solver) {
  for (const std::uint32_t slot : solver.loaded) {
    if (solver.island_of[slot] < 0) continue;
    const auto at = static_cast<std::size_t>(solver.island_of[slot]);
    begin_island(solver, true, at, solver.islands[at]);
  }
}

/// Forgets what is kept of islands where the tuning asks for other islands than it was made for.
template <int D>
static void begin_grouping(const Tuning& tuning, IslandSolver<D>& solver) {
  const bool only_thin = tuning.contact_block == ContactBlockRows::kLoadedIsland;
  if (solver.only_thin == only_thin) return;
  solver.only_thin = only_thin;
  solver.held.clear();
  solver.pairs.clear();
  solver.island_of.clear();
}

/// Sorts what touches or is jointed into islands and plans how each is solved at once. What holds
/// the same as in the tick before is sorted as it was: a cache, which changes no bit.
///
/// Reads contact blocks, joint rows, masses and which bodies are loaded; writes the island solver.
/// Serial, in the order of the colouring and of the slots.
template <int D, int W>
void group_islands(const StepContext<D>& context, StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  begin_grouping(context.tuning, solver);
  if (!list_held<D, W>(scratch)) {
    find_islands(scratch);
    count_pairs(solver);
    solver.planned = false;
  }
  solver.acts = any_wanted(solver);
  if (!solver.acts) return;
  if (!solver.planned) {
    number_nodes(scratch);
    if (!list_pairs(solver)) plan_islands(solver);
    follow_plans(solver);
    list_groups(solver);
    solver.planned = true;
  }
  begin_islands(scratch);
  take_loaded(solver);
}

template <int D, int W>
struct InstantiateGroups {
  static constexpr auto kGroup = &group_islands<D, W>;
};
template struct InstantiateGroups<2, 1>;
template struct InstantiateGroups<2, 4>;
template struct InstantiateGroups<2, 8>;
template struct InstantiateGroups<2, 16>;
template struct InstantiateGroups<2, kAvx2Lanes>;
template struct InstantiateGroups<3, 1>;
template struct InstantiateGroups<3, 4>;
template struct InstantiateGroups<3, 8>;
template struct InstantiateGroups<3, 16>;
template struct InstantiateGroups<3, kAvx2Lanes>;

}  // namespace cycloid::solver
