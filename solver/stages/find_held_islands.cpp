#include <cstring>
#include <utility>

#include "solver/constraints/joint_row.hpp"
#include "solver/stages/island_rows.hpp"
#include "solver/union_find.hpp"

namespace cycloid::solver {

/// In place of an island's number, until it has one, for what is held as the second of a pair.
static constexpr int kHeld = -2;

/// Whether the contacts are between the same bodies as when islands were found.
template <int D>
static bool are_as_found(const std::vector<MovingPair>& pairs, const IslandSolver<D>& solver) {
  if (pairs.size() != solver.found_of.size()) return false;
  return pairs.empty() ||
         std::memcmp(pairs.data(), solver.found_of.data(), pairs.size() * sizeof pairs[0]) == 0;
}

template <int D>
static MovingPair bodies_of(const JointRow<D>& row) {
  return {row.mass_a.inverse_mass > 0.0f ? row.body_a : kNone,
          row.mass_b.inverse_mass > 0.0f ? row.body_b : kNone};
}

/// A body of the pair that moves, or kNone.
static std::uint32_t mover_of(const MovingPair& pair) {
  return pair.a != kNone ? pair.a : pair.b;
}

/// Joins what holds each other, and counts of each body the pairs that it is the first of.
template <int D>
static void join_held(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  const std::size_t slots = scratch.masses.size();
  std::vector<std::uint32_t>& tree = solver.tree;
  tree.resize(slots);
  solver.island_of.assign(slots, -1);
  solver.pairs_of.assign(slots, 0);
  for (std::uint32_t slot = 0; slot < slots; ++slot) tree[slot] = slot;
  const auto join = [&](const MovingPair& pair) {
    if (mover_of(pair) == kNone) return;
    ++solver.pairs_of[mover_of(pair)];
    if (pair.a == kNone || pair.b == kNone) return;
    solver.island_of[pair.b] = kHeld;
    if (tree[pair.a] != tree[pair.b]) unite(tree, pair.a, pair.b);
  };
  for (const MovingPair& pair : scratch.kept->contact_colors.pairs) join(pair);
  for (const JointRow<D>& row : scratch.joint_rows)
    if (is_held(row)) join(bodies_of(row));
}

/// Numbers islands in the order of their lowest slots, and counts what they have.
template <int D>
static void number_islands(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  solver.islands.clear();
  for (std::uint32_t slot = 0; slot < solver.tree.size(); ++slot) {
    if (solver.island_of[slot] != kHeld && solver.pairs_of[slot] == 0) continue;
    const std::uint32_t root = root_of(solver.tree, slot);
    if (root == slot) {
      solver.island_of[slot] = static_cast<int>(solver.islands.size());
      solver.islands.emplace_back();
    }
    solver.island_of[slot] = solver.island_of[root];
    auto& island = solver.islands[static_cast<std::size_t>(solver.island_of[slot])];
    ++island.bodies;
    island.pairs += static_cast<int>(solver.pairs_of[slot]);
  }
  for (const JointRow<D>& row : scratch.joint_rows) {
    if (!is_held(row) || mover_of(bodies_of(row)) == kNone) continue;
    const int at = solver.island_of[mover_of(bodies_of(row))];
    ++solver.islands[static_cast<std::size_t>(at)].joint_count;
  }
}

template <int D>
void find_held_islands(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  const std::vector<MovingPair>& pairs = scratch.kept->contact_colors.pairs;
  const bool same_joints = std::exchange(solver.joints_as_found, true);
  if (same_joints && solver.tree.size() == scratch.masses.size() && are_as_found(pairs, solver))
    return;
  solver.found_of.assign(pairs.begin(), pairs.end());
  join_held(scratch);
  number_islands(scratch);
  solver.is_sorted = false;
}

template void find_held_islands(StepScratch<2>&);
template void find_held_islands(StepScratch<3>&);

}  // namespace cycloid::solver
