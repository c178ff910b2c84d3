#include "scenes/generators/generators.hpp"

namespace cycloid::scenes {

SceneShape box_shape(float half_x, float half_y) {
  SceneShape shape;
  shape.kind = solver::ShapeKind::kPolygon;
  shape.points = {{-half_x, -half_y, 0.0f},
                  {half_x, -half_y, 0.0f},
                  {half_x, half_y, 0.0f},
                  {-half_x, half_y, 0.0f}};
  return shape;
}

SceneShape solid_box(const Triple& half) {
  SceneShape shape;
  shape.kind = solver::ShapeKind::kBox;
  shape.half = half;
  return shape;
}

SceneShape ball_shape(float radius) {
  SceneShape shape;
  shape.radius = radius;
  return shape;
}

SceneShape capsule_shape(const Triple& from, const Triple& to, float radius) {
  SceneShape shape;
  shape.kind = solver::ShapeKind::kCapsule;
  shape.points = {from, to};
  shape.radius = radius;
  return shape;
}

SceneShape chain_shape(std::vector<Triple> points, bool loop) {
  SceneShape shape;
  shape.kind = solver::ShapeKind::kChain;
  shape.points = std::move(points);
  shape.loop = loop;
  return shape;
}

SceneBody ground() {
  SceneBody body;
  body.name = "ground";
  body.kind = solver::BodyKind::kStatic;
  SceneShape& shape = body.shapes.emplace_back();
  shape.kind = solver::ShapeKind::kHalfSpace;
  shape.normal = {0.0f, 1.0f, 0.0f};
  return body;
}

SceneBody frame() {
  SceneBody body;
  body.name = "frame";
  body.kind = solver::BodyKind::kStatic;
  return body;
}

SceneBody body_at(const std::string& name, const Triple& position, const SceneShape& shape) {
  SceneBody body;
  body.name = name;
  body.position = position;
  body.shapes.push_back(shape);
  return body;
}

SceneJoint joint_between(solver::JointKind kind, const std::string& body_a, const Triple& anchor_a,
                         const std::string& body_b, const Triple& anchor_b) {
  SceneJoint joint;
  joint.kind = kind;
  joint.body_a = body_a;
  joint.body_b = body_b;
  joint.anchor_a = anchor_a;
  joint.anchor_b = anchor_b;
  return joint;
}

Control impulse_control(std::uint32_t button, const std::string& target, const Triple& value) {
  Control control;
  control.source = Source::kButton;
  control.index = button;
  control.effect = Effect::kImpulse;
  control.target = target;
  control.value = value;
  return control;
}

Control force_control(std::uint32_t axis, const std::string& target, const Triple& value) {
  Control control;
  control.index = axis;
  control.target = target;
  control.value = value;
  return control;
}

Control motor_control(std::uint32_t axis, const std::string& target, float value) {
  Control control;
  control.index = axis;
  control.effect = Effect::kMotorSpeed;
  control.target = target;
  control.value = {value, 0.0f, 0.0f};
  return control;
}

Control walk_control(std::uint32_t axis, const std::string& target, const Triple& value) {
  Control control;
  control.index = axis;
  control.effect = Effect::kWalk;
  control.target = target;
  control.value = value;
  return control;
}

Control jump_control(const std::string& target) {
  Control control;
  control.source = Source::kButton;
  control.effect = Effect::kJump;
  control.target = target;
  return control;
}

ScriptEntry walk_entry(std::uint32_t from, std::uint32_t until, float walk, std::uint32_t buttons) {
  ScriptEntry entry;
  entry.from = from;
  entry.until = until;
  entry.axes = {walk, 0.0f, 0.0f, 0.0f};
  entry.buttons = buttons;
  return entry;
}

Scene planar_scene(const char* name, const char* summary) {
  Scene scene;
  scene.name = name;
  scene.summary = summary;
  scene.gravity = {0.0f, -10.0f, 0.0f};
  scene.materials.push_back({"default", 0.6f, 0.0f});
  return scene;
}

Scene spatial_scene(const std::string& name, const char* summary) {
  Scene scene = planar_scene(name.c_str(), summary);
  scene.dimension = 3;
  return scene;
}

void add_thrower(Scene& scene, const Triple& position, const Triple& velocity) {
  SceneBody ball;
  ball.name = "thrown";
  ball.shapes.push_back(ball_shape(0.4f));
  ball.shapes[0].density = 4.0f;
  scene.prefabs.push_back(ball);
  Seat seat;
  seat.name = "thrower";
  Control throwing;
  throwing.source = Source::kButton;
  throwing.effect = Effect::kSpawn;
  throwing.target = "thrown";
  throwing.position = position;
  throwing.velocity = velocity;
  throwing.limit = 4;
  seat.controls.push_back(throwing);
  ScriptEntry entry;
  entry.from = 120;
  entry.every = 240;
  entry.hold = 2;
  entry.buttons = 1;
  seat.script.push_back(entry);
  scene.seats.push_back(seat);
}

}  // namespace cycloid::scenes
