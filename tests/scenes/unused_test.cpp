#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/scenes/said.hpp"

namespace cycloid::scenes {

/// What a part of a scene in so many dimensions says, and where; nothing else may be said.
struct Unused {
  int dimension;
  std::string part;
  std::string path;
  std::string reason;
};

static void expect_all_are_said(const std::vector<Unused>& all) {
  for (const Unused& unused : all)
    EXPECT_EQ(said(R"({"dimension": )" + std::to_string(unused.dimension) + ", " + unused.part),
              unused.path + ": " + unused.reason + "\n")
        << unused.part;
}

TEST(Rotations, AreFourNumbersInJsonWhateverTheyAre) {
  const auto body = [](const std::string& rotation) {
    return R"({"dimension": 3, "bodies": [{"kind": "static", "rotation": )" + rotation + "}]}";
  };
  for (const char* rotation : {"[1]", "[0, 0, 1]", "[0, 0, 0, 1, 0]"})
    EXPECT_EQ(said(body(rotation)),
              "/bodies/0/rotation: has to be 4 numbers: the quaternion x, y, z, w\n");
  const Loaded loaded = from_json(body("[1, 0, 0, 0]"));
  ASSERT_TRUE(loaded.scene);
  EXPECT_NE(to_json(*loaded.scene).find(R"("rotation":[1.0,0.0,0.0,0.0])"), std::string::npos);
  EXPECT_TRUE(from_json(to_json(*loaded.scene)).scene);
}

TEST(Unused, NumbersOfTheOtherDimensionAreRefused) {
  const std::string two = "has to be two numbers in dimension 2";
  const std::string bodies = R"("bodies": [{"name": "a", "kind": "static"},
                                           {"name": "b", "mass": 1, "shapes": [{"radius": 1}]}], )";
  const std::string joint = bodies + R"("joints": [{"body_a": "a", "body_b": "b", )";
  const std::string pulley = joint + R"("kind": "pulley", )";
  const std::string cloth = R"("cloths": [{"down": [0, -1], )";
  const std::string control = bodies + R"("seats": [{"controls": [{"target": "b", )";
  expect_all_are_said({
      {2, R"("gravity": [0, -10, 1]})", "/gravity", two},
      {2, R"("bodies": [{"mass": 1, "position": [0, 0, 1]}]})", "/bodies/0/position", two},
      {2, R"("bodies": [{"mass": 1, "velocity": [0, 0, 1]}]})", "/bodies/0/velocity", two},
      {2, R"("bodies": [{"mass": 1, "spin": [0, 0, 1]}]})", "/bodies/0/spin",
       "has to be one number in dimension 2"},
      {2, R"("bodies": [{"mass": 1, "rotation": [0, 0, 1, 0]}]})", "/bodies/0/rotation",
       "has to be left out in dimension 2: state angle"},
      {3, R"("bodies": [{"mass": 1, "angle": 1}]})", "/bodies/0/angle",
       "has to be left out in dimension 3: state rotation"},
      {2, R"("bodies": [{"shapes": [{"radius": 1, "points": [[0, 0, 1]]}]}]})",
       "/bodies/0/shapes/0/points/0", two},
      {2, R"("prefabs": [{"name": "p", "mass": 1, "spin": [0, 1]}]})", "/prefabs/0/spin",
       "has to be one number in dimension 2"},
      {2, joint + R"("anchor_a": [0, 0, 1]}]})", "/joints/0/anchor_a", two},
      {2, joint + R"("anchor_b": [0, 0, 1]}]})", "/joints/0/anchor_b", two},
      {2, joint + R"("kind": "prismatic", "axis": [1, 0, 1]}]})", "/joints/0/axis", two},
      {2, joint + R"("axle": [0, 0, 1]}]})", "/joints/0/axle", two},
      {2, pulley + R"("ground_a": [0, 9, 1], "ground_b": [1, 9]}]})", "/joints/0/ground_a", two},
      {2, pulley + R"("ground_a": [0, 9], "ground_b": [1, 9, 1]}]})", "/joints/0/ground_b", two},
      {2, cloth + R"("origin": [0, 0, 1]}]})", "/cloths/0/origin", two},
      {2, cloth + R"("across": [1, 0, 1]}]})", "/cloths/0/across", two},
      {2, R"("cloths": [{"down": [0, -1, 1]}]})", "/cloths/0/down", two},
      {2, R"("characters": [{"position": [0, 0, 1]}]})", "/characters/0/position", two},
      {2, R"("characters": [{"upper": [0, 1, 1]}]})", "/characters/0/upper", two},
      {2, control + R"("value": [1, 0, 1]}]}]})", "/seats/0/controls/0/value", two},
      {2, control + R"("effect": "torque", "value": [1, 1]}]}]})", "/seats/0/controls/0/value",
       "has to be one number in dimension 2"},
  });
}

TEST(Unused, FieldsOfOtherKindsOfShapesAreRefused) {
  const auto shape = [](const char* body, const char* text) {
    return R"("bodies": [{"kind": ")" + std::string(body) + R"(", "shapes": [{)" + text + "}]}]}";
  };
  const auto ball = [&](const char* text) {
    return shape("dynamic", ("\"radius\": 1, " + std::string(text)).c_str());
  };
  const std::string path = "/bodies/0/shapes/0/";
  const std::string but = "has to be left out of all but a ";
  expect_all_are_said({
      {2, ball(R"("normal": [0, 1])"), path + "normal", but + "half_space"},
      {2, ball(R"("offset": 1)"), path + "offset", but + "half_space"},
      {2, ball(R"("loop": true)"), path + "loop", but + "chain"},
      {3, ball(R"("half": [1, 1, 1])"), path + "half", but + "box"},
      {2, ball(R"("rotation": [0, 0, 1, 0])"), path + "rotation", but + "box"},
      {3, ball(R"("triangles": [[0, 1, 2]])"), path + "triangles", but + "mesh"},
      {3, ball(R"("heights": [0])"), path + "heights", but + "height_field"},
      {3, ball(R"("columns": 2)"), path + "columns", but + "height_field"},
      {3, ball(R"("cell": [1, 1])"), path + "cell", but + "height_field"},
      {2, shape("static", R"("kind": "half_space", "normal": [0, 1], "radius": 1)"),
       path + "radius", "has to be left out: a half_space has none"},
  });
}

TEST(Unused, FieldsOfOtherEffectsAreRefused) {
  const auto control = [](const std::string& text) {
    return R"("bodies": [{"name": "a", "kind": "static"}, {"name": "b", "shapes": [{"radius": 1}]}],
              "joints": [{"name": "j", "body_a": "a", "body_b": "b", "motor": "speed"}],
              "prefabs": [{"name": "p", "mass": 1}], "characters": [{"name": "c"}],
              "seats": [{"controls": [{)" +
           text + "}]}]}";
  };
  const std::string force = R"("target": "b", "value": [1], )";
  const std::string button = R"("source": "button", )";
  const std::string path = "/seats/0/controls/0/";
  const std::string of_spawn = "has to be left out of all but spawn";
  const std::string nothing = "has to be other than 0, or the control does nothing";
  expect_all_are_said({
      {2, control(force + R"("position": [1])"), path + "position", of_spawn},
      {2, control(force + R"("velocity": [1])"), path + "velocity", of_spawn},
      {2, control(force + R"("limit": 3)"), path + "limit", of_spawn},
      {2, control(force + R"("effect": "torque", "frame": "body")"), path + "frame",
       "has to be left out of all but force and impulse"},
      {2, control(R"("effect": "motor_speed", "target": "j", "value": [1, 1])"), path + "value",
       "has to be one number"},
      {2, control(button + R"("effect": "spawn", "target": "p", "value": [1])"), path + "value",
       "has to be left out of spawn and jump"},
      {2, control(button + R"("effect": "jump", "target": "c", "value": [1])"), path + "value",
       "has to be left out of spawn and jump"},
      {2, control(R"("target": "b")"), path + "value", nothing},
      {2, control(R"("effect": "torque", "target": "b")"), path + "value", nothing},
      {2, control(R"("effect": "walk", "target": "c")"), path + "value", nothing},
      {2, control(button + R"("effect": "impulse", "target": "b")"), path + "value", nothing},
      {2, R"("prefabs": [{"name": "p", "mass": 1, "position": [1]}]})", "/prefabs/0/position",
       "has to be left out: the control that spawns a prefab states it"},
      {2, R"("prefabs": [{"name": "p", "mass": 1, "velocity": [1]}]})", "/prefabs/0/velocity",
       "has to be left out: the control that spawns a prefab states it"},
  });
}

TEST(Unused, IsRefusedInBinaryToo) {
  Loaded loaded = from_json(R"({"bodies": [{"mass": 1}]})");
  ASSERT_TRUE(loaded.scene);
  loaded.scene->bodies[0].position[2] = 1.0f;
  EXPECT_EQ(said(from_binary(to_binary(*loaded.scene)).mistakes),
            "/bodies/0/position: has to be two numbers in dimension 2\n");
}

TEST(Script, ThatNeverSpeaksIsRefused) {
  const auto entry = [](const std::string& text) {
    return said(R"({"seats": [{"script": [{)" + text + "}]}]}");
  };
  EXPECT_EQ(entry(R"("from": 5, "until": 6)"), "");
  EXPECT_EQ(entry(R"("from": 5, "until": 0)"), "");
  const std::string until = "/seats/0/script/0/until: has to be later than from, or 0: for ever\n";
  EXPECT_EQ(entry(R"("from": 5, "until": 5)"), until);
  EXPECT_EQ(entry(R"("from": 5, "until": 2)"), until);
  EXPECT_EQ(entry(R"("every": 5, "hold": 0)"),
            "/seats/0/script/0/hold: has to be 1 or more: the ticks of every that it speaks in\n");
}

TEST(Controls, OfBodiesThatNothingMovesAreRefused) {
  const auto control = [](const std::string& body, const std::string& effect) {
    return said(R"({"bodies": [{"name": "b", )" + body + R"(}], "seats": [{"controls": [
        {"source": "button", "target": "b", "value": [1], "effect": ")" +
                effect + R"("}]}]})");
  };
  const std::string refused =
      "/seats/0/controls/0/target: names a body that nothing moves: it has to be dynamic\n";
  for (const char* effect : {"force", "torque", "impulse"}) {
    EXPECT_EQ(control(R"("kind": "static")", effect), refused);
    EXPECT_EQ(control(R"("kind": "kinematic")", effect), refused);
    EXPECT_EQ(control(R"("shapes": [{"radius": 1}])", effect), "");
  }
  const std::string particle = R"("kind": "particle", "mass": 1)";
  EXPECT_EQ(control(particle, "force"), "");
  EXPECT_EQ(control(particle, "torque"),
            "/seats/0/controls/0/target: names a particle: none turns\n");
}

}  // namespace cycloid::scenes
