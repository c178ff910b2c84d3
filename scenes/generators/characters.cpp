#include "scenes/generators/generators.hpp"

namespace cycloid::scenes {

static constexpr float kRampTop = 1.7320508f;               ///< 3 m at 30 degrees.
static constexpr float kPlateau = kRampTop + 0.9f;          ///< Three stairs higher.
static constexpr float kLedge = kPlateau + 2.0f;            ///< Where the lift leads, m.
static constexpr float kSteepRise = 4.0f;                   ///< Of the steep slope, m.
static constexpr float kSteepWidth = kSteepRise * 0.7002f;  ///< At 55 degrees.
static constexpr std::uint32_t kJumpButton = 1;             ///< As a bit.

/// From left to right: a slope too steep, a flat run, a ramp, stairs, a plateau, a gap, a landing,
/// the shaft of a lift, a ledge and a wall.
static SceneBody course() {
  SceneBody body = ground();
  std::vector<Triple> points = {{-2.0f - kSteepWidth, kSteepRise, 0.0f},
                                {-2.0f, 0.0f, 0.0f},
                                {5.0f, 0.0f, 0.0f},
                                {8.0f, kRampTop, 0.0f}};
  for (int i = 0; i < 3; ++i) {
    const float x = 9.5f + 0.4f * static_cast<float>(i);
    const float y = kRampTop + 0.3f * static_cast<float>(i);
    points.push_back({x, y, 0.0f});
    points.push_back({x, y + 0.3f, 0.0f});
  }
  const std::vector<Triple> rest = {
      {15.0f, kPlateau, 0.0f}, {15.0f, -0.5f, 0.0f}, {17.0f, -0.5f, 0.0f}, {17.0f, kPlateau, 0.0f},
      {20.0f, kPlateau, 0.0f}, {20.0f, 1.0f, 0.0f},  {22.0f, 1.0f, 0.0f},  {22.0f, kLedge, 0.0f},
      {26.0f, kLedge, 0.0f},   {26.0f, 9.0f, 0.0f}};
  points.insert(points.end(), rest.begin(), rest.end());
  body.shapes = {chain_shape(points, false)};
  return body;
}

/// A platform that a motor takes up and down between the landing and the ledge.
static void add_lift(Scene& scene) {
  const Triple middle = {21.0f, kPlateau + 1.0f, 0.0f};
  SceneBody platform = body_at("lift", middle, box_shape(0.95f, 0.15f));
  platform.shapes[0].density = 100.0f;
  for (Triple& point : platform.shapes[0].points) point[1] -= 0.15f;
  platform.gravity_scale = 0.0f;
  scene.bodies.push_back(platform);
  SceneJoint joint =
      joint_between(solver::JointKind::kPrismatic, "frame", middle, "lift", {0.0f, 0.0f, 0.0f});
  joint.axis = {0.0f, 1.0f, 0.0f};
  joint.motor = solver::MotorKind::kPosition;
  joint.motor_max = 1.0e5f;
  joint.hertz = 10.0f;
  joint.damping_ratio = 1.0f;
  joint.drive_amplitude = 1.0f;
  joint.drive_hertz = 0.28f;
  scene.joints.push_back(joint);
}

Scene character_course() {
  Scene scene = planar_scene("character-course",
                             "A walker on a ramp, stairs, a steep slope and a lift; it pushes a "
                             "box and jumps a gap");
  scene.materials.push_back({"slippery", 0.2f});
  scene.bodies = {course(), frame()};
  SceneBody box = body_at("box", {13.0f, kPlateau + 0.35f, 0.0f}, box_shape(0.5f, 0.35f));
  box.shapes[0].density = 40.0f;
  box.shapes[0].material = "slippery";
  scene.bodies.push_back(box);
  add_lift(scene);
  SceneCharacter walker;
  walker.name = "walker";
  walker.position = {-0.5f, 0.02f, 0.0f};
  walker.speed = 5.0f;
  scene.characters = {walker};
  Seat seat;
  seat.name = "player";
  seat.controls = {walk_control(0, "walker", {1.0f, 0.0f, 0.0f}), jump_control("walker")};
  // Against the steep slope, to the plateau, until the box has fallen, over the gap, onto the lift,
  // up, and to the wall.
  seat.script = {walk_entry(1, 30, -1.0f, 0), walk_entry(30, 241, 1.0f, 0),
                 walk_entry(268, 368, 1.0f, 0), walk_entry(268, 270, 1.0f, kJumpButton),
                 walk_entry(474, 0, 1.0f, 0)};
  scene.seats = {seat};
  return scene;
}

}  // namespace cycloid::scenes
