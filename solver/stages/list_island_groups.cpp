#include <limits>

#include "solver/stages/island_rows.hpp"

namespace cycloid::solver {

/// Whether a pair has groups from the start of a tick: of what only the sweeps solve, just joints
/// do, whose speeds tell whether the guess of all is to be weighed.
template <int D>
static bool is_listed(const typename IslandSolver<D>::Island& island, const HeldPair& pair) {
  return island.solvable || (island.planned && pair.lane < 0);
}

/// Where the groups of each island begin; counts of groups and joints become ranges.
template <int D>
static void place_groups(IslandSolver<D>& solver) {
  for (auto& island : solver.islands) island.groups = island.joints = {0, 0};
  for (std::size_t i = 0; i < solver.held.size(); ++i) {
    if (solver.held_in[i] < 0) continue;
    const HeldPair& pair = solver.held[i];
    auto& island = solver.islands[static_cast<std::size_t>(solver.held_in[i])];
    if (!is_listed<D>(island, pair)) continue;
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

/// The groups of a pair, from `first` on; their rows are to be placed.
template <int D>
static void list_points(const HeldPair& pair, int beside, std::size_t first,
                        IslandSolver<D>& solver) {
  const int a = solver.node_of[pair.a];
  const int b = solver.node_of[pair.b];
  for (int point = 0; point < pair.points; ++point) {
    const std::size_t group = first + static_cast<std::size_t>(point);
    // Field by field: a whole record would be made on the stack first, and read before it is there.
    IslandRows<D>& rows = solver.groups[group];
    rows.node_a = a;
    rows.node_b = b;
    rows.pair = beside;
    rows.first = rows.count = rows.points = 0;
    rows.is_contact = pair.lane >= 0;
    rows.friction = 0.0;
    rows.arm_a = rows.arm_b = Vec<D, Wide>::zero();
    solver.sources[group] = {pair.place, pair.lane, point};
  }
}

/// Gives groups room for all the rows that each may have.
template <int D>
static void place_rows(IslandSolver<D>& solver) {
  std::size_t rows = 0;
  for (IslandRows<D>& group : solver.groups) {
    group.first = static_cast<int>(rows);
    rows += group.is_contact ? 1 + Dim<D>::kTangents : Dim<D>::kFreedoms;
  }
  solver.rows.resize(rows);
  solver.tensions.reserve(2 * solver.groups.size());
}

template <int D>
void list_groups(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  place_groups(solver);
  std::size_t next_pair = 0;
  for (std::size_t i = 0; i < solver.held.size(); ++i) {
    if (solver.held_in[i] < 0) continue;
    const HeldPair& pair = solver.held[i];
    auto& island = solver.islands[static_cast<std::size_t>(solver.held_in[i])];
    const int beside = island.numbered ? solver.beside[next_pair++] : -1;
    if (!is_listed<D>(island, pair)) continue;
    list_points(pair, beside, static_cast<std::size_t>(island.groups.end), solver);
    island.groups.end += pair.points;
  }
  place_rows(solver);
}

template <int D>
void find_heaviest(const StepScratch<D>& scratch, typename IslandSolver<D>::Island& island) {
  constexpr float kNoBody = std::numeric_limits<float>::infinity();
  float least_mass = kNoBody;
  float least_inertia = kNoBody;
  for (int n = island.nodes.begin; n < island.nodes.end; ++n) {
    const std::uint32_t slot = scratch.islands_solved.body_of[static_cast<std::size_t>(n)];
    const BodyMass<D>& mass = scratch.masses[slot];
    least_mass = min(least_mass, mass.inverse_mass);
    for (int i = 0; i < Dim<D>::kSpin; ++i)
      if (const float inverse = mass.inverse_inertia.m[i * (Dim<D>::kSpin + 1)]; inverse > 0.0f)
        least_inertia = min(least_inertia, inverse);
  }
  island.mass = 1.0f / least_mass;
  island.inertia = 1.0f / least_inertia;
}

/// Sorts the numbers [0, count) by island_at(number); those of no island, -1, are left out.
template <class IslandAt>
static void sort_numbers(std::size_t count, std::size_t islands, IslandAt&& island_at,
                         ByIsland& sorted) {
  sorted.first.assign(islands + 1, 0);
  for (std::size_t i = 0; i < count; ++i)
    if (const int at = island_at(i); at >= 0) ++sorted.first[static_cast<std::size_t>(at)];
  std::uint32_t end = 0;
  for (std::uint32_t& first : sorted.first) end = first += end;
  sorted.numbers.resize(end);
  for (std::size_t i = count; i-- > 0;)
    if (const int at = island_at(i); at >= 0)
      sorted.numbers[--sorted.first[static_cast<std::size_t>(at)]] = static_cast<std::uint32_t>(i);
}

template <int D>
void sort_by_island(std::size_t slots, IslandSolver<D>& solver) {
  if (solver.is_sorted) return;
  sort_numbers(
      slots, solver.islands.size(), [&](std::size_t slot) { return solver.island_of[slot]; },
      solver.slots_of);
  sort_numbers(
      solver.held.size(), solver.islands.size(),
      [&](std::size_t place) { return solver.held_in[place]; }, solver.held_of);
  solver.is_sorted = true;
}

template void list_groups(StepScratch<2>&);
template void list_groups(StepScratch<3>&);
template void find_heaviest(const StepScratch<2>&, IslandSolver<2>::Island&);
template void find_heaviest(const StepScratch<3>&, IslandSolver<3>::Island&);
template void sort_by_island(std::size_t, IslandSolver<2>&);
template void sort_by_island(std::size_t, IslandSolver<3>&);

}  // namespace cycloid::solver
