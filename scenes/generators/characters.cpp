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

static Control walk_control(std::uint32_t axis, const std::string& target, const Triple& value) {
  Control control;
  control.index = axis;
  control.effect = Effect::kWalk;
  control.target = target;
  control.value = value;
  return control;
}

static Control jump_control(const std::string& target) {
  Control control;
  control.source = Source::kButton;
  control.effect = Effect::kJump;
  control.target = target;
  return control;
}

static ScriptEntry say(std::uint32_t from, std::uint32_t until, float walk, std::uint32_t buttons) {
  ScriptEntry entry;
  entry.from = from;
  entry.until = until;
  entry.axes = {walk, 0.0f, 0.0f, 0.0f};
  entry.buttons = buttons;
  return entry;
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
  seat.script = {say(1, 30, -1.0f, 0), say(30, 241, 1.0f, 0), say(268, 368, 1.0f, 0),
                 say(268, 270, 1.0f, kJumpButton), say(474, 0, 1.0f, 0)};
  scene.seats = {seat};
  return scene;
}

/// What the course is made of in space; balls and half-spaces until there are boxes.
static void add_spatial_course(Scene& scene) {
  SceneBody floor = ground();
  SceneShape steep = floor.shapes[0];
  steep.normal = {0.81915204f, 0.57357644f, 0.0f};  // A slope of 55 degrees, from x = -4 on.
  steep.offset = -4.0f * steep.normal[0];
  SceneShape ramp = floor.shapes[0];
  ramp.normal = {-0.5f, 0.8660254f, 0.0f};  // A ramp of 30 degrees, from x = 8 on.
  ramp.offset = 8.0f * ramp.normal[0];
  floor.shapes.push_back(steep);
  floor.shapes.push_back(ramp);
  scene.bodies.push_back(floor);
  for (int i = 0; i < 3; ++i) {
    SceneBody bump;
    bump.kind = solver::BodyKind::kStatic;
    bump.position = {3.0f + static_cast<float>(i), -0.8f, 0.0f};
    bump.shapes = {ball_shape(1.0f)};
    scene.bodies.push_back(bump);
  }
  SceneBody pushed = body_at("pushed", {4.0f, 0.4f, 2.0f}, ball_shape(0.4f));
  pushed.shapes[0].density = 100.0f;
  scene.bodies.push_back(pushed);
}

Scene character_course_3d() {
  Scene scene;
  scene.name = "character-course-3d";
  scene.summary = "A ball of a character on bumps, a ramp and a steep slope; it pushes a ball";
  scene.dimension = 3;
  scene.gravity = {0.0f, -10.0f, 0.0f};
  scene.materials = {{"default", 0.6f, 0.0f, 0.0f}};
  add_spatial_course(scene);
  SceneCharacter walker;
  walker.name = "walker";
  walker.position = {0.0f, 0.02f, 0.0f};
  walker.lower = {0.0f, 0.4f, 0.0f};
  walker.upper = walker.lower;
  walker.radius = 0.4f;
  scene.characters = {walker};
  Seat seat;
  seat.name = "player";
  seat.controls = {walk_control(0, "walker", {1.0f, 0.0f, 0.0f}),
                   walk_control(1, "walker", {0.0f, 0.0f, 1.0f}), jump_control("walker")};
  seat.script = {say(1, 90, -1.0f, 0), say(90, 200, 1.0f, 0), say(120, 122, 1.0f, kJumpButton),
                 say(260, 0, 1.0f, 0)};
  ScriptEntry aside = say(200, 260, 0.0f, 0);
  aside.axes[1] = 1.0f;
  seat.script.push_back(aside);
  scene.seats = {seat};
  return scene;
}

}  // namespace cycloid::scenes
