#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include "bench/trials/methods.hpp"
#include "scenes/simulation.hpp"
#include "scenes/trials.hpp"

namespace cycloid::trials {

/// @throws std::logic_error where there is none of that name.
inline const scenes::Trial& trial_named(const std::string& name) {
  for (const scenes::Trial& trial : scenes::trials())
    if (trial.name == name) return trial;
  throw std::logic_error("no trial " + name);
}

/// Before its first tick.
inline scenes::Simulation begin_scene(const scenes::Scene& scene) {
  solver::Result<scenes::Simulation> simulation = scenes::Simulation::create(scene);
  EXPECT_TRUE(simulation.ok()) << simulation.error().field;
  return std::move(simulation.value());
}

/// The scene of a trial under a method, before its first tick.
inline scenes::Simulation begin_trial(const std::string& name, const solver::Tuning& method) {
  scenes::Scene scene = trial_named(name).make();
  scene.tuning = with_method(scene.tuning, method);
  return begin_scene(scene);
}

/// Whether anything was factored in the last tick: each product of blocks counts beside the sweeps.
inline bool was_solved(const solver::Statistics& statistics, const solver::Tuning& tuning) {
  return statistics.rows > std::uint64_t{statistics.rows_per_sweep} * statistics.substeps *
                               (tuning.sweeps + tuning.relax_sweeps);
}

/// Steps a trial with other workers and lanes beside one, and compares each digest.
inline void expect_workers_and_lanes_invisible(const std::string& name,
                                               const solver::Tuning& method) {
  struct Setting {
    int workers;
    int lanes;
  };
  for (const Setting setting : {Setting{2, 4}, Setting{3, 1}, Setting{1, 8}, Setting{8, 16}}) {
    scenes::Simulation one = begin_trial(name, method);
    scenes::Simulation other = begin_trial(name, method);
    ASSERT_TRUE(one.set_lanes(4).ok());
    ASSERT_TRUE(other.set_lanes(setting.lanes).ok());
    ASSERT_TRUE(other.set_workers(setting.workers).ok());
    for (int tick = 1; tick <= 90; ++tick) {
      ASSERT_TRUE(one.step({}).ok());
      ASSERT_TRUE(other.step({}).ok());
      ASSERT_EQ(one.digest(), other.digest()) << name << ", tick " << tick << ", workers "
                                              << setting.workers << ", lanes " << setting.lanes;
      ASSERT_EQ(one.statistics().rows, other.statistics().rows) << name << ", tick " << tick;
    }
  }
}

}  // namespace cycloid::trials
