#pragma once

#include <array>

#include "scenes/simulation.hpp"
#include "solver/trace.hpp"

namespace cycloid::scenes {

/// Where the time of a simulation's steps goes, phase by phase. On request only: a clock read after
/// every phase is a tenth of the step of a small world. Changes no bit.
class StageProfile {
 public:
  using Clock = Simulation::Clock;

  struct Stage {
    std::uint64_t time_ns = 0;
    std::uint64_t calls = 0;
  };

  explicit StageProfile(Clock clock) : clock_(clock) {}

  /// `simulation.step(inputs)` with the clock read after every phase.
  solver::Error step(Simulation& simulation, std::span<const SeatInput> inputs);

  /// Of all steps together. kForces holds what comes before the first phase, controls among it.
  const Stage& stage(solver::Phase phase) const { return stages_[static_cast<std::size_t>(phase)]; }
  /// After the last phase: statistics of the step.
  std::uint64_t rest_ns() const { return rest_ns_; }
  std::uint64_t total_ns() const { return total_ns_; }
  std::uint64_t steps() const { return steps_; }

 private:
  static void end_phase(void* self, const solver::TracePoint& at);

  Clock clock_;
  std::uint64_t last_ns_ = 0;
  std::array<Stage, solver::kPhases> stages_{};
  std::uint64_t rest_ns_ = 0;
  std::uint64_t total_ns_ = 0;
  std::uint64_t steps_ = 0;
};

}  // namespace cycloid::scenes
