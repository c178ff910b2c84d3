#pragma once

#include "solver/step_context.hpp"
#include "solver/step_scratch.hpp"

namespace cycloid::solver {

/// The rows, tensions and velocities of an island as the warm start has left them, from blocks and
/// joint rows. @pre the arms of the blocks are of the present poses.
template <int D, int W>
void gather_island(const StepContext<D>& context, StepScratch<D>& scratch,
                   typename IslandSolver<D>::Island& island);

/// What has come of them: velocities of bodies, impulses of blocks and joint rows.
template <int D, int W>
void scatter_island(StepScratch<D>& scratch, const typename IslandSolver<D>::Island& island);

}  // namespace cycloid::solver
