#pragma once

#include "solver/step_context.hpp"
#include "solver/step_scratch.hpp"

namespace cycloid::solver {

/// Stiffness of a row over the greatest mass of its island: what a load leaves of its impulse to
/// the next substep is a thousandth.
inline constexpr float kStiffness = 1.0e3f;

template <int N>
Vec<N, Wide> widened(const Vec<N>& v) {
  Vec<N, Wide> wide;
  for (int i = 0; i < N; ++i) wide[i] = static_cast<Wide>(v[i]);
  return wide;
}

/// Speed of the point of a body at `arm`, m/s.
template <int D>
Vec<D, Wide> speed_at(const Motion<D>& motion, const Vec<D, Wide>& arm) {
  return widened(motion.velocity) + spin_cross(widened(motion.spin), arm);
}

template <int D>
bool is_moving(const Motion<D>& motion) {
  return dot(motion.velocity, motion.velocity) + dot(motion.spin, motion.spin) > 0.0f;
}

/// Finds the islands of what holds: contacts, and joints that do not yield; how many bodies, pairs
/// and joints each has, of what massive bodies hold. Where all is between the same bodies as it was
/// when they were last found, they stand as they are.
template <int D>
void find_held_islands(StepScratch<D>& scratch);

/// Takes down what holds: every contact in the order of the colouring, which is the same whatever
/// the lanes, then every joint that does not yield. @returns whether it is what held before, in a
/// world of as many slots, so that all that was made of it still stands.
template <int D, int W>
bool list_held(Workers& workers, StepScratch<D>& scratch);

/// Lists the groups of rows of what is solvable, island after island, and of what is only weighed
/// just the joints. @pre islands are planned.
template <int D>
void list_groups(StepScratch<D>& scratch);

/// Sorts the slots, and the places of what holds, by island, unless they are sorted already.
template <int D>
void sort_by_island(std::size_t slots, IslandSolver<D>& solver);

/// Writes the greatest mass and inertia of an island's nodes.
template <int D>
void find_heaviest(const StepScratch<D>& scratch, typename IslandSolver<D>::Island& island);

/// The rows and tensions of an island's joints as the warm start has left them: of the point that
/// one holds along the axes of the world. And back the impulses that have come of them.
template <int D>
void gather_joints(const StepContext<D>& context, StepScratch<D>& scratch,
                   const typename IslandSolver<D>::Island& island);
template <int D>
void scatter_joints(StepScratch<D>& scratch, const typename IslandSolver<D>::Island& island);

/// The rows, tensions and velocities of an island as the warm start has left them, from blocks and
/// joint rows; what stands on ground that moves is not calm. @pre the arms of the blocks are of the
/// present poses.
template <int D, int W>
void gather_island(const StepContext<D>& context, StepScratch<D>& scratch,
                   typename IslandSolver<D>::Island& island);

/// What has come of them: velocities of bodies, impulses of blocks and joint rows.
template <int D, int W>
void scatter_island(StepScratch<D>& scratch, const typename IslandSolver<D>::Island& island);

}  // namespace cycloid::solver
