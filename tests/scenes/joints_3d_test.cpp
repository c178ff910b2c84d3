#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "scenes/build.hpp"
#include "scenes/catalogue.hpp"
#include "scenes/controls.hpp"

namespace cycloid::scenes {

/// Joints in space as scenes say them: both forms, and the control that steers.

static Loaded cart(const std::string& more = "") {
  return from_json(R"({
    "name": "cart", "dimension": 3, "gravity": [0, 0, 0],
    "bodies": [
      {"name": "frame", "kind": "static"},
      {"name": "tyre", "position": [0, -1, 0], "shapes": [{"radius": 0.3}]},
      {"name": "door", "position": [2, 0, 0], "shapes": [{"radius": 0.3}]},
      {"name": "arm", "position": [4, 0, 0], "shapes": [{"radius": 0.3}]}],
    "joints": [
      {"name": "fork", "kind": "wheel", "body_a": "frame", "body_b": "tyre",
       "anchor_a": [0, -1, 0], "axis": [0, 1, 0], "axle": [1, 0, 0], "hertz": 3,
       "damping_ratio": 1)" +
                   more +
                   R"(},
      {"name": "pin", "kind": "hinge", "body_a": "frame", "body_b": "door", "anchor_a": [1.5, 0, 0],
       "anchor_b": [-0.5, 0, 0], "axis": [0, 1, 0]},
      {"name": "shoulder", "kind": "cone_twist", "body_a": "frame", "body_b": "arm",
       "anchor_a": [3.5, 0, 0], "anchor_b": [-0.5, 0, 0], "axis": [1, 0, 0], "cone": 0.75,
       "limit_enabled": true, "lower": -0.5, "upper": 0.25, "torque_max": 2}],
    "seats": [{"name": "driver", "controls": [
      {"effect": "steering", "target": "fork", "value": [0.6]}]}]
  })");
}

TEST(Joints3D, ASceneSaysThemInBothForms) {
  const Loaded loaded = cart(R"(, "steering": 0.125)");
  ASSERT_TRUE(loaded.scene) << (loaded.mistakes.empty() ? "" : loaded.mistakes[0].path);
  const Loaded again = from_binary(to_binary(*loaded.scene));
  ASSERT_TRUE(again.scene);
  EXPECT_EQ(to_json(*again.scene), to_json(*loaded.scene));
  EXPECT_EQ(scene_digest(*again.scene), scene_digest(*loaded.scene));
  EXPECT_EQ(again.scene->joints[0].axle, (Triple{1.0f, 0.0f, 0.0f}));
  EXPECT_EQ(again.scene->joints[0].steering, 0.125f);
  EXPECT_EQ(again.scene->joints[1].kind, solver::JointKind::kHinge);
  EXPECT_EQ(again.scene->joints[2].kind, solver::JointKind::kConeTwist);
  EXPECT_EQ(again.scene->joints[2].cone, 0.75f);
  EXPECT_EQ(again.scene->seats[0].controls[0].effect, Effect::kSteering);
  std::vector<Mistake> mistakes;
  const std::unique_ptr<Built<3>> built = build<3>(*again.scene, mistakes);
  ASSERT_TRUE(built);
  EXPECT_EQ(built->world.state().joints[0].steering, 0.125f);
  EXPECT_EQ(built->world.state().joints[2].cone, 0.75f);
}

TEST(Joints3D, TheAxisOfASeatSteersTheWheel) {
  const Loaded loaded = cart();
  ASSERT_TRUE(loaded.scene);
  std::vector<Mistake> mistakes;
  const std::unique_ptr<Built<3>> built = build<3>(*loaded.scene, mistakes);
  ASSERT_TRUE(built);
  for (const int level : {32767, -32767, 0}) {
    SeatInput input;
    input.axes[0] = static_cast<std::int16_t>(level);
    for (int tick = 0; tick < 60; ++tick) {
      apply_controls(*built, std::span<const SeatInput>(&input, 1));
      ASSERT_TRUE(built->world.step().ok());
    }
    const float angle = 0.6f * static_cast<float>(level) / 32767.0f;
    EXPECT_FLOAT_EQ(built->world.state().joints[0].steering, angle);
    const solver::Rotation<3> q = built->world.state().bodies[1].rotation;
    // The tyre turns about y by the angle.
    EXPECT_NEAR(2.0f * q[1], 2.0f * std::sin(0.5f * angle), 0.002f);
    EXPECT_NEAR(q[0], 0.0f, 0.001f);
  }
}

TEST(Joints3D, MistakesAreNamed) {
  const Loaded loaded = cart();
  ASSERT_TRUE(loaded.scene);
  const auto path_of = [&](const std::function<void(Scene&)>& spoil) {
    Scene scene = *loaded.scene;
    spoil(scene);
    const std::vector<Mistake> mistakes = check(scene);
    return mistakes.empty() ? std::string() : mistakes[0].path;
  };
  EXPECT_EQ(path_of([](Scene&) {}), "");
  EXPECT_EQ(path_of([](Scene& s) { s.joints[0].steering = 2.0f; }), "/joints/0/steering");
  EXPECT_EQ(path_of([](Scene& s) { s.joints[0].axle = s.joints[0].axis; }), "/joints/0/axle");
  EXPECT_EQ(path_of([](Scene& s) { s.joints[2].cone = 4.0f; }), "/joints/2/cone");
  const std::string control = "/seats/0/controls/0";
  EXPECT_EQ(path_of([](Scene& s) { s.seats[0].controls[0].target = "pin"; }), control + "/target");
  EXPECT_EQ(path_of([](Scene& s) { s.seats[0].controls[0].target = "none"; }), control + "/target");
  EXPECT_EQ(path_of([](Scene& s) { s.seats[0].controls[0].value[0] = 1.7f; }), control + "/value");
}

}  // namespace cycloid::scenes
