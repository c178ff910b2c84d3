#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "bench/trials/methods.hpp"
#include "scenes/catalogue.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::trials {

/// Inputs that change at any tick, as people's do: each seat turns round about every 40 ticks,
/// jumps or drops a box about every 60, and lets go soon after.
static void change_inputs(std::mt19937& random, std::vector<scenes::SeatInput>& inputs) {
  for (scenes::SeatInput& input : inputs) {
    if (random() % 40 == 0) input.axes[0] = (random() & 1) != 0 ? 20000 : -20000;
    if (random() % 60 == 0)
      input.buttons = random() % 5 != 0 ? 1 : 3;
    else if (random() % 6 == 0)
      input.buttons = 0;
  }
}

/// The same of any scene: every axis is pushed about every 40 ticks, some of three buttons are
/// held about every 30 and let go soon after.
static void push_all(std::mt19937& random, std::vector<scenes::SeatInput>& inputs) {
  for (scenes::SeatInput& input : inputs) {
    for (std::int16_t& axis : input.axes)
      if (random() % 40 == 0)
        axis = static_cast<std::int16_t>(static_cast<int>(random() % 65535) - 32767);
    if (random() % 30 == 0)
      input.buttons = random() % 8;
    else if (random() % 6 == 0)
      input.buttons = 0;
  }
}

static std::vector<std::string> names() {
  std::vector<std::string> names;
  for (const Method& method : methods()) names.emplace_back(method.name);
  return names;
}

static const solver::Tuning& tuning_of(const std::string& name) {
  const auto found = std::find_if(methods().begin(), methods().end(),
                                  [&](const Method& method) { return method.name == name; });
  return found->tuning;
}

static std::string name_without_hyphens(const testing::TestParamInfo<std::string>& method) {
  std::string name = method.param;
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

/// A number of the environment, which `./dev rooms` sets to play longer.
static int wanted(const char* name, int otherwise) {
  const char* text = std::getenv(name);
  return text == nullptr ? otherwise : std::stoi(text);
}

using ChangeInputs = void (*)(std::mt19937&, std::vector<scenes::SeatInput>&);

/// Steps a scene under random inputs and fails where its world faults.
static void play(const scenes::Scene& scene, ChangeInputs change, int seed, int ticks) {
  solver::Result<scenes::Simulation> simulation = scenes::Simulation::create(scene);
  ASSERT_TRUE(simulation.ok()) << simulation.error().field;
  std::mt19937 random(static_cast<unsigned>(seed));
  std::vector<scenes::SeatInput> inputs(simulation.value().seats());
  for (int tick = 1; tick <= ticks; ++tick) {
    change(random, inputs);
    const solver::Error error = simulation.value().step(inputs);
    ASSERT_TRUE(error.ok()) << "seed " << seed << ", tick " << tick << ": " << error.field;
  }
}

class PlayedRooms : public testing::TestWithParam<std::string> {};

/// A trial is a scene that somebody thought of. What eight players wedge, throw and drop in a room
/// of joints and of things that bounce, nobody does: no body may leave the bounds of the world.
TEST_P(PlayedRooms, NoWorldFaults) {
  const int rooms = wanted("CYCLOID_PLAYED_ROOMS", 8);
  const int ticks = wanted("CYCLOID_PLAYED_TICKS", 1800);
  scenes::Scene scene = *scenes::find("room:bodies=64").scene;
  scene.tuning = with_method(scene.tuning, tuning_of(GetParam()));
  for (int room = 1; room <= rooms; ++room) play(scene, change_inputs, room, ticks);
}

INSTANTIATE_TEST_SUITE_P(Methods, PlayedRooms, testing::ValuesIn(names()), name_without_hyphens);

class PlayedChain : public testing::TestWithParam<std::string> {};

/// A seat that swings four tonnes up until the chain of light links hangs slack, whips and lies
/// jammed on itself, and lets them fall into it.
TEST_P(PlayedChain, NoWorldFaults) {
  scenes::Scene scene = *scenes::find("chain-and-ball").scene;
  scene.tuning = with_method(scene.tuning, tuning_of(GetParam()));
  for (int seed = 1; seed <= 6; ++seed) play(scene, push_all, seed, 12000);
}

INSTANTIATE_TEST_SUITE_P(Methods, PlayedChain,
                         testing::Values("soft-step", "soft-loaded", "soft-direct", "soft-islands"),
                         name_without_hyphens);

// A chain that whips is solved at once in one tick and swept, with its guess weighed, in the next.
TEST(PlayedChainDigests, HaveNoTraceOfLanesAndRestoring) {
  scenes::Scene scene = *scenes::find("chain-and-ball").scene;
  scene.tuning = with_method(scene.tuning, solver::Tuning::soft_loaded());
  scenes::Simulation one = std::move(scenes::Simulation::create(scene).value());
  scenes::Simulation other = std::move(scenes::Simulation::create(scene).value());
  ASSERT_TRUE(one.set_lanes(4).ok());
  ASSERT_TRUE(other.set_lanes(8).ok());
  std::mt19937 random(3);
  std::vector<scenes::SeatInput> inputs(one.seats());
  scenes::Simulation::Saved saved;
  for (int tick = 1; tick <= 4000; ++tick) {
    push_all(random, inputs);
    if (tick % 7 == 0) {
      one.save(saved);
      other.restore(saved);
    }
    ASSERT_TRUE(one.step(inputs).ok());
    ASSERT_TRUE(other.step(inputs).ok());
    ASSERT_EQ(one.digest(), other.digest()) << "tick " << tick;
  }
}

class PlayedScene : public testing::TestWithParam<std::string> {};

TEST_P(PlayedScene, DoesNotFault) {
  play(*scenes::find(GetParam()).scene, push_all, 1, 1200);
}

static std::vector<std::string> scenes_with_seats() {
  std::vector<std::string> names;
  for (const auto& entry : scenes::catalogue())
    if (!scenes::find(entry.name).scene->seats.empty()) names.emplace_back(entry.name);
  return names;
}

INSTANTIATE_TEST_SUITE_P(Catalogue, PlayedScene, testing::ValuesIn(scenes_with_seats()),
                         name_without_hyphens);

}  // namespace cycloid::trials
