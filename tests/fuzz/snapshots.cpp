#include "tests/fuzz/targets.hpp"
#include "tests/hostile/snapshot_checks.hpp"
#include "tests/hostile/worlds.hpp"

namespace cycloid::fuzz {

template <int D>
static const Seed& good_snapshot() {
  static const Seed kGood = hostile::encoded(hostile::small_sample<D>());
  return kGood;
}

/// An input can ask for no more than this many sweeps, so that a run stays short; that more are
/// bounded too is a matter of the tests.
template <int D>
static bool is_cheap(const solver::WorldState<D>& state) {
  const solver::Tuning& tuning = state.header.tuning;
  const std::uint32_t sweeps = tuning.sweeps + tuning.relax_sweeps + tuning.position_sweeps;
  return tuning.substeps * sweeps <= 256 &&
         tuning.particle_substeps * tuning.particle_sweeps <= 256;
}

template <int D>
static void run_snapshot(Input input) {
  const unsigned mode = mode_of(input);
  const Seed bytes =
      mode % 2 == kRawMode ? Seed(input.begin(), input.end()) : edited(good_snapshot<D>(), input);
  solver::World<D> probe = hostile::checked(solver::World<D>::create({}));
  if (probe.decode(bytes).ok() && !is_cheap(probe.state())) return;
  solver::World<D> world = hostile::checked(solver::World<D>::create({}));
  const hostile::Verdict verdict = hostile::try_snapshot<D>(bytes, 3, world);
  if (!verdict.complaint.empty()) fail(verdict.complaint);
}

template <int D>
static std::vector<Seed> snapshot_seeds() {
  return {with_mode(kRawMode, good_snapshot<D>()),
          with_mode(kEditMode, std::vector<std::byte>(24, std::byte{1}))};
}

void run_planar_snapshot(Input input) {
  run_snapshot<2>(input);
}
void run_spatial_snapshot(Input input) {
  run_snapshot<3>(input);
}
std::vector<Seed> planar_snapshot_seeds() {
  return snapshot_seeds<2>();
}
std::vector<Seed> spatial_snapshot_seeds() {
  return snapshot_seeds<3>();
}

}  // namespace cycloid::fuzz
