#include <algorithm>

#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Block products per pair of bodies that an island may take to factor once: beyond, as a net of
/// 100 x 100 pins is, it is left to the sweeps.
static constexpr int kProductsPerPair = 128;
/// The same, of all that it is factored in a tick: then it is left to the sweeps until the next. So
/// what is large may be solved when it is disturbed, and not in all rounds of every substep.
static constexpr int kProductsPerPairAndTick = 960;

/// Over the slop, the gap that counts as none. Without it every solve closes gaps of a rounding of
/// the positions, a millimetre per second of noise in each row of a stack, and the next one has to
/// stop what that set going: the pyramids under heavy apexes then cost seven times as much.
static constexpr float kTouch = 0.1f;

/// A contact or a rigid joint between the bodies of two slots.
struct HeldPair {
  std::uint32_t a;
  std::uint32_t b;
  int place;
  int lane;
  int points;
};

template <int D>
static bool holds(const JointRow<D>& row) {
  return row.rows_function != nullptr && !row.is_spring[0] && !row.is_spring[1];
}

/// Runs `visit(pair)` for every contact in the order of the colouring, then for every joint that
/// does not yield: the same order whatever the lanes.
template <int D, int W, class Visit>
static void for_each_pair(const StepScratch<D>& scratch, Visit&& visit) {
  const auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    const ContactBlock<D, W>& block = blocks[i];
    for (int lane = 0; lane < kLaneCount<W>; ++lane) {
      if (block.contact[lane] == kNone) continue;
      const auto points = static_cast<int>(scratch.contacts[block.contact[lane]].point_count);
      visit(HeldPair{block.body_a[lane], block.body_b[lane], static_cast<int>(i), lane, points});
    }
  }
  for (std::size_t i = 0; i < scratch.joint_rows.size(); ++i) {
    const JointRow<D>& row = scratch.joint_rows[i];
    if (holds(row)) visit(HeldPair{row.body_a, row.body_b, static_cast<int>(i), -1, 1});
  }
}

template <int D>
static bool moves(const StepScratch<D>& scratch, std::uint32_t slot) {
  return scratch.masses[slot].inverse_mass > 0.0f && scratch.awake[slot] != 0;
}

static std::uint32_t find_root(std::vector<std::uint32_t>& tree, std::uint32_t slot) {
  while (tree[slot] != slot) {
    tree[slot] = tree[tree[slot]];
    slot = tree[slot];
  }
  return slot;
}

/// Islands in the order of their lowest slots, their nodes in the order of the slots.
template <int D, int W>
static void find_islands(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  const std::size_t slots = scratch.masses.size();
  solver.tree.resize(slots);
  solver.island_of.assign(slots, -1);
  for (std::uint32_t slot = 0; slot < slots; ++slot) solver.tree[slot] = slot;
  for_each_pair<D, W>(scratch, [&](const HeldPair& pair) {
    const bool a_moves = moves(scratch, pair.a);
    const bool b_moves = moves(scratch, pair.b);
    if (a_moves) solver.island_of[pair.a] = 0;
    if (b_moves) solver.island_of[pair.b] = 0;
    if (!a_moves || !b_moves) return;
    const std::uint32_t a = find_root(solver.tree, pair.a);
    const std::uint32_t b = find_root(solver.tree, pair.b);
    solver.tree[std::max(a, b)] = std::min(a, b);
  });
  solver.islands.clear();
  for (std::uint32_t slot = 0; slot < slots; ++slot) {
    if (solver.island_of[slot] < 0) continue;
    const std::uint32_t root = find_root(solver.tree, slot);
    if (root == slot) {
      solver.island_of[slot] = static_cast<int>(solver.islands.size());
      solver.islands.emplace_back();
    }
    solver.island_of[slot] = solver.island_of[root];
    ++solver.islands[static_cast<std::size_t>(solver.island_of[root])].nodes.end;
  }
}

/// Numbers the nodes, island after island, and takes down their masses.
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
  solver.correction.assign(count, Vec<Dim<D>::kFreedoms, Wide>::zero());
  solver.node_of.assign(scratch.masses.size(), -1);
  for (std::uint32_t slot = 0; slot < scratch.masses.size(); ++slot) {
    if (solver.island_of[slot] < 0) continue;
    auto& island = solver.islands[static_cast<std::size_t>(solver.island_of[slot])];
    const BodyMass<D>& mass = scratch.masses[slot];
    island.mass = max(island.mass, 1.0f / mass.inverse_mass);
    for (int i = 0; i < Dim<D>::kSpin; ++i)
      if (const float inverse = mass.inverse_inertia.m[i * (Dim<D>::kSpin + 1)]; inverse > 0.0f)
        island.inertia = max(island.inertia, 1.0f / inverse);
    solver.node_of[slot] = island.nodes.end;
    solver.body_of[static_cast<std::size_t>(island.nodes.end++)] = slot;
  }
}

/// The pairs in terms of nodes, in the order of for_each_pair. @returns whether they are those of
/// the tick before, so that what was planned for them still holds.
template <int D, int W>
static bool list_pairs(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  std::swap(solver.pairs, solver.pairs_before);
  solver.pairs.clear();
  for_each_pair<D, W>(scratch, [&](const HeldPair& pair) {
    const int a = solver.node_of[pair.a];
    const int b = solver.node_of[pair.b];
    solver.pairs.push_back({a, b});
    if (a < 0 && b < 0) return;
    ++solver.islands[static_cast<std::size_t>(solver.island_of[a >= 0 ? pair.a : pair.b])].pairs;
  });
  return solver.pairs == solver.pairs_before;
}

/// Joins the nodes and plans each island; lets go of those that would cost too much.
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
    plan.taken = solver.matrix.analyse(island.nodes, kProductsPerPair * island.pairs, plan.steps);
    plan.products = static_cast<int>(solver.matrix.products() - before);
  }
}

template <int D>
static void follow_plans(IslandSolver<D>& solver) {
  for (std::size_t i = 0; i < solver.islands.size(); ++i) {
    auto& island = solver.islands[i];
    island.steps = solver.plans[i].steps;
    island.products = solver.plans[i].products;
    island.products_left = std::int64_t{kProductsPerPairAndTick} * island.pairs;
    for (int n = island.nodes.begin; n < island.nodes.end && !solver.plans[i].taken; ++n)
      solver.island_of[solver.body_of[static_cast<std::size_t>(n)]] = -1;
  }
}

/// The island of a pair, or -1 where it is left to the sweeps.
template <int D>
static int island_of(const IslandSolver<D>& solver, const HeldPair& pair) {
  if (solver.node_of[pair.a] >= 0) return solver.island_of[pair.a];
  return solver.node_of[pair.b] >= 0 ? solver.island_of[pair.b] : -1;
}

/// Lists the groups of rows, island after island.
template <int D, int W>
static void list_groups(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  for_each_pair<D, W>(scratch, [&](const HeldPair& pair) {
    const int at = island_of(solver, pair);
    if (at >= 0) solver.islands[static_cast<std::size_t>(at)].groups.end += pair.points;
  });
  int next = 0;
  for (auto& island : solver.islands) {
    const int count = island.groups.end;
    island.groups = {next, next};
    next += count;
  }
  solver.groups.resize(static_cast<std::size_t>(next));
  solver.sources.resize(static_cast<std::size_t>(next));
  std::size_t listed = 0;
  for_each_pair<D, W>(scratch, [&](const HeldPair& pair) {
    const int beside = solver.beside[listed++];
    const int at = island_of(solver, pair);
    if (at < 0) return;
    auto& island = solver.islands[static_cast<std::size_t>(at)];
    const int a = solver.node_of[pair.a];
    const int b = solver.node_of[pair.b];
    for (int point = 0; point < pair.points; ++point) {
      const auto group = static_cast<std::size_t>(island.groups.end++);
      solver.groups[group] = {a, b, beside, 0, 0, pair.lane >= 0, 0.0, {}, {}};
      solver.sources[group] = {pair.place, pair.lane, point};
    }
  });
}

/// Whether a joint has rows that only sweeps solve.
template <int D>
static bool is_swept(const JointRow<D>& row) {
  return !holds(row) || row.spring_enabled || row.motor_enabled || row.limit_enabled ||
         has_cone(row);
}

/// Whether a contact has: it bounces, or resists rolling.
template <int D, int W>
static bool is_swept(const ContactBlock<D, W>& block, int lane) {
  return block.restitution.raw[lane] > 0.0f || block.rolling.raw[lane] > 0.0f ||
         block.twist.raw[lane] > 0.0f;
}

/// Finds the islands that sweeps act on in any case, and the lanes of no island.
template <int D, int W>
static void find_swept(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  const auto sweep = [&](std::uint32_t slot) {
    if (solver.node_of[slot] >= 0 && solver.island_of[slot] >= 0)
      solver.islands[static_cast<std::size_t>(solver.island_of[slot])].swept = true;
  };
  for (const JointRow<D>& row : scratch.joint_rows) {
    if (!is_swept(row)) continue;
    sweep(row.body_a);
    sweep(row.body_b);
  }
  for_each_pair<D, W>(scratch, [&](const HeldPair& pair) {
    if (pair.lane < 0) return;
    auto& block = blocks[static_cast<std::size_t>(pair.place)];
    const int at = island_of(solver, pair);
    if (at < 0)
      block.left |= LaneBits{1} << pair.lane;
    else if (is_swept(block, pair.lane))
      solver.islands[static_cast<std::size_t>(at)].swept = true;
  });
}

/// Gives the groups their rows, contacts their friction, and takes both from the soft sweeps. What
/// bounces has to come all the way.
template <int D, int W>
static void take_rows(const StepContext<D>& context, StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  auto& blocks = std::get<ContactBlocks<D, W>>(scratch.contact_blocks).blocks;
  int rows = 0;
  for (std::size_t g = 0; g < solver.groups.size(); ++g) {
    IslandRows<D>& group = solver.groups[g];
    const auto& source = solver.sources[g];
    const auto place = static_cast<std::size_t>(source.place);
    group.first = rows;
    if (!group.is_contact) {
      scratch.joint_rows[place].in_island = true;
      scratch.joint_rows[place].solved_directly = true;
      rows += Dim<D>::kFreedoms;
      continue;
    }
    ContactBlock<D, W>& block = blocks[place];
    group.friction = static_cast<Wide>(block.friction.raw[source.lane]);
    group.count = group.friction > 0.0 ? 1 + Dim<D>::kTangents : 1;
    rows += group.count;
    if (!(block.restitution.raw[source.lane] > 0.0f)) {
      block.touch.raw[source.lane] = kTouch * context.tuning.slop;
      block.touches = true;
    }
    block.bias_rate.raw[source.lane] = 0.0f;
    block.mass_scale.raw[source.lane] = 1.0f;
    block.impulse_scale.raw[source.lane] = 0.0f;
  }
  solver.rows.resize(static_cast<std::size_t>(rows));
  solver.tensions.reserve(2 * solver.groups.size());
}

/// Sorts what touches or is jointed into islands and plans how each is solved at once.
///
/// Reads contact blocks, joint rows and masses; writes the island solver, the softness of the
/// contacts that it takes and which joint rows it takes. Serial.
template <int D, int W>
void prepare_islands(const StepContext<D>& context, StepScratch<D>& scratch) {
  if (context.tuning.contact_block != ContactBlockRows::kIsland) return;
  find_islands<D, W>(scratch);
  number_nodes(scratch);
  // A plan depends on the pairs alone: kept, it is a cache that changes no bit.
  if (!list_pairs<D, W>(scratch)) plan_islands(scratch.islands_solved);
  follow_plans(scratch.islands_solved);
  list_groups<D, W>(scratch);
  find_swept<D, W>(scratch);
  take_rows<D, W>(context, scratch);
  scratch.islands_solved.work = {};
}

template <int D, int W>
struct InstantiatePlans {
  static constexpr auto kPrepare = &prepare_islands<D, W>;
};
template struct InstantiatePlans<2, 1>;
template struct InstantiatePlans<2, 4>;
template struct InstantiatePlans<2, 8>;
template struct InstantiatePlans<2, 16>;
template struct InstantiatePlans<2, kAvx2Lanes>;
template struct InstantiatePlans<3, 1>;
template struct InstantiatePlans<3, 4>;
template struct InstantiatePlans<3, 8>;
template struct InstantiatePlans<3, 16>;
template struct InstantiatePlans<3, kAvx2Lanes>;

}  // namespace cycloid::solver
