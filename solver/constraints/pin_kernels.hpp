#pragma once

#include "solver/constraints/pin_block.hpp"
#include "solver/step_context.hpp"

namespace cycloid::solver {

/// The blocks of a range and the motions that they gather. No two of the blocks share a body that
/// moves.
template <int D, int W>
struct PinRange {
  PinBlock<D, W>* begin;
  PinBlock<D, W>* end;
  Motion<D>* motions;  ///< By body slot.
};

/// What an equality may miss, m/s or rad/s (solve_islands).
struct JointBounds {
  float misses;   ///< Of an island that was at rest.
  float stirs;    ///< Of one that was not.
  float is_wild;  ///< Of one that the sweeps have.
};

/// What is done to pins in lanes, compiled for each width as ContactKernels are: pin_kernels*.cpp,
/// from one text (pin_sweeps.hpp).
template <int D, int W>
struct PinKernels {
  /// C, J and K^-1 at the present poses (evaluate_rows).
  /// @param limit_reach_s  How far ahead in time a limit is near.
  static void evaluate(float limit_reach_s, const PinRange<D, W>& range);
  /// v += M^-1 J^T lambda, of as much of lambda as turns no body faster than `spin_max`, rad/s.
  static void warm_start(float spin_max, const PinRange<D, W>& range);
  /// The same of the equalities alone.
  static void warm_start_equalities(const PinRange<D, W>& range);
  /// Which lanes have an equality that misses more than each bound.
  static void look_for_rest(const StepContext<D>& context, const JointBounds& bounds,
                            const PinRange<D, W>& range);
  /// One sweep of sequential impulses. @pre the sweep is none of pseudo-velocities.
  static void sweep(const StepContext<D>& context, Sweep kind, const PinRange<D, W>& range);
};

}  // namespace cycloid::solver
