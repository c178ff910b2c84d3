#include "scenes/generators/generators.hpp"
#include "scenes/generators/trial_scenes.hpp"

namespace cycloid::scenes {

using solver::JointKind;
using solver::MotorKind;

/// Capsules of `length` m on pins to the right of the origin; they meet nothing.
/// @returns the name of the last.
static std::string add_links(Scene& scene, int links, float length, float density) {
  scene.bodies.push_back(frame());
  std::string before = "frame";
  Triple pivot{};
  for (int i = 0; i < links; ++i) {
    const std::string name = "link-" + std::to_string(i);
    const float half = 0.5f * length;
    SceneBody link =
        body_at(name, {length * static_cast<float>(i) + half, 0.0f, 0.0f},
                capsule_shape({-half, 0.0f, 0.0f}, {half, 0.0f, 0.0f}, 0.125f * length));
    link.shapes[0].density = density;
    link.shapes[0].filter.mask = 0;
    scene.bodies.push_back(link);
    scene.joints.push_back(
        joint_between(JointKind::kRevolute, before, pivot, name, {-half, 0.0f, 0.0f}));
    before = name;
    pivot = {half, 0.0f, 0.0f};
  }
  return before;
}

static void add_weight(Scene& scene, const std::string& last, const Triple& pivot, float x,
                       float radius, float mass) {
  SceneBody ball = body_at("ball", {x + radius, 0.0f, 0.0f}, ball_shape(radius));
  ball.shapes[0].filter.mask = 0;
  ball.mass = mass;
  scene.bodies.push_back(ball);
  scene.joints.push_back(
      joint_between(JointKind::kRevolute, last, pivot, "ball", {-radius, 0.0f, 0.0f}));
}

static Scene chain_of(const char* name, int links, float ratio) {
  Scene scene = trial_scene(name, "A chain let go from the side, with a ball many times as heavy.");
  const std::string last = add_links(scene, links, 1.0f, 1.0f);
  const float link_mass = 0.25f + 0.015625f * 3.14159265f;
  add_weight(scene, last, {0.5f, 0.0f, 0.0f}, static_cast<float>(links), 1.0f, ratio * link_mass);
  return scene;
}
Scene trial_ball_and_chain() {
  return chain_of("trial-ball-and-chain", 40, 672.0f);
}
Scene trial_chain_100() {
  return chain_of("trial-chain-100", 10, 100.0f);
}
Scene trial_chain_1000() {
  return chain_of("trial-chain-1000", 10, 1000.0f);
}
Scene trial_chain_50000() {
  return chain_of("trial-chain-50000", 50, 50000.0f);
}

// Source of the measures: Catto's Solver2D (2024), Bridge; the load is a hundred planks.
Scene trial_bridge() {
  Scene scene =
      trial_scene("trial-bridge", "160 planks on pins; a hundred times one falls on them.");
  scene.bodies.push_back(frame());
  std::string before = "frame";
  Triple pivot = {-80.0f, 0.0f, 0.0f};
  for (int i = 0; i < 160; ++i) {
    const std::string name = "plank-" + std::to_string(i);
    SceneBody plank =
        body_at(name, {static_cast<float>(i) - 79.5f, 0.0f, 0.0f}, box_shape(0.5f, 0.125f));
    plank.shapes[0].density = 20.0f;
    plank.linear_damping = 0.1f;
    plank.angular_damping = 0.1f;
    scene.bodies.push_back(plank);
    scene.joints.push_back(
        joint_between(JointKind::kRevolute, before, pivot, name, {-0.5f, 0.0f, 0.0f}));
    before = name;
    pivot = {0.5f, 0.0f, 0.0f};
  }
  scene.joints.push_back(
      joint_between(JointKind::kRevolute, before, pivot, "frame", {80.0f, 0.0f, 0.0f}));
  SceneBody load = body_at("load", {0.0f, 3.0f, 0.0f}, box_shape(1.0f, 1.0f));
  load.mass = 500.0f;
  scene.bodies.push_back(load);
  return scene;
}

/// Discs in a net of pins, hung up by every sixth part of its first row.
static Scene net(const char* name, int side) {
  Scene scene = trial_scene(name, "A square net of discs on pins, hung up along its first row.");
  scene.gravity = {0.0f, -20.0f, 0.0f};
  const auto disc = [](int row, int column) {
    return std::to_string(row) + "/" + std::to_string(column);
  };
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      SceneBody body =
          body_at(disc(row, column), {static_cast<float>(column), -static_cast<float>(row), 0.0f},
                  ball_shape(0.4f));
      body.shapes[0].filter.mask = 0;
      if (row == 0 && column % (side / 6) == 0) body.kind = solver::BodyKind::kStatic;
      scene.bodies.push_back(body);
      if (column > 0)
        scene.joints.push_back(joint_between(JointKind::kRevolute, disc(row, column - 1),
                                             {0.5f, 0.0f, 0.0f}, disc(row, column),
                                             {-0.5f, 0.0f, 0.0f}));
      if (row > 0)
        scene.joints.push_back(joint_between(JointKind::kRevolute, disc(row - 1, column),
                                             {0.0f, -0.5f, 0.0f}, disc(row, column),
                                             {0.0f, 0.5f, 0.0f}));
    }
  return scene;
}
Scene trial_joint_grid() {
  return net("trial-joint-grid-30", 30);
}
Scene trial_joint_grid_full() {
  return net("trial-joint-grid-100", 100);
}

Scene trial_stretched_chain() {
  Scene scene =
      trial_scene("trial-stretched-chain", "Forty links that begin at twice their distance.");
  add_links(scene, 40, 1.0f, 1.0f);
  for (SceneBody& body : scene.bodies) body.position[0] *= 2.0f;
  return scene;
}

Scene trial_motor_at_limit() {
  Scene scene = trial_scene("trial-motor-at-limit", "A motor turns an arm against its limit.");
  scene.gravity = {};
  scene.bodies = {frame(), body_at("arm", {0.5f, 0.0f, 0.0f}, box_shape(0.5f, 0.1f))};
  SceneJoint joint = joint_between(JointKind::kRevolute, "frame", {}, "arm", {-0.5f, 0.0f, 0.0f});
  joint.limit_enabled = true;
  joint.lower = -0.5f;
  joint.upper = 0.5f;
  joint.motor = MotorKind::kSpeed;
  joint.motor_speed = 100.0f;
  joint.motor_max = 5.0f;
  scene.joints = {joint};
  return scene;
}

Scene trial_fighting_motors() {
  Scene scene = trial_scene("trial-fighting-motors", "Two equal motors turn one arm either way.");
  scene.gravity = {};
  scene.bodies = {frame(), body_at("arm", {0.5f, 0.0f, 0.0f}, box_shape(0.5f, 0.1f))};
  for (const float speed : {10.0f, -10.0f}) {
    SceneJoint joint = joint_between(JointKind::kRevolute, "frame", {}, "arm", {-0.5f, 0.0f, 0.0f});
    joint.motor = MotorKind::kSpeed;
    joint.motor_speed = speed;
    joint.motor_max = 5.0f;
    scene.joints.push_back(joint);
  }
  return scene;
}

Scene trial_gear_loop() {
  Scene scene = trial_scene("trial-gear-loop", "Three gears whose ratios contradict each other.");
  scene.gravity = {};
  scene.bodies.push_back(frame());
  const char* const names[] = {"first", "second", "third"};
  for (int i = 0; i < 3; ++i) {
    const Triple place = {2.5f * static_cast<float>(i), 0.0f, 0.0f};
    scene.bodies.push_back(body_at(names[i], place, ball_shape(1.0f)));
    scene.joints.push_back(joint_between(JointKind::kRevolute, "frame", place, names[i], {}));
  }
  scene.joints[0].motor = MotorKind::kSpeed;
  scene.joints[0].motor_speed = 5.0f;
  scene.joints[0].motor_max = 100.0f;
  const float ratios[] = {1.0f, 0.5f, 1.0f};
  for (int i = 0; i < 3; ++i) {
    SceneJoint gear = joint_between(JointKind::kGear, names[i], {}, names[(i + 1) % 3], {});
    gear.ratio = ratios[i];
    scene.joints.push_back(gear);
  }
  return scene;
}

Scene trial_elastic_grid() {
  Scene scene = trial_scene("trial-elastic-balls", "Forty-nine elastic discs fall on a floor.");
  scene.materials[0] = {"elastic", 0.0f, 1.0f};
  scene.tuning.restitution_threshold = 0.0f;
  scene.bodies.push_back(ground());
  for (int i = 0; i < 49; ++i)
    scene.bodies.push_back(body_at(
        "", {1.5f * static_cast<float>(i % 7), 2.0f + 1.5f * static_cast<float>(i / 7), 0.0f},
        ball_shape(0.4f)));
  return scene;
}

Scene trial_cradle() {
  Scene scene = quiet(newtons_cradle(), "trial-cradle");
  scene.tuning.restitution_threshold = 0.0f;
  return scene;
}

Scene trial_ragdolls() {
  Scene scene = quiet(ragdolls(32), "trial-ragdoll-stress");
  scene.summary = "32 people with motors of 200 N m that turn at 5 rad/s, elastic.";
  for (SceneMaterial& material : scene.materials) material.restitution = 1.0f;
  int motor = 0;
  for (SceneJoint& joint : scene.joints) {
    if (motor++ % 3 != 0) continue;
    joint.motor = MotorKind::kSpeed;
    joint.motor_speed = motor % 2 == 0 ? 5.0f : -5.0f;
    joint.motor_max = 200.0f;
  }
  return scene;
}

}  // namespace cycloid::scenes
