#include "scenes/generators/generators.hpp"
#include "solver/trig.hpp"

namespace cycloid::scenes {

using solver::JointKind;
using solver::MotorKind;

/// A road from wall to wall: flat, then waves that grow, then flat.
static SceneBody road() {
  SceneBody body = ground();
  body.shapes.clear();
  std::vector<Triple> points = {{-10.0f, 6.0f, 0.0f}, {-10.0f, 0.0f, 0.0f}};
  for (int i = 0; i <= 80; ++i) {
    const float share = static_cast<float>(i) / 80.0f;
    float sine = 0.0f;
    float cosine = 0.0f;
    solver::sin_cos(12.0f * solver::kPi * share, sine, cosine);
    points.push_back({5.0f + 40.0f * share, 0.3f * share * (1.0f - cosine), 0.0f});
  }
  points.push_back({70.0f, 0.0f, 0.0f});
  points.push_back({70.0f, 6.0f, 0.0f});
  body.shapes.push_back(chain_shape(points, false));
  return body;
}

static void add_wheel(Scene& scene, const std::string& name, float x) {
  SceneBody wheel = body_at(name, {x, 0.45f, 0.0f}, ball_shape(0.4f));
  wheel.shapes[0].material = "tyre";
  scene.bodies.push_back(wheel);
  SceneJoint joint =
      joint_between(JointKind::kWheel, "chassis", {x, -0.45f, 0.0f}, name, {0.0f, 0.0f, 0.0f});
  joint.name = name + "-motor";
  joint.axis = {0.0f, 1.0f, 0.0f};
  joint.hertz = 4.0f;
  joint.damping_ratio = 0.7f;
  joint.limit_enabled = true;
  joint.lower = -0.25f;
  joint.upper = 0.25f;
  joint.motor = MotorKind::kSpeed;
  joint.motor_max = 6.0f;
  scene.joints.push_back(joint);
}

Scene vehicle() {
  Scene scene = planar_scene("vehicle", "A car with suspension on a bumpy road; a seat drives it.");
  scene.materials.push_back({"tyre", 1.2f, 0.0f, 0.01f});
  scene.bodies.push_back(road());
  SceneShape hull;
  hull.kind = solver::ShapeKind::kPolygon;
  hull.points = {{-1.5f, -0.3f, 0.0f}, {1.5f, -0.3f, 0.0f}, {1.5f, 0.0f, 0.0f},
                 {0.5f, 0.5f, 0.0f},   {-1.0f, 0.5f, 0.0f}, {-1.5f, 0.1f, 0.0f}};
  scene.bodies.push_back(body_at("chassis", {0.0f, 0.9f, 0.0f}, hull));
  add_wheel(scene, "rear-wheel", -1.0f);
  add_wheel(scene, "front-wheel", 1.0f);
  for (int i = 0; i < 3; ++i) {
    SceneBody crate =
        body_at("", {48.0f, 0.3f + 0.6f * static_cast<float>(i), 0.0f}, box_shape(0.3f, 0.3f));
    crate.shapes[0].density = 0.5f;
    scene.bodies.push_back(crate);
  }
  Seat seat;
  seat.name = "driver";
  // A wheel that rolls to the right turns clockwise.
  seat.controls.push_back(motor_control(0, "rear-wheel-motor", -18.0f));
  seat.controls.push_back(motor_control(0, "front-wheel-motor", -18.0f));
  Control lean = force_control(1, "chassis", {2.0f, 0.0f, 0.0f});
  lean.effect = Effect::kTorque;
  seat.controls.push_back(lean);
  seat.controls.push_back(impulse_control(0, "chassis", {0.0f, 5.0f, 0.0f}));
  seat.script.push_back({30, 0, 0, 1, {1.0f, 0.0f, 0.0f, 0.0f}, 0});
  seat.script.push_back({200, 0, 200, 20, {0.5f, 1.0f, 0.0f, 0.0f}, 1});
  seat.script.push_back({480, 520, 0, 1, {-0.5f, 0.0f, 0.0f, 0.0f}, 0});
  scene.seats.push_back(seat);
  return scene;
}

static SceneJoint to_frame(JointKind kind, const Triple& place, const std::string& body) {
  return joint_between(kind, "frame", place, body, {});
}

/// A crank of 0.8 m turns a slide of 1.6 m.
static void add_slider_crank(Scene& scene, float x, float y) {
  scene.bodies.push_back(body_at("crank", {x + 0.4f, y, 0.0f}, box_shape(0.4f, 0.1f)));
  scene.bodies.push_back(body_at("rod", {x + 2.05f, y, 0.0f}, box_shape(1.25f, 0.06f)));
  scene.bodies.push_back(body_at("piston", {x + 3.3f, y, 0.0f}, box_shape(0.3f, 0.3f)));
  SceneJoint drive = to_frame(JointKind::kRevolute, {x, y, 0.0f}, "crank");
  drive.name = "crank-motor";
  drive.anchor_b = {-0.4f, 0.0f, 0.0f};
  drive.motor = MotorKind::kSpeed;
  drive.motor_max = 50.0f;
  scene.joints.push_back(drive);
  scene.joints.push_back(joint_between(JointKind::kRevolute, "crank", {0.4f, 0.0f, 0.0f}, "rod",
                                       {-1.25f, 0.0f, 0.0f}));
  scene.joints.push_back(
      joint_between(JointKind::kRevolute, "rod", {1.25f, 0.0f, 0.0f}, "piston", {}));
  SceneJoint slide = to_frame(JointKind::kPrismatic, {x + 3.3f, y, 0.0f}, "piston");
  slide.axis = {1.0f, 0.0f, 0.0f};
  scene.joints.push_back(slide);
}

static void add_gear(Scene& scene, const std::string& name, const Triple& place, float radius) {
  scene.bodies.push_back(body_at(name, place, ball_shape(radius)));
  SceneJoint axle = to_frame(JointKind::kRevolute, place, name);
  axle.name = name + "-axle";
  scene.joints.push_back(axle);
}

/// Pitch circles roll on each other: r_a w_a = -r_b w_b; a rack moves by r w.
static void add_gears(Scene& scene, float x, float y) {
  add_gear(scene, "wheel", {x, y, 0.0f}, 1.0f);
  scene.joints.back().motor = MotorKind::kSpeed;
  scene.joints.back().motor_max = 20.0f;
  add_gear(scene, "follower", {x + 1.5f, y, 0.0f}, 0.48f);
  SceneJoint pair = joint_between(JointKind::kGear, "wheel", {}, "follower", {});
  pair.ratio = 0.5f;
  scene.joints.push_back(pair);

  const float pinion_x = x + 5.0f;
  add_gear(scene, "pinion", {pinion_x, y, 0.0f}, 0.5f);
  SceneJoint& servo = scene.joints.back();
  servo.motor = MotorKind::kPosition;
  servo.motor_max = 60.0f;
  servo.hertz = 5.0f;
  servo.damping_ratio = 1.0f;
  servo.drive_amplitude = 2.0f;
  servo.drive_hertz = 0.4f;
  scene.bodies.push_back(body_at("rack", {pinion_x, y - 0.62f, 0.0f}, box_shape(1.5f, 0.1f)));
  SceneJoint slide = to_frame(JointKind::kPrismatic, {pinion_x, y - 0.62f, 0.0f}, "rack");
  slide.axis = {1.0f, 0.0f, 0.0f};
  scene.joints.push_back(slide);
  SceneJoint rack = joint_between(JointKind::kGear, "pinion", {}, "rack", {});
  rack.axis = {1.0f, 0.0f, 0.0f};
  rack.ratio = -2.0f;
  scene.joints.push_back(rack);
}

/// Atwood's machine: 3 kg pull 2 kg with g / 5 until they land.
static void add_pulley(Scene& scene, float x) {
  SceneBody light = body_at("light", {x, 1.5f, 0.0f}, box_shape(0.4f, 0.4f));
  light.mass = 2.0f;
  scene.bodies.push_back(light);
  SceneBody heavy = body_at("heavy", {x + 2.0f, 4.0f, 0.0f}, box_shape(0.4f, 0.4f));
  heavy.mass = 3.0f;
  scene.bodies.push_back(heavy);
  SceneJoint rope =
      joint_between(JointKind::kPulley, "light", {0.0f, 0.4f, 0.0f}, "heavy", {0.0f, 0.4f, 0.0f});
  rope.ground_a = {x, 7.0f, 0.0f};
  rope.ground_b = {x + 2.0f, 7.0f, 0.0f};
  scene.joints.push_back(rope);
}

/// Five boxes welded to the frame in a row: rigid, or with the given hertz of bending.
static void add_cantilever(Scene& scene, const std::string& name, float x, float y, float hertz) {
  std::string before = "frame";
  Triple anchor = {x, y, 0.0f};
  for (int i = 0; i < 5; ++i) {
    const std::string link = name + "-" + std::to_string(i);
    const Triple place = {x + 0.4f + 0.8f * static_cast<float>(i), y, 0.0f};
    scene.bodies.push_back(body_at(link, place, box_shape(0.4f, 0.1f)));
    SceneJoint weld = joint_between(JointKind::kWeld, before, anchor, link, {-0.4f, 0.0f, 0.0f});
    weld.angular_hertz = hertz;
    weld.angular_damping_ratio = hertz > 0.0f ? 0.7f : 0.0f;
    scene.joints.push_back(weld);
    before = link;
    anchor = {0.4f, 0.0f, 0.0f};
  }
}

/// A ball on a slack rope, a ball on a spring; a box that a motor holds and one on a mouse.
static void add_hanging(Scene& scene, float x, float y) {
  scene.bodies.push_back(body_at("roped", {x + 1.5f, y, 0.0f}, ball_shape(0.3f)));
  SceneJoint rope = to_frame(JointKind::kDistance, {x, y, 0.0f}, "roped");
  rope.limit_enabled = true;
  rope.upper = 2.0f;
  scene.joints.push_back(rope);
  scene.bodies.push_back(body_at("sprung", {x + 3.5f, y - 1.5f, 0.0f}, ball_shape(0.3f)));
  SceneJoint spring = to_frame(JointKind::kDistance, {x + 3.5f, y, 0.0f}, "sprung");
  spring.length = 1.5f;
  spring.hertz = 1.0f;
  spring.damping_ratio = 0.05f;
  scene.joints.push_back(spring);
  scene.bodies.push_back(body_at("held", {x + 6.0f, y - 1.0f, 0.0f}, box_shape(0.5f, 0.2f)));
  SceneJoint motor = to_frame(JointKind::kMotor, {x + 6.0f, y - 1.0f, 0.0f}, "held");
  motor.hertz = 2.0f;
  motor.damping_ratio = 1.0f;
  motor.angular_hertz = 2.0f;
  motor.angular_damping_ratio = 1.0f;
  motor.force_max = 12.0f;
  motor.torque_max = 3.0f;
  motor.target = 0.5f;
  scene.joints.push_back(motor);
  scene.bodies.push_back(body_at("dragged", {x + 8.5f, y - 2.0f, 0.0f}, box_shape(0.4f, 0.4f)));
  SceneJoint mouse = to_frame(JointKind::kTarget, {x + 8.5f, y, 0.0f}, "dragged");
  mouse.anchor_b = {0.3f, 0.3f, 0.0f};
  mouse.hertz = 2.0f;
  mouse.damping_ratio = 0.7f;
  mouse.force_max = 30.0f;
  scene.joints.push_back(mouse);
}

Scene machines() {
  Scene scene = planar_scene("machines", "Crank, gears, rack, pulley, welds, rope, spring, motor.");
  scene.bodies.push_back(ground());
  scene.bodies.push_back(frame());
  add_slider_crank(scene, -16.0f, 3.0f);
  add_gears(scene, -10.0f, 3.0f);
  add_pulley(scene, -1.5f);
  add_cantilever(scene, "rigid", 3.0f, 5.0f, 0.0f);
  add_cantilever(scene, "soft", 3.0f, 3.0f, 15.0f);
  add_hanging(scene, 9.0f, 5.0f);
  Seat seat;
  seat.name = "operator";
  seat.controls.push_back(motor_control(0, "crank-motor", 4.0f));
  seat.controls.push_back(motor_control(1, "wheel-axle", 3.0f));
  seat.controls.push_back(force_control(2, "light", {0.0f, -20.0f, 0.0f}));
  seat.controls.push_back(force_control(3, "dragged", {25.0f, 0.0f, 0.0f}));
  seat.controls.push_back(impulse_control(0, "rigid-4", {0.0f, -0.5f, 0.0f}));
  seat.controls.push_back(impulse_control(1, "soft-4", {0.0f, -0.5f, 0.0f}));
  seat.controls.push_back(impulse_control(2, "roped", {0.5f, 0.0f, 0.0f}));
  seat.controls.push_back(impulse_control(3, "held", {1.0f, 0.0f, 0.0f}));
  seat.script.push_back({1, 0, 0, 1, {1.0f, 1.0f, 0.0f, 0.0f}, 0});
  seat.script.push_back({180, 0, 240, 80, {1.0f, -1.0f, 1.0f, 0.0f}, 0});
  seat.script.push_back({260, 0, 240, 60, {-0.5f, 0.5f, 0.0f, 1.0f}, 15});
  scene.seats.push_back(seat);
  return scene;
}

}  // namespace cycloid::scenes
