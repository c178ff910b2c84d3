#pragma once

#include <gtest/gtest.h>

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

/// The scene of a trial under a method, before its first tick.
inline scenes::Simulation begin_trial(const std::string& name, const solver::Tuning& method) {
  scenes::Scene scene = trial_named(name).make();
  scene.tuning = with_method(scene.tuning, method);
  solver::Result<scenes::Simulation> simulation = scenes::Simulation::create(scene);
  EXPECT_TRUE(simulation.ok()) << simulation.error().field;
  return std::move(simulation.value());
}

}  // namespace cycloid::trials
