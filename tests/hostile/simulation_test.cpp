#include <gtest/gtest.h>

#include "tests/hostile/matches.hpp"
#include "tests/hostile/snapshot_checks.hpp"

namespace cycloid::hostile {
namespace {

scenes::Simulation simulation_of(const scenes::Scene& scene) {
  return std::move(scenes::Simulation::create(scene).value());
}

solver::World<2>& world_of(scenes::Simulation& simulation, solver::World<2>*) {
  return *simulation.planar();
}
solver::World<3>& world_of(scenes::Simulation& simulation, solver::World<3>*) {
  return *simulation.spatial();
}

std::vector<scenes::SeatInput> everything_pressed(const scenes::Simulation& simulation) {
  return std::vector<scenes::SeatInput>(static_cast<std::size_t>(simulation.seats()),
                                        {{32767, -32768, 1, 0}, 0xffff});
}

/// Decodes into a fresh simulation of the scene; the complaint is "" where all is well.
std::string judged(const scenes::Scene& scene, std::span<const std::byte> bytes, bool& accepted) {
  scenes::Simulation target = simulation_of(scene);
  const std::uint64_t before = target.digest();
  const solver::Error error = target.decode(bytes);
  accepted = error.ok();
  if (!accepted) {
    if (error.code != solver::Code::kCorrupt) return "refused, but not as corrupt";
    return target.digest() == before ? "" : "refused, and changed";
  }
  // Buttons held, then all pressed at once, so that every control acts.
  std::vector<scenes::SeatInput> inputs = everything_pressed(target);
  for (int tick = 0; tick < 10; ++tick) {
    for (scenes::SeatInput& input : inputs) input.buttons = tick % 2 == 0 ? 0 : 0xffff;
    const solver::Error stepped = target.step(inputs);
    if (stepped.code == solver::Code::kFaulted) break;
    if (!stepped.ok()) return std::string("a step returns ") + stepped.field;
  }
  Encoded again;
  target.encode(again);
  scenes::Simulation copy = simulation_of(scene);
  if (!copy.decode(again).ok()) return "what it became is refused";
  return copy.digest() == target.digest() ? "" : "what it became is another state when decoded";
}

template <int D>
void expect_every_register_checked(const std::string& name) {
  const scenes::Scene scene = catalogue_scene(name);
  scenes::Simulation played = simulation_of(scene);
  std::vector<scenes::SeatInput> inputs = everything_pressed(played);
  for (int tick = 0; tick < 20; ++tick) {
    for (scenes::SeatInput& input : inputs) input.buttons = tick % 2 == 0 ? 0 : 0xffff;
    ASSERT_TRUE(played.step(inputs).ok());
  }
  solver::World<D>* none = nullptr;
  const solver::WorldState<D> state = world_of(played, none).state();
  ASSERT_GT(state.registers.size(), 0u);
  int refused = 0;
  for (std::size_t i = 0; i < state.registers.size(); ++i)
    for (const std::uint32_t bits : extremes()) {
      solver::WorldState<D> damaged = state;
      damaged.registers[i] = bits;
      solver::World<D> world = std::move(solver::World<D>::create({}).value());
      world.restore(damaged);
      bool accepted = false;
      EXPECT_EQ(judged(scene, encoded(world), accepted), "") << "register " << i << ": " << bits;
      refused += accepted ? 0 : 1;
    }
  for (const std::size_t count : {std::size_t{0}, state.registers.size() + 1}) {
    solver::WorldState<D> damaged = state;
    damaged.registers.resize(count);
    solver::World<D> world = std::move(solver::World<D>::create({}).value());
    world.restore(damaged);
    bool accepted = true;
    EXPECT_EQ(judged(scene, encoded(world), accepted), "");
    EXPECT_FALSE(accepted);
  }
  EXPECT_GT(refused, 0) << "no register of this scene has a range";
}

TEST(HostileSimulation, RegistersOutOfRangeAreRefusedOrHarmless) {
  expect_every_register_checked<2>("stack-10");
  expect_every_register_checked<3>("ball-pit-3d");
  expect_every_register_checked<2>("character-course");
  expect_every_register_checked<3>("character-course-3d");
}

TEST(HostileSimulation, EveryFlipOfASceneWithCharactersIsRefusedOrSteps) {
  const scenes::Scene scene = catalogue_scene("character-course");
  scenes::Simulation played = simulation_of(scene);
  Encoded bytes;
  played.encode(bytes);
  // One bit of every byte, another one in each.
  for (std::size_t byte = 0; byte < bytes.size(); ++byte) {
    const auto mask = static_cast<std::byte>(1u << (byte * 5 % 8));
    bytes[byte] ^= mask;
    bool accepted = false;
    ASSERT_EQ(judged(scene, bytes, accepted), "") << byte;
    bytes[byte] ^= mask;
  }
}

/// Both forms leave out what equals its default, so -0 came back as 0: a log of such a scene, or a
/// client with its export, had another scene's digest.
TEST(HostileSimulation, ASceneWithNegativeZerosIsTheSameFromEitherForm) {
  scenes::Scene scene = catalogue_scene("vehicle");
  scene.joints.at(0).motor_speed = -0.0f;
  scene.bodies.at(0).position[0] = -0.0f;
  std::string text = scenes::to_json(scene);
  const std::string field = "\"motor_max\"";
  ASSERT_NE(text.find(field), std::string::npos);
  text.insert(text.find(field), "\"target\":-0.0,");
  const scenes::Scene read = std::move(*scenes::from_json(text).scene);
  const std::uint64_t digest = scenes::scene_digest(read);
  EXPECT_EQ(scenes::scene_digest(*scenes::from_json(scenes::to_json(read)).scene), digest);
  EXPECT_EQ(scenes::scene_digest(*scenes::from_binary(scenes::to_binary(read)).scene), digest);
  EXPECT_EQ(scenes::scene_digest(*scenes::from_binary(scenes::to_binary(scene)).scene), digest);
}

/// A scene that can run has to be one that late clients can join: its snapshots are good.
TEST(HostileSimulation, AnUnknownCurveOfAJointWithoutCurvesIsNoScene) {
  scenes::Scene scene = catalogue_scene("vehicle");
  ASSERT_FALSE(scene.joints.empty());
  ASSERT_NE(scene.joints[0].kind, solver::JointKind::kCurve);
  scene.joints[0].curve = static_cast<solver::CurveKind>(4);
  EXPECT_FALSE(scenes::check(scene).empty());
}

}  // namespace
}  // namespace cycloid::hostile
