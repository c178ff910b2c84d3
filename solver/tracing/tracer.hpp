#pragma once

#include "solver/step_scratch.hpp"
#include "solver/trace.hpp"
#include "solver/tracing/records.hpp"

namespace cycloid::solver {

/// The contacts in the blocks of one lane width, each at the place of its contact.
template <int D, int W>
void read_blocks(const StepScratch<D>& scratch, std::vector<ContactWork<D>>& contacts);
template <int D>
using ReadBlocks = void (*)(const StepScratch<D>& scratch, std::vector<ContactWork<D>>& contacts);

/// The joints in lanes, each at its slot.
template <int D>
void read_pins(const StepScratch<D>& scratch, std::vector<JointWork<D>>& joints);

/// Adds to scratch.kept->trace what the phase has left. Reads and changes nothing else.
template <int D>
void observe(const TracePoint& at, const WorldState<D>& state, const StepScratch<D>& scratch,
             ReadBlocks<D> read);

/// Called by a step after each phase. Nobody traces, as a rule, and then it is one comparison.
template <int D>
struct Tracer {
  const WorldState<D>& state;
  const StepScratch<D>& scratch;
  ReadBlocks<D> read = nullptr;  ///< Needed from kPrepare to kStop.
  std::uint32_t substep = kNone;

  void operator()(Phase phase, std::uint32_t sweep = kNone) const {
    if (scratch.kept->trace != nullptr) [[unlikely]]
      observe({phase, substep, sweep}, state, scratch, read);
  }
};

}  // namespace cycloid::solver
