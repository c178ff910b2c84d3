#include "scenes/stage_profile.hpp"

namespace cycloid::scenes {

void StageProfile::end_phase(void* self, const solver::TracePoint& at) {
  StageProfile& profile = *static_cast<StageProfile*>(self);
  Stage& stage = profile.stages_[static_cast<std::size_t>(at.phase)];
  const std::uint64_t now_ns = profile.clock_();
  stage.time_ns += now_ns - profile.last_ns_;
  ++stage.calls;
  profile.last_ns_ = now_ns;
}

solver::Error StageProfile::step(Simulation& simulation, std::span<const SeatInput> inputs) {
  solver::StepTrace trace;
  trace.listener = end_phase;
  trace.listener_user = this;
  const std::uint64_t start_ns = clock_();
  last_ns_ = start_ns;
  const solver::Error error = simulation.step_traced(inputs, trace);
  const std::uint64_t end_ns = clock_();
  rest_ns_ += end_ns - last_ns_;
  total_ns_ += end_ns - start_ns;
  ++steps_;
  return error;
}

}  // namespace cycloid::scenes
