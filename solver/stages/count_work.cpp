#include "solver/constraints/contact_rolling.hpp"
#include "solver/stages/stages.hpp"
#include "solver/world.hpp"

namespace cycloid::solver {

/// Rows of a contact between two materials.
struct ContactRows {
  std::uint32_t per_point;
  std::uint32_t more;
};
template <int D>
static ContactRows rows_between(const Material& a, const Material& b) {
  const bool rubs = a.friction * b.friction > 0.0f;
  const bool rolls =
      max(a.rolling_resistance, b.rolling_resistance) > 0.0f || twist_resistance<D>(a, b) > 0.0f;
  return {1 + (rubs ? Dim<D>::kTangents : 0u), rolls ? Dim<D>::kSpin : 0u};
}

/// What the sweeps solved: rows that cannot act were not built, and are not counted.
template <int D>
static void count_rows(const WorldState<D>& state, const StepScratch<D>& scratch,
                       Statistics& statistics) {
  // Most worlds have one material; then it is asked once.
  const bool one_material = state.materials.size() == 1;
  ContactRows kind{};
  if (one_material) kind = rows_between<D>(state.materials[0], state.materials[0]);
  for (const LiveContact<D>& live : scratch.live) {
    if (!one_material)
      kind = rows_between<D>(state.materials[live.material_a], state.materials[live.material_b]);
    const std::uint32_t rows = live.manifold.point_count * kind.per_point + kind.more;
    statistics.rows_per_sweep += rows;
    if (can_turn(scratch.masses[live.body_a]) || can_turn(scratch.masses[live.body_b]))
      statistics.turning_rows_per_sweep += rows;
  }
  for (const JointRow<D>& row : scratch.joint_rows) {
    const int rows = (row.solved_directly ? 0 : row.rows.count) + (row.spring_enabled ? 1 : 0) +
                     (row.motor_enabled ? 1 : 0) + (row.limit_enabled ? 2 : 0) +
                     (has_cone(row) ? 1 : 0);
    statistics.rows_per_sweep += static_cast<std::uint32_t>(rows);
    if (row.solved_directly) statistics.direct_rows += static_cast<std::uint32_t>(row.rows.count);
  }
  const Tuning& tuning = state.header.tuning;
  statistics.substeps = scratch.substeps;
  statistics.rows = std::uint64_t{statistics.rows_per_sweep} * scratch.substeps *
                    (tuning.sweeps + tuning.relax_sweeps + tuning.position_sweeps);
  // A product of blocks has as many terms as a row and its impulse in the plane, eight times as
  // many in space: else islands at once would look cheaper than they are.
  constexpr std::uint64_t kTimesPlanar = Dim<D>::kFreedoms / Dim<2>::kFreedoms;
  if (solves_islands(tuning))
    statistics.rows +=
        scratch.islands_solved.work.products * kTimesPlanar * kTimesPlanar * kTimesPlanar;
}

/// What the tick has cost, for World::statistics.
///
/// Reads everything that is counted; writes nothing. Serial.
template <int D>
Statistics count_work(const WorldState<D>& state, const StepScratch<D>& scratch) {
  Statistics statistics;
  statistics.bodies = static_cast<std::uint32_t>(state.bodies.size() - state.free_bodies.size());
  statistics.pairs = static_cast<std::uint32_t>(scratch.pairs.size());
  statistics.contacts = static_cast<std::uint32_t>(state.contacts.size());
  for (int color = 0; color < kColorsMax; ++color)
    if (scratch.colors.sizes[color] > 0) ++statistics.colors;
  count_rows(state, scratch, statistics);
  if (!scratch.lots.all.empty())
    statistics.lots = static_cast<std::uint32_t>(scratch.lots.all.size());
  statistics.asleep = scratch.bodies_asleep;
  return statistics;
}

template Statistics count_work(const WorldState<2>&, const StepScratch<2>&);
template Statistics count_work(const WorldState<3>&, const StepScratch<3>&);

}  // namespace cycloid::solver
