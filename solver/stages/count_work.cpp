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
/// Rows of a sweep, those of bodies that can turn, and those that were solved directly.
struct RowTally {
  Tally rows;
  Tally turning;
  Tally direct;
};

template <int D>
static void count_contact_rows(const WorldState<D>& state, const StepScratch<D>& scratch,
                               Range range, RowTally& tally) {
  // Most worlds have one material; then it is asked once.
  const bool one_material = state.materials.size() == 1;
  ContactRows kind{};
  if (one_material) kind = rows_between<D>(state.materials[0], state.materials[0]);
  std::uint32_t all = 0;
  std::uint32_t turning = 0;
  for (int i = range.begin; i < range.end; ++i) {
    const LiveContact<D>& live = scratch.live[static_cast<std::size_t>(i)];
    if (!one_material)
      kind = rows_between<D>(state.materials[live.material_a], state.materials[live.material_b]);
    const std::uint32_t rows = live.manifold.point_count * kind.per_point + kind.more;
    all += rows;
    if (can_turn(scratch.masses[live.body_a]) || can_turn(scratch.masses[live.body_b]))
      turning += rows;
  }
  tally.rows.add(all);
  tally.turning.add(turning);
}

template <int D>
static void count_joint_rows(const StepScratch<D>& scratch, Range range, RowTally& tally) {
  std::uint32_t all = 0;
  std::uint32_t direct = 0;
  for (int i = range.begin; i < range.end; ++i) {
    const JointRow<D>& row = scratch.joint_rows[static_cast<std::size_t>(i)];
    const int rows = (row.solved_directly ? 0 : row.rows.count) + (row.spring_enabled ? 1 : 0) +
                     (row.motor_enabled ? 1 : 0) + (row.limit_enabled ? 2 : 0) +
                     (has_cone(row) ? 1 : 0);
    all += static_cast<std::uint32_t>(rows);
    if (row.solved_directly) direct += static_cast<std::uint32_t>(row.rows.count);
  }
  tally.rows.add(all);
  tally.direct.add(direct);
}

/// Who counts first cannot be seen in the sums.
template <int D>
static void count_rows(const WorldState<D>& state, Workers& workers, const StepScratch<D>& scratch,
                       Statistics& statistics) {
  RowTally tally;
  workers.parallel_for(static_cast<int>(scratch.live.size()), kLookGrain,
                       [&](Range range) { count_contact_rows(state, scratch, range, tally); });
  workers.parallel_for(static_cast<int>(scratch.joint_rows.size()), kLookGrain,
                       [&](Range range) { count_joint_rows(scratch, range, tally); });
  statistics.rows_per_sweep = static_cast<std::uint32_t>(tally.rows.sum());
  statistics.turning_rows_per_sweep = static_cast<std::uint32_t>(tally.turning.sum());
  statistics.direct_rows = static_cast<std::uint32_t>(tally.direct.sum());
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
/// Reads everything that is counted; writes nothing.
template <int D>
Statistics count_work(const WorldState<D>& state, Workers& workers, const StepScratch<D>& scratch) {
  Statistics statistics;
  statistics.bodies = static_cast<std::uint32_t>(state.bodies.size() - state.free_bodies.size());
  statistics.pairs = static_cast<std::uint32_t>(scratch.pairs.size());
  statistics.contacts = static_cast<std::uint32_t>(state.contacts.size());
  for (int color = 0; color < kColorsMax; ++color)
    if (scratch.kept->contact_colors.sizes[color] > 0) ++statistics.colors;
  count_rows(state, workers, scratch, statistics);
  if (!scratch.lots.all.empty())
    statistics.lots = static_cast<std::uint32_t>(scratch.lots.all.size());
  statistics.flying = static_cast<std::uint32_t>(scratch.flying);
  statistics.asleep = scratch.bodies_asleep;
  return statistics;
}

template Statistics count_work(const WorldState<2>&, Workers&, const StepScratch<2>&);
template Statistics count_work(const WorldState<3>&, Workers&, const StepScratch<3>&);

}  // namespace cycloid::solver
