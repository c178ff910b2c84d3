#pragma once

#include <optional>

#include "bench/accuracy/chart.hpp"

namespace cycloid::rivals {

/// A run of a scene in some engine, as the states of our solver that it would be: poses and
/// velocities are the engine's, nothing of contacts and impulses is known.
template <int D>
class RivalRun {
 public:
  virtual ~RivalRun() = default;
  /// @param tick  from 1. @returns false where the run has ended before.
  virtual bool step(std::uint32_t tick) = 0;
  virtual const solver::WorldState<D>& state() const = 0;
};

/// Runs it for the chart's ticks with the rulers of our own runs: the metrics that poses and
/// velocities tell, and the verdict where the scene is a trial in which nothing happens besides.
template <int D>
accuracy::ChartPoint measure_rival(const accuracy::SceneChart& chart, RivalRun<D>& run,
                                   const accuracy::Setting& setting,
                                   accuracy::MeasureOptions options);

/// The state at tick 0 as one that knows no contacts, for a rival to write into.
template <int D>
solver::WorldState<D> without_contacts(const solver::WorldState<D>& start);

}  // namespace cycloid::rivals
