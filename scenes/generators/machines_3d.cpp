#include "scenes/generators/generators.hpp"
#include "solver/trig.hpp"

namespace cycloid::scenes {

using solver::JointKind;
using solver::MotorKind;

/// Rolling ground: waves along x that grow with the distance, lower towards the sides.
static SceneBody hills() {
  SceneBody body = frame();
  body.name = "hills";
  SceneShape& field = body.shapes.emplace_back();
  field.kind = solver::ShapeKind::kHeightField;
  constexpr int kColumns = 41;
  constexpr int kRows = 11;
  field.columns = kColumns;
  field.cell = {2.0f, 2.0f};
  field.points = {{-10.0f, 0.0f, -10.0f}};
  for (int row = 0; row < kRows; ++row)
    for (int column = 0; column < kColumns; ++column) {
      float sine = 0.0f;
      float cosine = 0.0f;
      const float x = 2.0f * static_cast<float>(column);
      solver::sin_cos(0.35f * x, sine, cosine);
      const float side = static_cast<float>(row) - 0.5f * (kRows - 1);
      const float height = 0.012f * solver::max(x - 14.0f, 0.0f) * (1.0f + sine);
      field.heights.push_back(height + 0.01f * side * side);
    }
  return body;
}

/// Walls around the hills, so that a lost car is not lost for ever.
static SceneBody fence() {
  SceneBody body = frame();
  body.name = "fence";
  for (const Triple& normal :
       {Triple{1.0f, 0.0f, 0.0f}, {-1.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.0f}, {0.0f, 0.0f, -1.0f}}) {
    SceneShape& wall = body.shapes.emplace_back();
    wall.kind = solver::ShapeKind::kHalfSpace;
    wall.normal = normal;
    wall.offset = normal[0] < 0.0f ? -69.0f : -9.5f;
  }
  return body;
}

static void add_wheel(Scene& scene, const std::string& name, const Triple& place, bool steers) {
  // A wheel's hull: a prism of 20 sides would rattle, so it rolls on a ball as wide as it is high.
  SceneBody wheel = body_at(name, {place[0], place[1] + 0.9f, place[2]}, ball_shape(0.4f));
  wheel.shapes[0].material = "tyre";
  wheel.shapes[0].density = 0.3f;
  scene.bodies.push_back(wheel);
  SceneJoint joint = joint_between(JointKind::kWheel, "chassis", place, name, {});
  joint.name = name + "-joint";
  joint.axis = {0.0f, 1.0f, 0.0f};
  joint.axle = {0.0f, 0.0f, 1.0f};
  joint.hertz = 3.0f;
  joint.damping_ratio = 0.7f;
  joint.limit_enabled = true;
  joint.lower = -0.2f;
  joint.upper = 0.25f;
  if (!steers) {
    joint.motor = MotorKind::kSpeed;
    joint.motor_max = 4.0f;
  }
  scene.joints.push_back(joint);
}

static Control steering_control(std::uint32_t axis, const std::string& joint, float angle) {
  Control control = motor_control(axis, joint, angle);
  control.effect = Effect::kSteering;
  return control;
}

Scene vehicle_3d() {
  Scene scene = spatial_scene("vehicle-3d", "A car on springs crosses hills; a seat steers it.");
  scene.materials.push_back({"tyre", 1.2f, 0.0f, 0.01f});
  scene.bodies.push_back(hills());
  scene.bodies.push_back(fence());
  SceneShape hull;
  hull.kind = solver::ShapeKind::kHull;
  for (const float z : {-0.6f, 0.6f})
    for (const Triple& point : {Triple{-1.5f, -0.25f, z},
                                {1.5f, -0.25f, z},
                                {1.6f, 0.0f, z},
                                {0.5f, 0.45f, 0.75f * z},
                                {-1.1f, 0.45f, 0.75f * z},
                                {-1.6f, 0.1f, z}})
      hull.points.push_back(point);
  hull.density = 0.6f;
  scene.bodies.push_back(body_at("chassis", {0.0f, 0.9f, 0.0f}, hull));
  for (const float z : {-0.8f, 0.8f}) {
    const std::string side = z < 0.0f ? "left" : "right";
    add_wheel(scene, "rear-" + side, {-1.1f, -0.45f, z}, false);
    add_wheel(scene, "front-" + side, {1.1f, -0.45f, z}, true);
  }
  for (int i = 0; i < 6; ++i) {
    SceneBody crate = body_at(
        "", {11.0f, 0.15f + 0.3f * static_cast<float>(i / 2), 0.2f * (i % 2 == 0 ? -1.0f : 1.0f)},
        solid_box({0.15f, 0.15f, 0.15f}));
    crate.shapes[0].density = 0.2f;
    scene.bodies.push_back(crate);
  }
  Seat seat;
  seat.name = "driver";
  // A wheel that rolls to positive x turns against the axle.
  for (const char* wheel : {"rear-left-joint", "rear-right-joint"})
    seat.controls.push_back(motor_control(0, wheel, -20.0f));
  for (const char* wheel : {"front-left-joint", "front-right-joint"})
    seat.controls.push_back(steering_control(1, wheel, 0.5f));
  seat.controls.push_back(impulse_control(0, "chassis", {0.0f, 6.0f, 0.0f}));
  seat.script.push_back({30, 0, 0, 1, {1.0f, 0.0f, 0.0f, 0.0f}, 0});
  seat.script.push_back({150, 0, 180, 30, {1.0f, 0.3f, 0.0f, 0.0f}, 0});
  seat.script.push_back({180, 0, 180, 60, {0.8f, -0.3f, 0.0f, 0.0f}, 1});
  seat.script.push_back({240, 0, 180, 30, {0.8f, 0.3f, 0.0f, 0.0f}, 0});
  scene.seats.push_back(seat);
  return scene;
}

/// A hinge at each end of a joint between two planks, so that they turn about z alone.
static SceneJoint plank_hinge(const std::string& a, const Triple& anchor_a, const std::string& b,
                              float anchor_x) {
  SceneJoint joint = joint_between(JointKind::kHinge, a, anchor_a, b, {anchor_x, 0.0f, 0.0f});
  joint.axis = {0.0f, 0.0f, 1.0f};
  return joint;
}

Scene bridge_3d(int planks) {
  Scene scene = spatial_scene("bridge-3d", "Planks on hinges between two banks, with a load.");
  if (planks != 24) scene.name += "-" + std::to_string(planks);
  const float half = 0.5f * static_cast<float>(planks);
  SceneBody banks = frame();
  banks.name = "banks";
  for (const float side : {-1.0f, 1.0f}) {
    SceneShape bank = solid_box({2.0f, 4.0f, 2.0f});
    bank.points = {{side * (half + 2.1f), 5.9f, 0.0f}};
    banks.shapes.push_back(bank);
  }
  scene.bodies.push_back(banks);
  scene.bodies.push_back(ground());
  std::string before = "banks";
  Triple anchor = {-half, 10.0f, 0.0f};
  for (int i = 0; i < planks; ++i) {
    const std::string name = "plank-" + std::to_string(i);
    SceneBody plank = body_at(name, {static_cast<float>(i) + 0.5f - half, 10.0f, 0.0f},
                              solid_box({0.48f, 0.1f, 1.0f}));
    plank.shapes[0].density = 20.0f;
    plank.linear_damping = 0.1f;
    plank.angular_damping = 0.1f;
    scene.bodies.push_back(plank);
    scene.joints.push_back(plank_hinge(before, anchor, name, -0.5f));
    before = name;
    anchor = {0.5f, 0.0f, 0.0f};
  }
  scene.joints.push_back(
      joint_between(JointKind::kRevolute, before, anchor, "banks", {half, 10.0f, 0.0f}));
  for (int i = 0; i < 4; ++i) {
    SceneBody load = body_at("", {2.0f * static_cast<float>(i) - 3.0f, 11.0f, 0.2f},
                             i % 2 == 0 ? solid_box({0.5f, 0.5f, 0.5f}) : ball_shape(0.5f));
    load.shapes[0].density = 10.0f;
    scene.bodies.push_back(load);
  }
  add_thrower(scene, {-half, 14.0f, 0.0f}, {10.0f, 2.0f, 0.0f});
  return scene;
}

}  // namespace cycloid::scenes
