#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "scenes/catalogue.hpp"
#include "scenes/generators/generators.hpp"

namespace cycloid::scenes {

static constexpr float kTick = 1.0f / 60.0f;
static constexpr std::uint16_t kJump = 1;

static Control walk_by(std::uint32_t axis, const Triple& value) {
  Control control;
  control.index = axis;
  control.effect = Effect::kWalk;
  control.target = "walker";
  control.value = value;
  return control;
}

/// A walker at x = 0 that stands on the floor y = 0, or will after a tick or two.
static Scene floor_scene() {
  Scene scene = planar_scene("floor", "");
  scene.bodies = {ground()};
  SceneCharacter walker;
  walker.name = "walker";
  walker.position = {0.0f, 0.012f, 0.0f};
  scene.characters = {walker};
  Control jump;
  jump.source = Source::kButton;
  jump.effect = Effect::kJump;
  jump.target = "walker";
  Seat seat;
  seat.controls = {walk_by(0, {1.0f, 0.0f, 0.0f}), jump};
  scene.seats = {seat};
  return scene;
}

static SceneBody fixed_box(float x, float y, float half_x, float half_y) {
  SceneBody body = body_at("", {x, y, 0.0f}, box_shape(half_x, half_y));
  body.kind = solver::BodyKind::kStatic;
  return body;
}

static Simulation started(const Scene& scene) {
  for (const Mistake& mistake : check(scene))
    ADD_FAILURE() << mistake.path << ": " << mistake.reason;
  solver::Result<Simulation> simulation = Simulation::create(scene);
  EXPECT_TRUE(simulation.ok());
  return std::move(simulation.value());
}

static CharacterPose step(Simulation& simulation, float walk, std::uint16_t buttons = 0) {
  SeatInput input;
  input.axes[0] = static_cast<std::int16_t>(32767.0f * walk);
  input.buttons = buttons;
  EXPECT_TRUE(simulation.step(std::span(&input, 1)).ok());
  return simulation.characters()[0];
}

static CharacterPose steps(Simulation& simulation, int count, float walk,
                           std::uint16_t buttons = 0) {
  for (int i = 1; i < count; ++i) step(simulation, walk, buttons);
  return step(simulation, walk, buttons);
}

TEST(Character, WalksAtItsSpeedAfterItsAcceleration) {
  Simulation simulation = started(floor_scene());
  EXPECT_TRUE(steps(simulation, 5, 0.0f).grounded);
  const CharacterPose end = steps(simulation, 60, 1.0f);
  // Six ticks of 40 m/s^2 lead to 4 m/s: (2/3) (1 + ... + 6) + 54 * 4 = 230 ticks of 1 m/s.
  EXPECT_NEAR(end.position[0], 230.0f * kTick, 0.01f * 230.0f * kTick);
  EXPECT_NEAR(end.velocity[0], 4.0f, 1.0e-4f);
  EXPECT_NEAR(end.position[1], 0.01f, 0.005f);
  // It stops as fast: 4 m/s - (2/3) k for k = 1 to 5.
  const CharacterPose stopped = steps(simulation, 30, 0.0f);
  EXPECT_NEAR(stopped.position[0] - end.position[0], 10.0f * kTick, 1.0e-3f);
  EXPECT_EQ(stopped.velocity[0], 0.0f);
}

TEST(Character, HalfAnAxisIsHalfTheSpeedAndTwoSeatsTogetherAreNoFaster) {
  Scene scene = floor_scene();
  Simulation slow = started(scene);
  EXPECT_NEAR(steps(slow, 30, 0.5f).velocity[0], 2.0f, 1.0e-3f);
  scene.seats.push_back(scene.seats[0]);
  Simulation both = started(scene);
  SeatInput full;
  full.axes[0] = 32767;
  const std::vector<SeatInput> inputs = {full, full};
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(both.step(inputs).ok());
  EXPECT_NEAR(both.characters()[0].velocity[0], 4.0f, 1.0e-4f);
}

TEST(Character, ClimbsStairsOfThirtyCentimetresAtItsPace) {
  Scene scene = floor_scene();
  for (int i = 0; i < 5; ++i)
    scene.bodies.push_back(fixed_box(11.0f + 0.4f * static_cast<float>(i),
                                     0.15f + 0.3f * static_cast<float>(i), 10.0f, 0.15f));
  Simulation simulation = started(scene);
  const CharacterPose end = steps(simulation, 90, 1.0f);
  EXPECT_NEAR(end.position[1], 1.51f, 0.01f);
  EXPECT_GT(end.position[0], 5.0f);
  EXPECT_TRUE(end.grounded);
  // One of 0.4 m is a wall.
  Scene wall = floor_scene();
  wall.bodies.push_back(fixed_box(11.0f, 0.2f, 10.0f, 0.2f));
  Simulation blocked = started(wall);
  const CharacterPose there = steps(blocked, 90, 1.0f);
  EXPECT_LT(there.position[1], 0.02f);
  EXPECT_NEAR(there.position[0], 0.69f, 0.01f);
}

TEST(Character, ClimbsARampAndIsStoppedByASteepSlope) {
  for (const bool steep : {false, true}) {
    Scene scene = floor_scene();
    const Triple top = steep ? Triple{2.0f + 2.8008f, 4.0f, 0.0f} : Triple{14.0f, 6.9282f, 0.0f};
    scene.bodies[0].shapes = {chain_shape({{-9.0f, 0.0f, 0.0f}, {2.0f, 0.0f, 0.0f}, top}, false)};
    Simulation simulation = started(scene);
    steps(simulation, 5, 0.0f);
    const CharacterPose end = steps(simulation, 120, 1.0f);
    if (steep) {
      EXPECT_LT(end.position[0], 2.0f);
      EXPECT_LT(end.position[1], 0.02f);
    } else {
      // At x = 1.92 the ramp begins to lift it, after 31.3 ticks; cos^2 of the speed goes on.
      EXPECT_NEAR(end.position[0], 1.92f + 3.0f * 88.7f * kTick, 0.03f);
      EXPECT_GT(end.position[1], 0.57f * (end.position[0] - 2.0f));
    }
    EXPECT_TRUE(end.grounded);
  }
}

TEST(Character, JumpsToTheHeightOfAParabolaAndComesBack) {
  Simulation simulation = started(floor_scene());
  const float from = steps(simulation, 5, 0.0f).position[1];
  float highest = 0.0f;
  int airborne = 0;
  for (int tick = 0; tick < 90; ++tick) {
    const CharacterPose now = step(simulation, 0.0f, kJump);  // Held: it jumps once.
    highest = std::max(highest, now.position[1] - from);
    airborne += now.grounded ? 0 : 1;
  }
  EXPECT_NEAR(highest, 1.25f, 0.03f * 1.25f);
  EXPECT_NEAR(airborne, 60, 1);
  EXPECT_TRUE(simulation.characters()[0].grounded);
  // Up again after the button was up, and not a second time in the air.
  step(simulation, 0.0f);
  EXPECT_GT(step(simulation, 0.0f, kJump).velocity[1], 4.5f);
  for (int tick = 0; tick < 20; ++tick) step(simulation, 0.0f, tick % 2 == 0 ? 0 : kJump);
  EXPECT_NEAR(simulation.characters()[0].velocity[1], 5.0f - 10.0f * 21.0f * kTick, 1.0e-3f);
}

TEST(Character, InTheAirItTurnsSlowly) {
  Simulation simulation = started(floor_scene());
  steps(simulation, 30, 1.0f);
  step(simulation, 1.0f, kJump);
  EXPECT_NEAR(steps(simulation, 12, -1.0f).velocity[0], 4.0f - 12.0f * 10.0f * kTick, 1.0e-3f);
}

TEST(Character, RidesAKinematicLiftAndAPlatform) {
  Scene scene = floor_scene();
  SceneBody lift = body_at("lift", {0.0f, -0.1f, 0.0f}, box_shape(1.0f, 0.1f));
  lift.kind = solver::BodyKind::kKinematic;
  lift.velocity = {1.0f, 1.5f, 0.0f};
  scene.bodies.push_back(lift);
  Simulation simulation = started(scene);
  const CharacterPose early = steps(simulation, 10, 0.0f);
  const Pose below = simulation.poses()[1];
  const CharacterPose late = steps(simulation, 120, 0.0f);
  const Pose now = simulation.poses()[1];
  EXPECT_NEAR(late.position[0] - early.position[0], now.position[0] - below.position[0], 1.0e-3f);
  EXPECT_NEAR(late.position[1] - early.position[1], now.position[1] - below.position[1], 0.03f);
  EXPECT_NEAR(late.position[1] - early.position[1], 3.0f, 0.03f);
  EXPECT_TRUE(late.grounded);
  EXPECT_NEAR(late.velocity[0], 1.0f, 1.0e-4f);
  // A jump keeps what the lift gave.
  EXPECT_NEAR(step(simulation, 0.0f, kJump).velocity[1], 6.5f - 10.0f * kTick, 1.0e-3f);
}

TEST(Character, PushesABoxWithItsMassAndItsForce) {
  Scene scene = floor_scene();
  scene.materials[0].friction = 0.0f;
  SceneBody box = body_at("box", {2.0f, 0.5f, 0.0f}, box_shape(0.5f, 0.5f));
  box.shapes[0].density = 40.0f;
  scene.bodies.push_back(box);
  Simulation strong = started(scene);
  const CharacterPose end = steps(strong, 120, 1.0f);
  const float pushed = strong.poses()[1].position[0];
  EXPECT_GT(pushed, 5.0f);
  EXPECT_LT(end.position[0] + 0.3f, pushed - 0.5f + 0.02f);
  EXPECT_NEAR(strong.planar()->bodies()[1].velocity[0], 4.0f, 0.2f);
  scene.characters[0].push_force_max = 60.0f;  // 1.5 m/s^2 of 40 kg.
  Simulation weak = started(scene);
  for (int tick = 0; tick < 60; ++tick) {
    const float before = weak.planar()->bodies()[1].velocity[0];
    step(weak, 1.0f);
    EXPECT_LT(weak.planar()->bodies()[1].velocity[0] - before, 1.5f * kTick + 1.0e-3f);
  }
  EXPECT_GT(weak.planar()->bodies()[1].velocity[0], 0.5f);
  scene.characters[0].push_force_max = 0.0f;
  Simulation none = started(scene);
  steps(none, 120, 1.0f);
  EXPECT_NEAR(none.poses()[1].position[0], 2.0f, 1.0e-4f);
}

TEST(Character, MeetsWhatItsFilterSays) {
  Scene scene = floor_scene();
  scene.bodies.push_back(fixed_box(2.0f, 1.0f, 0.2f, 1.0f));
  scene.bodies[1].shapes[0].filter.category = 4;
  Simulation stopped = started(scene);
  EXPECT_NEAR(steps(stopped, 60, 1.0f).position[0], 1.49f, 0.01f);
  scene.characters[0].filter.mask = ~4u;
  Simulation through = started(scene);
  EXPECT_GT(steps(through, 60, 1.0f).position[0], 3.0f);
}

/// What happened by `tick` of the course, run by its script.
static std::vector<CharacterPose> run_course(const Scene& scene, Simulation& simulation) {
  std::vector<CharacterPose> poses = simulation.characters();
  for (std::uint64_t tick = 1; tick <= 600; ++tick) {
    const SeatInput input = scripted_input(scene, 0, tick);
    EXPECT_TRUE(simulation.step(std::span(&input, 1)).ok());
    poses.push_back(simulation.characters()[0]);
  }
  return poses;
}

TEST(CharacterCourse, TheScriptPassesThroughItAll) {
  const Scene scene = character_course();
  Simulation simulation = started(scene);
  const std::vector<CharacterPose> poses = run_course(scene, simulation);
  EXPECT_LT(poses[28].position[0], -1.7f);  // At the steep slope, and not on it.
  EXPECT_GT(poses[28].position[0], -2.0f);
  EXPECT_LT(poses[28].position[1], 0.02f);
  EXPECT_GT(poses[165].position[1], 1.7f);             // Up the ramp.
  EXPECT_NEAR(poses[200].position[1], 2.642f, 0.01f);  // Up the stairs.
  EXPECT_LT(simulation.poses()[2].position[1], 0.5f);  // The box lies in the gap.
  EXPECT_GT(poses[290].position[1], 3.6f);             // Over the gap.
  EXPECT_NEAR(poses[335].position[1], 2.642f, 0.01f);
  EXPECT_NEAR(poses[375].position[0], 21.5f, 0.3f);  // On the lift, which is low,
  EXPECT_NEAR(poses[470].position[0], 21.5f, 0.3f);  // and on it when it is high.
  EXPECT_GT(poses[470].position[1], poses[375].position[1] + 1.8f);
  EXPECT_NEAR(poses[600].position[0], 25.69f, 0.01f);  // At the wall on the ledge.
  EXPECT_NEAR(poses[600].position[1], 4.642f, 0.02f);
}

TEST(CharacterCourse, RestoredAtAnyTickItGoesOnAsItDid) {
  const Scene scene = character_course();
  Simulation simulation = started(scene);
  Simulation other = started(scene);
  std::vector<Simulation::Saved> saved(601);
  std::vector<std::uint64_t> digests(601);
  std::vector<std::byte> bytes;
  const auto run = [&](Simulation& which, std::uint64_t tick) {
    const SeatInput input = scripted_input(scene, 0, tick);
    ASSERT_TRUE(which.step(std::span(&input, 1)).ok());
  };
  for (std::uint64_t tick = 1; tick <= 600; ++tick) {
    simulation.save(saved[tick - 1]);
    run(simulation, tick);
    digests[tick] = simulation.digest();
  }
  for (std::uint64_t tick = 0; tick < 600; ++tick) {
    other.restore(saved[tick]);
    for (std::uint64_t next = tick + 1; next <= std::min<std::uint64_t>(600, tick + 8); ++next) {
      run(other, next);
      ASSERT_EQ(other.digest(), digests[next]) << tick;
    }
  }
  simulation.restore(saved[250]);  // In the middle of the course, over the wire, to the end.
  simulation.encode(bytes);
  Simulation third = started(scene);
  ASSERT_TRUE(third.decode(bytes).ok());
  for (std::uint64_t tick = 251; tick <= 600; ++tick) run(third, tick);
  EXPECT_EQ(third.digest(), digests[600]);
}

TEST(CharacterCourse, InSpaceTwoCapsulesClimbPushJumpAndWanderOverHills) {
  const Scene scene = character_course_3d();
  Simulation simulation = started(scene);
  std::vector<std::array<float, 3>> climber(601);
  float lowest_wanderer = 1.0f;
  for (std::uint64_t tick = 1; tick <= 600; ++tick) {
    const SeatInput inputs[2] = {scripted_input(scene, 0, tick), scripted_input(scene, 1, tick)};
    ASSERT_TRUE(simulation.step(inputs).ok());
    const std::vector<CharacterPose> poses = simulation.characters();
    climber[tick] = poses[0].position;
    lowest_wanderer = std::min(lowest_wanderer, poses[1].position[1]);
  }
  EXPECT_NEAR(climber[60][0], -1.37f, 0.05f);  // Stopped by 55 degrees,
  EXPECT_LT(climber[60][1], 0.03f);
  EXPECT_NEAR(climber[190][1], 1.5f, 0.1f);    // up the ramp,
  EXPECT_NEAR(climber[250][1], 2.41f, 0.03f);  // and the stairs;
  EXPECT_GT(climber[600][0], 17.0f);           // over the gap, and stuck in the corner.
  EXPECT_LT(climber[600][0], 17.5f);
  EXPECT_GT(climber[600][1], 2.39f);
  EXPECT_GT(lowest_wanderer, -0.01f);
  const Simulation& end = simulation;
  EXPECT_GT(end.poses()[2].position[0], 13.0f);  // The crate went over the edge.
}

}  // namespace cycloid::scenes
