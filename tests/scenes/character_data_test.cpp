#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <functional>

#include "scenes/characters.hpp"
#include "scenes/controls.hpp"
#include "scenes/generators/generators.hpp"

namespace cycloid::scenes {

/// No field of the character has its default.
static Scene full_scene() {
  Scene scene = planar_scene("full", "");
  scene.dimension = 3;  // The plane has no third numbers.
  scene.bodies = {ground()};
  SceneCharacter c;
  c.name = "walker";
  c.position = {1.0f, 2.0f, 3.0f};
  c.lower = {0.1f, 0.4f, 0.2f};
  c.upper = {0.2f, 1.2f, 0.3f};
  c.radius = 0.25f;
  c.skin = 0.02f;
  c.up = {0.6f, 0.8f, 0.0f};
  c.slope_cos_min = 0.5f;
  c.step_height = 0.2f;
  c.push_mass = 70.0f;
  c.push_force_max = 900.0f;
  c.gravity_scale = 0.5f;
  c.speed = 3.0f;
  c.acceleration = 30.0f;
  c.air_acceleration = 5.0f;
  c.jump_speed = 4.0f;
  c.filter = {2, 3, -1};
  scene.characters = {c};
  Control walk;
  walk.effect = Effect::kWalk;
  walk.target = "walker";
  walk.value = {1.0f, 0.0f, 0.0f};
  Control jump = walk;
  jump.source = Source::kButton;
  jump.effect = Effect::kJump;
  jump.value = {};
  Seat seat;
  seat.controls = {walk, jump};
  scene.seats = {seat};
  return scene;
}

TEST(CharacterData, EveryFieldGoesThroughJsonAndBinary) {
  for (const Scene& scene : {full_scene(), character_course(), character_course_3d()}) {
    const std::string json = to_json(scene);
    const Loaded read = from_json(json);
    ASSERT_TRUE(read.scene) << json;
    EXPECT_EQ(to_json(*read.scene), json);
    const std::vector<std::byte> binary = to_binary(scene);
    const Loaded unpacked = from_binary(binary);
    ASSERT_TRUE(unpacked.scene);
    EXPECT_EQ(to_json(*unpacked.scene), json);
    EXPECT_EQ(to_binary(*unpacked.scene), binary);
    EXPECT_EQ(scene_digest(*unpacked.scene), scene_digest(scene));
  }
  const std::string json = to_json(full_scene());
  for (const char* field : {"lower", "upper", "radius", "skin", "up", "slope_cos_min",
                            "step_height", "push_mass", "push_force_max", "gravity_scale", "speed",
                            "acceleration", "air_acceleration", "jump_speed", "filter"})
    EXPECT_NE(json.find("\"" + std::string(field) + "\":"), std::string::npos) << field;
}

TEST(CharacterData, EveryFieldChangesTheDigestOfTheScene) {
  using Change = std::function<void(SceneCharacter&)>;
  const std::vector<Change> changes = {
      [](SceneCharacter& c) { c.position[0] = 1.5f; },
      [](SceneCharacter& c) { c.lower[1] = 0.3f; },
      [](SceneCharacter& c) { c.upper[1] = 1.3f; },
      [](SceneCharacter& c) { c.radius = 0.3f; },
      [](SceneCharacter& c) { c.skin = 0.01f; },
      [](SceneCharacter& c) {
        c.up = {0.0f, 1.0f, 0.0f};
      },
      [](SceneCharacter& c) { c.slope_cos_min = 0.6f; },
      [](SceneCharacter& c) { c.step_height = 0.3f; },
      [](SceneCharacter& c) { c.push_mass = 71.0f; },
      [](SceneCharacter& c) { c.push_force_max = 901.0f; },
      [](SceneCharacter& c) { c.gravity_scale = 1.0f; },
      [](SceneCharacter& c) { c.speed = 3.5f; },
      [](SceneCharacter& c) { c.acceleration = 31.0f; },
      [](SceneCharacter& c) { c.air_acceleration = 6.0f; },
      [](SceneCharacter& c) { c.jump_speed = 4.5f; },
      [](SceneCharacter& c) { c.filter.mask = 7; },
  };
  const std::uint64_t digest = scene_digest(full_scene());
  for (std::size_t i = 0; i < changes.size(); ++i) {
    Scene scene = full_scene();
    changes[i](scene.characters[0]);
    ASSERT_TRUE(check(scene).empty()) << i;
    EXPECT_NE(scene_digest(scene), digest) << i;
  }
}

static void expect_mistake(const std::string& json, const std::string& path,
                           const std::string& reason) {
  const Loaded loaded = from_json(json);
  EXPECT_FALSE(loaded.scene) << json;
  std::string all;
  bool found = false;
  for (const Mistake& mistake : loaded.mistakes) {
    all += mistake.path + ": " + mistake.reason + "\n";
    found = found || (mistake.path == path && mistake.reason.find(reason) != std::string::npos);
  }
  EXPECT_TRUE(found) << json << "\ngave\n" << all;
}

TEST(CharacterData, EachMistakeNamesItsField) {
  const std::pair<const char*, const char*> fields[] = {
      {R"("radius": 0)", "radius"},
      {R"("radius": -1)", "radius"},
      {R"("position": [0, 1e8])", "position"},
      {R"("lower": [1e7])", "lower"},
      {R"("upper": [0, -1e7])", "upper"},
      {R"("upper": [0, 0.30001])", "upper"},
      {R"("skin": 0)", "skin"},
      {R"("skin": 0.2)", "skin"},
      {R"("up": [0, 2])", "up"},
      {R"("up": [0, 0, 1])", "up"},
      {R"("slope_cos_min": 0)", "slope_cos_min"},
      {R"("slope_cos_min": 1.5)", "slope_cos_min"},
      {R"("step_height": -0.1)", "step_height"},
      {R"("push_mass": 0)", "push_mass"},
      {R"("push_force_max": -1)", "push_force_max"},
      {R"("gravity_scale": 1e9)", "gravity_scale"},
      {R"("speed": -1)", "speed"},
      {R"("acceleration": -1)", "acceleration"},
      {R"("air_acceleration": -1)", "air_acceleration"},
      {R"("jump_speed": 1e9)", "jump_speed"},
      {R"("filter": 3)", "filter"},
  };
  for (const auto& [field, name] : fields)
    expect_mistake("{\"characters\": [{}, {" + std::string(field) + "}]}",
                   "/characters/1/" + std::string(name), "");
  expect_mistake(R"({"characters": [{"radus": 1}]})", "/characters/0/radus", "'radius' meant?");
  expect_mistake(R"({"characters": [{"name": "a"}, {"name": "a"}]})", "/characters/1/name",
                 "earlier character");
  expect_mistake(R"({"seats": [{"controls": [{"effect": "walk", "target": "x"}]}]})",
                 "/seats/0/controls/0/target", "names no character: 'x'");
  expect_mistake(R"({"characters": [{"name": "x"}],
                     "seats": [{"controls": [{"effect": "jump", "target": "x"}]}]})",
                 "/seats/0/controls/0/source", "has to be a button");
  expect_mistake(R"({"limits": {"registers": 8}, "characters": [{}]})", "/limits/registers",
                 "is 8, and the scene needs 9 from the start");
  ASSERT_TRUE(from_json(R"({"limits": {"registers": 9}, "characters": [{}]})").scene);
}

TEST(CharacterData, NumbersThatAreNoneAreRefusedInBinaryToo) {
  Scene scene = full_scene();
  scene.characters[0].jump_speed = std::bit_cast<float>(0x7fc00000u);
  const Loaded loaded = from_binary(to_binary(scene));
  ASSERT_EQ(loaded.mistakes.size(), 1u);
  EXPECT_EQ(loaded.mistakes[0].path, "/characters/0/jump_speed");
}

static std::unique_ptr<Built<2>> built_course() {
  std::vector<Mistake> mistakes;
  std::unique_ptr<Built<2>> built = build<2>(character_course(), mistakes);
  EXPECT_NE(built, nullptr);
  return built;
}

TEST(CharacterRegisters, HoldTheStateToTheBitAndOneZero) {
  const std::unique_ptr<Built<2>> built = built_course();
  EXPECT_EQ(built->world.registers().size(), 1u + kCharacterRegisters<2>);
  solver::MoverState<2> state;
  state.position = {{1.25f, -0.0f}};
  state.velocity = {{-3.0e-7f, 2.0f}};
  state.grounded = true;
  state.ground = {2, 5};
  state.ground_velocity = {{-0.0f, 7.5f}};
  ASSERT_TRUE(set_character_state(*built, 0, state));
  const solver::MoverState<2> read = character_state(*built, 0);
  for (int i = 0; i < 2; ++i) {
    EXPECT_EQ(read.position[i], state.position[i]);
    EXPECT_EQ(read.velocity[i], state.velocity[i]);
    EXPECT_EQ(read.ground_velocity[i], state.ground_velocity[i]);
  }
  EXPECT_TRUE(read.grounded);
  EXPECT_EQ(read.ground, state.ground);
  for (const std::uint32_t word : built->world.registers()) EXPECT_NE(word, 0x80000000u);
  EXPECT_TRUE(characters_fit(*built));
  state.velocity[0] = std::bit_cast<float>(0x7fc00000u);
  const std::uint64_t digest = built->world.digest();
  EXPECT_FALSE(set_character_state(*built, 0, state));
  EXPECT_EQ(built->world.digest(), digest);
}

static bool is_sound(const solver::MoverState<2>& state) {
  for (int i = 0; i < 2; ++i)
    if (!(std::abs(state.position[i]) <= 1.0e7f) || !(std::abs(state.velocity[i]) <= 1.0e5f) ||
        !(std::abs(state.ground_velocity[i]) <= 1.0e5f))
      return false;
  return true;
}

TEST(CharacterRegisters, WhateverTheyHoldTheCharacterIsSomewhere) {
  const std::uint32_t words[] = {0xffffffffu, 0x7f800000u, 0xff800000u, 0x7fc00000u,
                                 0x80000000u, 0x7f7fffffu, 0x4b189680u, 1u};
  const std::uint32_t count = kCharacterRegisters<2>;
  SeatInput input;
  input.axes[0] = 32767;
  for (const std::uint32_t word : words)
    for (std::uint32_t which = 0; which <= count; ++which) {
      const std::unique_ptr<Built<2>> built = built_course();
      const std::uint32_t first = built->characters[0].first_register;
      for (std::uint32_t i = 0; i < count; ++i)
        if (which == i || which == count) {
          ASSERT_TRUE(built->world.set_register(first + i, word).ok());
        }
      ASSERT_TRUE(is_sound(character_state(*built, 0)));
      for (int tick = 0; tick < 5; ++tick) {
        input.buttons = tick % 2 == 0 ? 1 : 0;
        apply_controls<2>(*built, std::span(&input, 1));
        ASSERT_TRUE(built->world.step().ok()) << word << ' ' << which;
        ASSERT_TRUE(is_sound(character_state(*built, 0))) << word << ' ' << which;
        ASSERT_TRUE(characters_fit(*built));
      }
    }
}

TEST(CharacterRegisters, ASnapshotWithACharacterNowhereIsRefused) {
  Simulation simulation = std::move(Simulation::create(character_course()).value());
  Simulation other = std::move(Simulation::create(character_course()).value());
  const std::uint64_t before = other.digest();
  for (std::uint32_t i = 1; i <= kCharacterRegisters<2>; ++i)
    ASSERT_TRUE(simulation.planar()->set_register(i, 0xffffffffu).ok());
  std::vector<std::byte> bytes;
  simulation.encode(bytes);
  const solver::Error error = other.decode(bytes);
  EXPECT_EQ(error.code, solver::Code::kCorrupt);
  EXPECT_STREQ(error.field, "registers");
  EXPECT_EQ(other.digest(), before);
}

TEST(CharacterRegisters, AtTheEndOfTheWorldItStaysWhereItIs) {
  const std::unique_ptr<Built<2>> built = built_course();
  solver::MoverState<2> state;
  state.position = {{1.0e7f, 50.0f}};
  state.velocity = {{9.0e4f, 0.0f}};
  ASSERT_TRUE(set_character_state(*built, 0, state));
  const SeatInput input;
  apply_controls<2>(*built, std::span(&input, 1));
  const solver::MoverState<2> after = character_state(*built, 0);
  EXPECT_EQ(after.position[0], 1.0e7f);
  EXPECT_EQ(after.position[1], 50.0f);
  EXPECT_EQ(after.velocity[0], 0.0f);
}

}  // namespace cycloid::scenes
