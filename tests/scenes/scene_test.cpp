#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <sstream>

#include "scenes/accuracy.hpp"
#include "scenes/catalogue.hpp"
#include "tests/places.hpp"

namespace cycloid::scenes {

/// A small scene that uses every part: both joints, a prefab, each effect.
Scene sample() {
  Loaded loaded = from_json(R"({
    "name": "sample", "dimension": 2, "gravity": [0, -10],
    "materials": [{"name": "ice", "friction": 0.1}, {"name": "rubber", "restitution": 0.5,
      "rolling_resistance": 0.02, "twist_resistance": 0.03}],
    "bodies": [
      {"name": "floor", "kind": "static", "shapes": [{"kind": "half_space", "normal": [0, 1]}]},
      {"name": "a", "position": [0, 3], "shapes": [{"radius": 0.5, "material": "rubber"}]},
      {"name": "b", "position": [1.1, 3], "angle": 0.1, "shapes": [{"kind": "polygon",
        "points": [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]], "radius": 0.05}]}],
    "joints": [
      {"name": "hub", "body_a": "a", "body_b": "b", "anchor_a": [0.55], "anchor_b": [-0.55],
       "motor": "speed", "motor_max": 5},
      {"kind": "distance", "body_a": "floor", "body_b": "a", "length": 3, "hertz": 2}],
    "prefabs": [{"name": "pebble", "shapes": [{"radius": 0.1, "density": 2.5}]}],
    "seats": [{"name": "first", "controls": [
      {"target": "a", "value": [5, 0]},
      {"index": 1, "effect": "torque", "target": "b", "value": [2]},
      {"index": 2, "effect": "motor_speed", "target": "hub", "value": [3]},
      {"source": "button", "effect": "impulse", "target": "a", "value": [0, 2], "frame": "body"},
      {"source": "button", "index": 1, "effect": "spawn", "target": "pebble", "position": [0, 6],
       "limit": 3}],
      "script": [{"from": 5, "every": 10, "hold": 5, "axes": [1, -0.5, 1], "buttons": 2}]}]
  })");
  for (const Mistake& mistake : loaded.mistakes)
    ADD_FAILURE() << mistake.path << ": " << mistake.reason;
  return loaded.scene.value_or(Scene{});
}

Simulation start(const Scene& scene) {
  solver::Result<Simulation> simulation = Simulation::create(scene);
  EXPECT_TRUE(simulation.ok());
  return std::move(simulation.value());
}

TEST(Json, ToBinaryToJsonIsTheIdentityForEveryScene) {
  std::vector<Scene> scenes = {sample()};
  for (const CatalogueEntry& entry : catalogue()) scenes.push_back(*find(entry.name).scene);
  for (const Scene& scene : scenes) {
    const std::string json = to_json(scene);
    const Loaded again = from_json(json);
    ASSERT_TRUE(again.scene) << scene.name;
    EXPECT_EQ(to_json(*again.scene), json) << scene.name;
    const std::vector<std::byte> binary = to_binary(*again.scene);
    const Loaded unpacked = from_binary(binary);
    ASSERT_TRUE(unpacked.scene) << scene.name;
    EXPECT_EQ(to_json(*unpacked.scene), json) << scene.name;
    EXPECT_EQ(to_binary(*unpacked.scene), binary) << scene.name;
    EXPECT_EQ(scene_digest(*unpacked.scene), scene_digest(scene)) << scene.name;
  }
}

TEST(Catalogue, FilesAreTheExportsOfTheirRules) {
  for (Scene scene : generated_defaults()) {
    std::ifstream file(places::source("scenes/catalogue/" + scene.name + ".json"));
    std::stringstream text;
    text << file.rdbuf();
    // No rule knows the method of a scene that asks for an accuracy: `cycloid tune` has stored it.
    if (states_accuracy(scene)) scene.accuracy.tuned = find(scene.name).scene->accuracy.tuned;
    EXPECT_EQ(text.str(), to_json(scene)) << scene.name;
  }
  EXPECT_EQ(generated_defaults().size(), catalogue().size());
}

TEST(Catalogue, ParametersGiveOtherSizes) {
  const Loaded small = find("pyramid:base=3");
  ASSERT_TRUE(small.scene);
  EXPECT_EQ(small.scene->bodies.size(), 1u + 6u);
  ASSERT_TRUE(find("stack:count=2").scene);
  ASSERT_TRUE(find("room:bodies=20").scene);
  ASSERT_TRUE(find("bridge:planks=5").scene);
  ASSERT_TRUE(find("ball-pit-3d:balls=9").scene);
  ASSERT_TRUE(find("card-house:storeys=2").scene);
}

TEST(Catalogue, BadNamesAndParametersSayWhatIsPossible) {
  for (const char* name : {"pyramid:base=0", "pyramid:base=401", "pyramid:base=x",
                           "pyramid:base=", "pyramid:height=3", "pyramid:base"}) {
    const Loaded loaded = find(name);
    ASSERT_FALSE(loaded.scene) << name;
    ASSERT_EQ(loaded.mistakes.size(), 1u);
    EXPECT_NE(loaded.mistakes[0].reason.find("base=N with N from 1 to 400"), std::string::npos)
        << loaded.mistakes[0].reason;
  }
  EXPECT_NE(find("half-pip").mistakes[0].reason.find("half-pipe"), std::string::npos);
  EXPECT_NE(find("half-pipe:x=1").mistakes[0].reason.find("no parameters"), std::string::npos);
}

struct Wrong {
  const char* json;
  const char* path;
  const char* reason;
};

TEST(Mistakes, EachIsNamedByPathAndReason) {
  const Wrong wrongs[] = {
      {R"({"bodys": []})", "/bodys", "is 'bodies' meant?"},
      {R"({"dimension": 4})", "/dimension", "has to be 2 or 3"},
      {R"({"dimension": "2"})", "/dimension", "whole number"},
      {R"({"tick_hz": 0})", "/tick_hz", "1 to 1000"},
      {R"({"gravity": [0, 1e40]})", "/gravity/1", "finite"},
      {R"({"gravity": []})", "/gravity", "1 to 3 numbers"},
      {R"({"gravity": [0, -1e9]})", "/gravity", "out of range"},
      {R"({"tuning": {"substeps": 0}})", "/tuning/substeps", "out of range"},
      {R"({"tuning": {"stabilisation": "hard"}})", "/tuning/stabilisation", "baumgarte, soft"},
      {R"({"limits": {"bodies": -1}})", "/limits/bodies", "out of range"},
      {R"({"limits": {"bodies": 0}, "bodies": [{"kind": "static"}]})", "/limits/bodies",
       "is 0, and the scene needs 1"},
      {R"({"materials": [{"name": "m", "friction": -1}]})", "/materials/0/friction",
       "out of range"},
      {R"({"materials": [{"name": "m"}, {"name": "n"}, {"name": "m"}]})", "/materials/2/name",
       "earlier material"},
      {R"({"bodies": [{"mass": -1}]})", "/bodies/0/mass", "has to be positive"},
      {R"({"bodies": [{"kind": "ghost"}]})", "/bodies/0/kind", "one of static"},
      {R"({"bodies": [{"shapes": [{"radius": 0}]}]})", "/bodies/0/shapes/0/radius", "positive"},
      {R"({"bodies": [{"shapes": [{"radius": 1, "material": "x"}]}]})",
       "/bodies/0/shapes/0/material", "names no material"},
      {R"({"bodies": [{"shapes": [{"kind": "polygon", "points": [[0,0],[1,0],[2,0]]}]}]})",
       "/bodies/0/shapes/0/points", "convex"},
      {R"({"bodies": [{"shapes": [{"kind": "half_space", "normal": [0, 1]}]}]})",
       "/bodies/0/shapes/0/kind", "give the body the kind static"},
      {R"({"bodies": [{"name": "a", "kind": "static"}, {"name": "a", "kind": "static"}]})",
       "/bodies/1/name", "earlier body"},
      {R"({"joints": [{"body_a": "x", "body_b": "y"}]})", "/joints/0/body_a", "names no body"},
      {R"({"prefabs": [{"shapes": [{"radius": 1}]}]})", "/prefabs/0/name", "has to be given"},
      {R"({"seats": [{"controls": [{"target": "x"}]}]})", "/seats/0/controls/0/target",
       "names no body"},
      {R"({"seats": [{"controls": [{"index": 4, "target": "x"}]}]})", "/seats/0/controls/0/index",
       "0 to 3"},
      {R"({"seats": [{"controls": [{"effect": "spawn", "target": "x"}]}]})",
       "/seats/0/controls/0/source", "has to be a button"},
      {R"({"seats": [{"script": [{"axes": [2]}]}]})", "/seats/0/script/0/axes", "within 1"},
      {R"({"name": "a", "name": "b"})", "/name", "twice"},
      {R"({"materials": [{}, {"name": "a"}], "bodies": [[], {"name": [{"x": 1, "x": 2}]}]})",
       "/bodies/1/name/0/x", "twice"},
      {R"({"gravity": [0, -1e999]})", "/gravity/1", "out of range"},
      {R"({"materials": [{}, {"friction": 1e999}]})", "/materials/1/friction", "out of range"},
      {R"({"name": "a",)", "", "line 1, column"},
      {R"([])", "", "has to be an object"},
      {"", "", "unexpected end of input"},
  };
  for (const Wrong& wrong : wrongs) {
    const Loaded loaded = from_json(wrong.json);
    EXPECT_FALSE(loaded.scene) << wrong.json;
    const bool found =
        std::any_of(loaded.mistakes.begin(), loaded.mistakes.end(), [&](const Mistake& mistake) {
          return mistake.path == wrong.path &&
                 mistake.reason.find(wrong.reason) != std::string::npos;
        });
    std::string all;
    for (const Mistake& mistake : loaded.mistakes)
      all += mistake.path + ": " + mistake.reason + "\n";
    EXPECT_TRUE(found) << wrong.json << "\ngave\n" << all;
  }
}

TEST(Mistakes, AllOfAFileAreReportedAtOnce) {
  const Loaded loaded = from_json(R"({
    "gravty": [0, 1],
    "bodies": [{"mass": "heavy"}, {"shapes": [{"radius": "big"}]}]})");
  ASSERT_EQ(loaded.mistakes.size(), 3u);
  EXPECT_EQ(loaded.mistakes[0].path, "/bodies/0/mass");
  EXPECT_EQ(loaded.mistakes[1].path, "/bodies/1/shapes/0/radius");
  EXPECT_EQ(loaded.mistakes[2].path, "/gravty");
}

TEST(Materials, ShapesThatNameNoneAreOfTheFirst) {
  const Loaded loaded = from_json(R"({"materials": [{"name": "ice"}, {"friction": 0.9}],
      "bodies": [{"shapes": [{"radius": 1}, {"radius": 1, "material": "ice"}]}]})");
  ASSERT_TRUE(loaded.scene);
  const Simulation simulation = start(*loaded.scene);
  for (const auto& shape : simulation.planar()->state().shapes) EXPECT_EQ(shape.material, 0u);
}

TEST(Mistakes, NestingHasABound) {
  const std::string deep(100000, '[');
  const Loaded loaded = from_json("{\"bodies\": " + deep);
  EXPECT_FALSE(loaded.scene);
  EXPECT_FALSE(loaded.mistakes.empty());
}

TEST(Binary, EveryTruncationAndBitFlipIsRefusedOrAScene) {
  const std::vector<std::byte> good = to_binary(sample());
  const std::string json = to_json(sample());
  for (std::size_t length = 0; length < good.size(); ++length) {
    const Loaded loaded = from_binary(std::span(good).first(length));
    // The last bytes may be padding; without them the scene is still whole.
    if (loaded.scene) {
      EXPECT_EQ(to_json(*loaded.scene), json) << length;
      EXPECT_GT(length + 8, good.size()) << length;
    }
  }
  int refused = 0;
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::vector<std::byte> flipped = good;
    flipped[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
    const Loaded loaded = from_binary(flipped);
    EXPECT_NE(loaded.scene.has_value(), !loaded.mistakes.empty()) << bit;
    if (!loaded.scene) ++refused;
  }
  EXPECT_GT(refused, 1000);
}

TEST(Script, SpeaksInItsTicksAndLaterEntriesWin) {
  Scene scene = sample();
  EXPECT_EQ(scripted_input(scene, 0, 4), SeatInput{});
  EXPECT_EQ(scripted_input(scene, 0, 5).axes[0], 32767);
  EXPECT_EQ(scripted_input(scene, 0, 5).axes[1], -16384);
  EXPECT_EQ(scripted_input(scene, 0, 9).buttons, 2);
  EXPECT_EQ(scripted_input(scene, 0, 10), SeatInput{});
  EXPECT_EQ(scripted_input(scene, 0, 15).buttons, 2);
  EXPECT_EQ(scripted_input(scene, 1, 15), SeatInput{});
  ScriptEntry later;
  later.from = 7;
  later.until = 8;
  later.buttons = 1;
  scene.seats[0].script.push_back(later);
  EXPECT_EQ(scripted_input(scene, 0, 7).buttons, 1);
  EXPECT_EQ(scripted_input(scene, 0, 8).buttons, 2);
}

TEST(Controls, ForceIsProportionalToTheAxis) {
  Scene scene = sample();
  scene.joints.clear();
  scene.seats[0].controls.erase(scene.seats[0].controls.begin() + 2);  // The motor's.
  Simulation simulation = start(scene);
  SeatInput input;
  input.axes[0] = -32768;  // The one value without a counterpart counts as -32767.
  ASSERT_TRUE(simulation.step(std::span(&input, 1)).ok());
  const auto body = simulation.planar()->bodies()[1];
  EXPECT_NEAR(body.velocity[0], -5.0f / body.mass / 60.0f, 1.0e-6f);
}

TEST(Controls, AHeldButtonActsOnceAndThenNotUntilItWasUp) {
  Simulation simulation = start(sample());
  const auto step = [&](std::uint16_t buttons) {
    SeatInput input;
    input.buttons = buttons;
    ASSERT_TRUE(simulation.step(std::span(&input, 1)).ok());
  };
  const std::uint32_t before = simulation.planar()->body_count();
  for (int i = 0; i < 10; ++i) step(2);
  EXPECT_EQ(simulation.planar()->body_count(), before + 1);
  step(0);
  step(2);
  EXPECT_EQ(simulation.planar()->body_count(), before + 2);
}

TEST(Controls, SpawnNeverExceedsItsLimitAndRecyclesTheOldest) {
  Simulation simulation = start(sample());
  const std::uint32_t before = simulation.planar()->body_count();
  std::vector<std::uint32_t> generations;
  for (int i = 0; i < 40; ++i) {
    SeatInput input;
    input.buttons = i % 2 == 0 ? 2 : 0;
    ASSERT_TRUE(simulation.step(std::span(&input, 1)).ok());
    EXPECT_LE(simulation.planar()->body_count(), before + 3);
    generations.push_back(simulation.poses().back().generation);
  }
  EXPECT_EQ(simulation.planar()->body_count(), before + 3);
  EXPECT_GT(*std::max_element(generations.begin(), generations.end()), 3u);
}

TEST(Controls, RestoredInTheMiddleOfAHeldButtonItGoesOnAsItWas) {
  const Scene scene = sample();
  Simulation simulation = start(scene);
  SeatInput held;
  held.buttons = 3;
  held.axes = {1000, 2000, 3000, 0};
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(simulation.step(std::span(&held, 1)).ok());
  Simulation::Saved saved;
  simulation.save(saved);
  std::vector<std::byte> bytes;
  simulation.encode(bytes);
  Simulation other = start(scene);
  ASSERT_TRUE(other.decode(bytes).ok());
  for (int i = 0; i < 30; ++i) {
    ASSERT_TRUE(simulation.step(std::span(&held, 1)).ok());
    ASSERT_TRUE(other.step(std::span(&held, 1)).ok());
    ASSERT_EQ(simulation.digest(), other.digest());
  }
  const std::uint64_t end = simulation.digest();
  simulation.restore(saved);
  for (int i = 0; i < 30; ++i) ASSERT_TRUE(simulation.step(std::span(&held, 1)).ok());
  EXPECT_EQ(simulation.digest(), end);
}

TEST(Simulation, RefusesTheWrongNumberOfInputs) {
  Simulation simulation = start(sample());
  const std::uint64_t before = simulation.digest();
  EXPECT_STREQ(simulation.step({}).field, "inputs");
  EXPECT_EQ(simulation.digest(), before);
}

TEST(Simulation, RefusesASnapshotOfAnotherScene) {
  Simulation simulation = start(sample());
  const std::uint64_t before = simulation.digest();
  std::vector<std::byte> bytes;
  start(*find("stack-10").scene).encode(bytes);
  EXPECT_EQ(simulation.decode(bytes).code, solver::Code::kCorrupt);
  start(*find("ball-pit-3d").scene).encode(bytes);
  EXPECT_EQ(simulation.decode(bytes).code, solver::Code::kCorrupt);
  EXPECT_EQ(simulation.digest(), before);
}

TEST(SceneDigest, ChangesWithEverythingThatASceneMeansAndWithNothingElse) {
  const std::uint64_t digest = scene_digest(sample());
  const std::vector<std::pair<const char*, std::function<void(Scene&)>>> changes = {
      {"gravity", [](Scene& s) { s.gravity[1] = -9.0f; }},
      {"tick rate", [](Scene& s) { s.tick_hz = 50.0f; }},
      {"slop", [](Scene& s) { s.tuning.slop = 0.001f; }},
      {"limit", [](Scene& s) { s.limits.contacts -= 1; }},
      {"friction", [](Scene& s) { s.materials[0].friction = 0.2f; }},
      {"twist resistance", [](Scene& s) { s.materials[0].twist_resistance = 0.2f; }},
      {"position", [](Scene& s) { s.bodies[1].position[0] = 0.1f; }},
      {"radius", [](Scene& s) { s.bodies[2].shapes[0].radius = 0.06f; }},
      {"anchor", [](Scene& s) { s.joints[0].anchor_a[0] = 0.5f; }},
      {"prefab", [](Scene& s) { s.prefabs[0].shapes[0].density = 3.0f; }},
      {"control value", [](Scene& s) { s.seats[0].controls[0].value[0] = 6.0f; }},
      {"control index", [](Scene& s) { s.seats[0].controls[0].index = 3; }},
      {"control frame", [](Scene& s) { s.seats[0].controls[0].frame = Frame::kBody; }},
      {"spawn velocity", [](Scene& s) { s.seats[0].controls[4].velocity[1] = 1.0f; }},
      {"seats", [](Scene& s) { s.seats.emplace_back(); }},
  };
  for (const auto& [name, change] : changes) {
    Scene scene = sample();
    change(scene);
    ASSERT_TRUE(check(scene).empty()) << name;
    EXPECT_NE(scene_digest(scene), digest) << name;
  }
  Scene renamed = sample();
  renamed.summary = "other words";
  renamed.seats[0].script.clear();
  EXPECT_EQ(scene_digest(renamed), digest);
}

TEST(HalfPipe, BothRidersStayOnTheirRampsForTenSeconds) {
  const Scene scene = *find("half-pipe").scene;
  Simulation simulation = start(scene);
  bool crossed[2] = {false, false};
  for (std::uint64_t tick = 1; tick <= 600; ++tick) {
    std::vector<SeatInput> inputs = {scripted_input(scene, 0, tick),
                                     scripted_input(scene, 1, tick)};
    ASSERT_TRUE(simulation.step(inputs).ok());
    const std::vector<Pose> poses = simulation.poses();
    const float from_centre[2] = {poses[1].position[0] + 5.0f, poses[2].position[0] - 5.0f};
    for (int rider = 0; rider < 2; ++rider) {
      ASSERT_LT(std::abs(from_centre[rider]), rider == 0 ? 3.0f : 4.72f) << tick;
      ASSERT_GT(poses[static_cast<std::size_t>(rider + 1)].position[1], 0.25f) << tick;
      crossed[rider] = crossed[rider] || from_centre[rider] > 1.5f;
    }
  }
  EXPECT_TRUE(crossed[0] && crossed[1]);
}

TEST(Poses, SayEveryPlanarRotationAsAQuaternionOfLengthOne) {
  for (const float angle : {0.0f, 1.0f, 1.5707963f, 3.1f, 3.1415f, 3.1415925f, -3.1415f, -2.0f}) {
    Scene scene;
    scene.name = "turned";
    scene.bodies.resize(1);
    scene.bodies[0].angle = angle;
    scene.bodies[0].shapes.resize(1);
    scene.bodies[0].shapes[0].kind = solver::ShapeKind::kBall;
    scene.bodies[0].shapes[0].radius = 0.5f;
    scene.bodies[0].shapes[0].points = {{0.0f, 0.0f, 0.0f}};
    const Pose pose = start(scene).poses()[0];
    const float z = pose.rotation[2];
    const float w = pose.rotation[3];
    EXPECT_NEAR(z * z + w * w, 1.0f, 1.0e-6f) << angle;
    EXPECT_NEAR(z, std::sin(0.5f * angle), 1.0e-6f) << angle;
    EXPECT_NEAR(w, std::cos(0.5f * angle), 1.0e-6f) << angle;
  }
}

}  // namespace cycloid::scenes
