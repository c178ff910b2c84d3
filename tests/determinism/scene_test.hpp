#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scenes/catalogue.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::history {

using scenes::Scene;
using scenes::SeatInput;
using scenes::Simulation;

/// A test that is made for every scene of the catalogue, with its own script.
class SceneTest : public testing::TestWithParam<std::string> {
 protected:
  Scene scene() const { return std::move(*scenes::find(GetParam()).scene); }
};

inline std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const scenes::CatalogueEntry& entry : scenes::catalogue()) names.push_back(entry.name);
  return names;
}

inline std::string scene_test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

inline Simulation begin(const Scene& scene) {
  solver::Result<Simulation> simulation = Simulation::create(scene);
  EXPECT_TRUE(simulation.ok()) << simulation.error().field;
  return std::move(simulation.value());
}

/// What the script lets every seat say for the coming tick.
inline std::vector<SeatInput> scripted(const Scene& scene, const Simulation& simulation) {
  std::vector<SeatInput> inputs;
  for (int seat = 0; seat < simulation.seats(); ++seat)
    inputs.push_back(scenes::scripted_input(scene, seat, simulation.tick() + 1));
  return inputs;
}

inline void play(const Scene& scene, Simulation& simulation, std::uint64_t ticks = 1) {
  for (std::uint64_t i = 0; i < ticks; ++i) {
    const solver::Error error = simulation.step(scripted(scene, simulation));
    ASSERT_TRUE(error.ok()) << error.field << " at tick " << simulation.tick() + 1;
  }
}

/// The first field in which two runs of one scene differ, for the message of a failure.
inline std::string first_difference(const Simulation& one, const Simulation& other) {
  for (const solver::Difference& at : one.differences(other, 1))
    return at.object + " " + at.field + ": " + at.value_a + " and " + at.value_b;
  return "equal to the bit";
}

/// Workers and lanes of one run; they may not show.
inline void set_up(Simulation& simulation, int workers, int lanes) {
  ASSERT_TRUE(simulation.set_workers(workers).ok());
  const solver::Error error = simulation.planar() != nullptr
                                  ? simulation.planar()->set_lanes(lanes)
                                  : simulation.spatial()->set_lanes(lanes);
  ASSERT_TRUE(error.ok()) << error.field;
}

}  // namespace cycloid::history
