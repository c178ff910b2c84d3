#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "scenes/build.hpp"
#include "scenes/catalogue.hpp"
#include "scenes/needs.hpp"
#include "tests/scenes/said.hpp"

namespace cycloid::scenes {

TEST(Mistakes, OfAPartIsNotSaidAgainOfAllThatNameIt) {
  EXPECT_EQ(said(R"({"bodies": [
      {"name": "a", "shapes": [{"radius": 0}]},
      {"name": "b", "shapes": [{"radius": 1}]}],
    "joints": [{"name": "j", "body_a": "a", "body_b": "b", "motor": "speed"}],
    "cloths": [{"across": [1], "pins": [{"body": "a"}]}],
    "prefabs": [{"name": "p", "shapes": [{"radius": -1}]}],
    "seats": [{"controls": [
      {"target": "a", "value": [1]},
      {"effect": "motor_speed", "target": "j", "value": [1]},
      {"source": "button", "effect": "spawn", "target": "p"}]}]})"),
            "/bodies/0/shapes/0/radius: has to be positive and finite\n"
            "/prefabs/0/shapes/0/radius: has to be positive and finite\n");
  EXPECT_EQ(said(R"({"bodies": [{"name": "a"}, {"name": "a", "kind": "static"}],
                     "joints": [{"body_a": "a", "body_b": "c"}]})"),
            "/bodies/0/mass: has to be positive, or the shapes have to give it\n"
            "/bodies/1/name: is the name of an earlier body: 'a'\n"
            "/joints/0/body_b: names no body: 'c'\n");
}

// The world would refuse such a speed in each tick, and nobody would hear of it.
TEST(Mistakes, OfAControlWhoseSpeedNoMotorTakes) {
  const auto said_of = [](const char* value) {
    return said(R"({"bodies": [{"name": "a", "kind": "static"}, {"name": "b", "mass": 1}],
      "joints": [{"name": "j", "body_a": "a", "body_b": "b", "motor": "speed", "motor_max": 1}],
      "seats": [{"controls": [{"effect": "motor_speed", "target": "j", "value": [)" +
                std::string(value) + "]}]}]}");
  };
  EXPECT_EQ(said_of("-100000"), "");
  EXPECT_EQ(said_of("100001"),
            "/seats/0/controls/0/value: has to be a speed within 1e5 rad/s or m/s\n");
}

TEST(Mistakes, OfALimitAreSaidOnceWithBothNumbers) {
  EXPECT_EQ(said(R"({"limits": {"bodies": 2}, "bodies": [
      {"name": "a", "mass": 1}, {"name": "b", "mass": 1}, {"name": "c", "mass": 1},
      {"name": "d", "mass": 1}, {"name": "e", "mass": 1}, {"name": "f", "mass": -1}],
    "joints": [{"body_a": "a", "body_b": "e"}]})"),
            "/limits/bodies: is 2, and the scene needs 6 from the start\n"
            "/bodies/5/mass: has to be positive, or the shapes have to give it\n");
}

/// Uses every limit but those of contacts and registers; kinds with many shapes are among it.
static Scene full_of_parts(std::uint32_t dimension) {
  const bool plane = dimension == 2;
  const std::string shapes =
      plane ? R"({"kind": "chain", "points": [[0, 0], [-1, 0], [-2, 0], [-3, 1]]},
                 {"kind": "chain", "loop": true, "points": [[0, 0], [1, 0], [0, 1]]},
                 {"kind": "half_space", "normal": [0, 1]})"
            : R"({"kind": "mesh", "points": [[0], [0, 0, 1], [1], [1, 0, 1]],
                  "triangles": [[0, 1, 2], [2, 1, 3]]},
                 {"kind": "height_field", "columns": 3, "heights": [0, 0, 0, 0, 1, 0, 0, 0, 0],
                  "cell": [1, 1]}, {"kind": "box", "half": [1, 1, 1]})";
  const Loaded loaded = from_json(R"({"dimension": )" + std::to_string(dimension) +
                                  R"(, "bodies": [{"name": "a", "kind": "static", "shapes": [)" +
                                  shapes + R"(]}, {"name": "b", "shapes": [{"radius": 1}]}],
    "materials": [{"name": "m"}, {"name": "n"}], "joints": [{"body_a": "a", "body_b": "b"}],
    "cloths": [{"across": [0.1], "down": [0, -0.1], "columns": 4, "rows": 3,
                "pins": [{}, {"column": 3, "body": "b"}]},
               {"across": [0.1], "columns": 5, "shear_compliance": -1}]})");
  EXPECT_EQ(said(loaded.mistakes), "");
  return loaded.scene.value_or(Scene{});
}

/// Goal: needs are counted as the solver takes them. Method: limits that are just enough are good,
/// and each by itself is too small when it is one less.
TEST(Limits, AreEnoughExactlyWhereTheSceneNeedsNoMore) {
  for (const std::uint32_t dimension : {2u, 3u}) {
    Scene scene = full_of_parts(dimension);
    for (const Need& need : needs_of(scene))
      scene.limits.*need.limit = static_cast<std::uint32_t>(need.count);
    EXPECT_EQ(said(check(scene)), "") << dimension;
    for (const Need& need : needs_of(scene)) {
      ASSERT_GT(need.count, 0u) << need.name;
      Scene small = scene;
      --(small.limits.*need.limit);
      EXPECT_EQ(said(check(small)), std::string("/limits/") + need.name + ": " +
                                        too_small(small.limits.*need.limit, need.count) + "\n");
    }
    // Nothing takes less than is counted: the world is full.
    std::vector<Mistake> mistakes;
    const auto expect_full = [&](const auto& built) {
      EXPECT_EQ(built->world.state().bodies.size(), scene.limits.bodies);
      EXPECT_EQ(built->world.state().shapes.size(), scene.limits.shapes);
      EXPECT_EQ(built->world.state().particles.size(), scene.limits.particles);
      EXPECT_EQ(built->world.state().links.size(), scene.limits.links);
    };
    if (dimension == 2)
      expect_full(build<2>(scene, mistakes));
    else
      expect_full(build<3>(scene, mistakes));
  }
}

// A prefab is tried out in a world of its own, in which as much has to fit.
TEST(Limits, OfASceneHoldForItsPrefabsToo) {
  Scene scene;
  scene.limits.materials = 300;
  for (int i = 0; i < 300; ++i) scene.materials.push_back({"m" + std::to_string(i)});
  SceneBody& prefab = scene.prefabs.emplace_back();
  prefab.name = "p";
  prefab.shapes.resize(1);
  prefab.shapes[0].radius = 1.0f;
  prefab.shapes[0].material = "m299";
  std::vector<Mistake> mistakes;
  const auto made = build<2>(scene, mistakes);
  EXPECT_EQ(said(mistakes), "");
  ASSERT_NE(made, nullptr);
  EXPECT_EQ(made->prefabs.size(), 1u);
}

struct Sentence {
  const char* json;
  const char* said;
};

TEST(Mistakes, SayWhatToDoInstead) {
  const Sentence sentences[] = {
      {R"({"bodies": [{"shapes": [{"kind": "hull", "points": [[0]]}]}]})",
       "/bodies/0/shapes/0/kind: hull is of dimension 3 only: in dimension 2 use polygon\n"},
      {R"({"bodies": [{"kind": "static", "shapes": [{"kind": "mesh"}]}]})",
       "/bodies/0/shapes/0/kind: mesh is of dimension 3 only: in dimension 2 use chain\n"},
      {R"({"dimension": 3, "bodies": [{"kind": "static", "shapes": [{"kind": "chain"}]}]})",
       "/bodies/0/shapes/0/kind: chain is of dimension 2 only: in dimension 3 use mesh or "
       "height_field\n"},
      {R"({"bodies": [{"shapes": [{"kind": "chain", "points": [[0], [1]]}]}]})",
       "/bodies/0/shapes/0/kind: chain is of static bodies only: give the body the kind static\n"},
      {R"({"bodies": [{"shapes": [{"points": [[0], [1]], "radius": 1}]}]})",
       "/bodies/0/shapes/0/points: has to be one finite point, or none\n"},
      {R"({"bodies": [{"shapes": [{"kind": "capsule", "points": [[1], [1]], "radius": 1}]}]})",
       "/bodies/0/shapes/0/points: has to be two finite points, apart from each other\n"},
      {R"({"bodies": [{"kind": "static", "velocity": [1]}]})",
       "/bodies/0/velocity: has to be left out: a static body has none\n"},
      {R"({"bodies": [{"kind": "static", "spin": [1]}]})",
       "/bodies/0/spin: has to be left out: a static body has none\n"},
      {R"({"limits": {"joints": 16777217}})", "/limits/joints: has to be at most 16777216\n"},
      {R"({"cloths": [{"across": [0.1], "columns": 65537}]})",
       "/cloths/0/columns: has to be 1 or more, and all cloths have at most 65536 particles "
       "together\n"},
  };
  for (const Sentence& sentence : sentences)
    EXPECT_EQ(said(sentence.json), sentence.said) << sentence.json;
}

TEST(Mistakes, OfAJointSayWhatToDoInstead) {
  const auto said_of = [](int dimension, const std::string& joint) {
    return said(R"({"dimension": )" + std::to_string(dimension) +
                R"(, "bodies": [{"name": "a", "kind": "static"}, {"name": "b", "mass": 1},
                                {"name": "c", "kind": "static"}],
                     "joints": [{"body_a": "a", )" +
                joint + "}]}");
  };
  EXPECT_EQ(said_of(2, R"("body_b": "a")"),
            "/joints/0/body_b: has to be another body than body_a\n");
  EXPECT_EQ(said_of(2, R"("body_b": "c")"),
            "/joints/0/body_b: does not move, and body_a does not either: one of them has to\n");
  EXPECT_EQ(said_of(2, R"("body_b": "b", "kind": "hinge", "axis": [1])"),
            "/joints/0/kind: hinge is of dimension 3 only: in dimension 2 use revolute\n");
  EXPECT_EQ(said_of(3, R"("body_b": "b", "kind": "gear")"),
            "/joints/0/kind: gear is of dimension 2 only\n");
  EXPECT_EQ(said_of(2, R"("body_b": "b", "kind": "wheel", "axis": [1], "axle": [0, 1])"),
            "/joints/0/axle: has to be left out: dimension 2 has none\n");
  EXPECT_EQ(said_of(2, R"("body_b": "b", "kind": "weld", "motor": "speed")"),
            "/joints/0/motor: has to be left out: weld takes no such motor\n");
  EXPECT_EQ(said_of(2, R"("body_b": "b", "kind": "curve", "curve": "polyline")"),
            "/joints/0/curve: needs a chain or polygon on body_a\n");
}

TEST(Mistakes, OfAFileSayWhatItIs) {
  const auto said_of_file = [](std::string_view text) {
    const std::string file = testing::TempDir() + "cycloid-" + std::to_string(::getpid()) + ".json";
    std::ofstream(file) << text;
    const std::string all = said(load_file(file).mistakes);
    std::filesystem::remove(file);
    return all;
  };
  EXPECT_EQ(said_of_file(""), ": is empty\n");
  EXPECT_EQ(said_of_file(" \n\n"), ": is empty\n");
  EXPECT_EQ(said_of_file("name"), ": is neither JSON nor a binary scene\n");
  EXPECT_EQ(said_of_file("dimension: 2"), ": is neither JSON nor a binary scene\n");
  EXPECT_EQ(said(from_binary({}).mistakes), ": is empty\n");
  EXPECT_EQ(said(load_file(testing::TempDir()).mistakes), ": is a directory, or cannot be read\n");
  EXPECT_EQ(said(load_file("no-such-file").mistakes), ": cannot be read\n");
}

}  // namespace cycloid::scenes
