#include "solver/constraints/single_lanes.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// As fast as the bodies of a calm island are at most, m/s and rad/s, along any axis. Thirty boxes
/// that stand sway at half of it; what rocks is faster, and comes to rest by the impulses of its
/// blows.
static constexpr Wide kCalm = 0.01;
/// As fast as one of them is where it sways: slower ones miss no more than what roundings do.
static constexpr Wide kSways = 5.0e-4;

/// Takes down with which velocities the bodies of an island begin. @returns the greatest along any
/// axis, m/s or rad/s.
template <int D>
static float note_velocities(const typename IslandSolver<D>::Island& island,
                             StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  Lanes<4> most[kVelocityQuads<D>];
  for (Lanes<4>& of_quad : most) of_quad = 0.0f;
  for (int n = island.nodes.begin; n < island.nodes.end; ++n) {
    const auto node = static_cast<std::size_t>(n);
    const Motion<D>& motion = scratch.motions[solver.body_of[node]];
    for (int quad = 0; quad < kVelocityQuads<D>; ++quad) {
      const Lanes<4> numbers(load_quad(motion, quad));
      numbers.store(solver.before[node].numbers + 4 * quad);
      most[quad] = max(most[quad], max(numbers, -numbers));
    }
  }
  float greatest = 0.0f;  // Behind the velocity there is more of the motion.
  for (int i = 0; i < Dim<D>::kFreedoms; ++i) greatest = max(greatest, lane_of(most[i / 4], i % 4));
  return greatest;
}

/// Sees which islands are calm before forces act on them: for these a solve leaves a guess of their
/// load alone (IslandSolver::keep_load), and those of them that sway are held to less (kRest).
///
/// Reads velocities; writes those of islands of contacts alone into the island solver, and which
/// are calm or sway. Serial; no body is of two islands.
template <int D>
void watch_islands(StepScratch<D>& scratch) {
  IslandSolver<D>& solver = scratch.islands_solved;
  if (!solver.acts) return;
  solver.before.resize(solver.body_of.size());
  for (auto& island : solver.islands) {
    island.calm = island.sways = false;
    if (!island.taken || island.joint_count > 0) continue;
    const auto fastest = static_cast<Wide>(note_velocities(island, scratch));
    island.calm = fastest < kCalm;
    island.sways = island.calm && fastest > kSways;
  }
}

template void watch_islands(StepScratch<2>&);
template void watch_islands(StepScratch<3>&);

}  // namespace cycloid::solver
