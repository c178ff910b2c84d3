#include "solver/trace.hpp"

#include <gtest/gtest.h>

#include "scenes/catalogue.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::scenes {
namespace {

Simulation start(const Scene& scene, int workers, int lanes) {
  solver::Result<Simulation> simulation = Simulation::create(scene);
  EXPECT_TRUE(simulation.ok()) << simulation.error().field;
  EXPECT_TRUE(simulation.value().set_workers(workers).ok());
  EXPECT_TRUE(simulation.value().set_lanes(lanes).ok());
  return std::move(simulation.value());
}

std::vector<SeatInput> inputs_of(const Scene& scene, const Simulation& simulation) {
  std::vector<SeatInput> inputs;
  for (int seat = 0; seat < simulation.seats(); ++seat)
    inputs.push_back(scripted_input(scene, seat, simulation.tick() + 1));
  return inputs;
}

/// "sweep, substep 1, sweep 0: contact 7 points[0].normal_mass ..." of the first difference, or "".
std::string first_traced_difference(const solver::StepTrace& a, const solver::StepTrace& b) {
  if (a.phases.size() != b.phases.size()) return "another number of phases";
  for (std::size_t i = 0; i < a.phases.size(); ++i) {
    const solver::TracedPhase& one = a.phases[i];
    const solver::TracedPhase& other = b.phases[i];
    if (one == other) continue;
    std::string text = std::string(solver::phase_name(one.at.phase)) + ", substep " +
                       std::to_string(one.at.substep) + ", sweep " + std::to_string(one.at.sweep);
    for (std::size_t j = 0; j < std::min(one.objects.size(), other.objects.size()); ++j)
      if (one.objects[j] != other.objects[j]) return text + ": " + one.objects[j].name;
    return text;
  }
  return "";
}

class Traced : public testing::TestWithParam<std::string> {};

TEST_P(Traced, PhasesAreTheSameAtEveryLaneWidthAndWorkerCount) {
  struct Setting {
    int workers;
    int lanes;
  };
  const Scene scene = *find(GetParam()).scene;
  Simulation one = start(scene, 1, 4);
  for (const Setting setting : {Setting{1, 16}, Setting{3, 4}, Setting{3, 1}}) {
    Simulation reference = start(scene, 1, 4);
    Simulation other = start(scene, setting.workers, setting.lanes);
    for (int tick = 1; tick <= 24; ++tick) {
      solver::StepTrace expected;
      solver::StepTrace found;
      expected.wants_objects = found.wants_objects = true;
      const std::vector<SeatInput> inputs = inputs_of(scene, reference);
      ASSERT_TRUE(reference.step_traced(inputs, expected).ok());
      ASSERT_TRUE(other.step_traced(inputs, found).ok());
      ASSERT_EQ(first_traced_difference(expected, found), "")
          << "tick " << tick << ", workers " << setting.workers << ", lanes " << setting.lanes;
      ASSERT_GT(expected.phases.size(), 10u);
    }
  }
}

TEST_P(Traced, StepsAreThoseOfAWorldThatNobodyTraces) {
  const Scene scene = *find(GetParam()).scene;
  Simulation plain = start(scene, 1, 4);
  Simulation traced = start(scene, 1, 4);
  for (int tick = 1; tick <= 60; ++tick) {
    solver::StepTrace trace;
    const std::vector<SeatInput> inputs = inputs_of(scene, plain);
    ASSERT_TRUE(plain.step(inputs).ok());
    ASSERT_TRUE(traced.step_traced(inputs, trace).ok());
    ASSERT_EQ(plain.digest(), traced.digest()) << "tick " << tick;
  }
}

std::vector<std::string> scene_names() {
  std::vector<std::string> names;
  for (const CatalogueEntry& entry : catalogue()) names.push_back(entry.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Scenes, Traced, testing::ValuesIn(scene_names()), [](const auto& scene) {
  std::string name = scene.param;
  for (char& letter : name)
    if (letter == '-') letter = '_';
  return name;
});

}  // namespace
}  // namespace cycloid::scenes
