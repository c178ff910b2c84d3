#include "scenes/generators/generators.hpp"
#include "solver/trig.hpp"

namespace cycloid::scenes {

Scene newtons_cradle() {
  Scene scene = planar_scene("newtons-cradle", "Five elastic balls on rigid rods.");
  scene.materials[0] = {"steel", 0.0f, 1.0f};
  scene.tuning.restitution_threshold = 0.1f;
  SceneBody frame;
  frame.name = "frame";
  frame.kind = solver::BodyKind::kStatic;
  scene.bodies.push_back(frame);
  for (int i = 0; i < 5; ++i) {
    const float x = static_cast<float>(i) - 2.0f;
    SceneBody ball;
    ball.name = "ball-" + std::to_string(i);
    ball.position = {x, 0.0f, 0.0f};
    if (i == 0) {
      float sine = 0.0f;
      float cosine = 0.0f;
      solver::sin_cos(0.7f, sine, cosine);
      ball.position = {x - 4.0f * sine, 4.0f - 4.0f * cosine, 0.0f};
    }
    ball.fixed_rotation = true;
    ball.shapes.push_back(ball_shape(0.5f));
    scene.bodies.push_back(ball);
    SceneJoint rod;
    rod.kind = solver::JointKind::kDistance;
    rod.body_a = "frame";
    rod.body_b = ball.name;
    rod.anchor_a = {x, 4.0f, 0.0f};
    rod.length = 4.0f;
    scene.joints.push_back(rod);
  }
  Seat seat;
  seat.name = "hand";
  Control push;
  push.source = Source::kButton;
  push.effect = Effect::kImpulse;
  push.target = "ball-4";
  push.value = {1.0f, 0.0f, 0.0f};
  seat.controls.push_back(push);
  ScriptEntry entry;
  entry.from = 400;
  entry.every = 400;
  entry.buttons = 1;
  seat.script.push_back(entry);
  scene.seats.push_back(seat);
  return scene;
}

static SceneJoint pin(const std::string& a, const Triple& anchor_a, const std::string& b,
                      const Triple& anchor_b) {
  SceneJoint joint;
  joint.body_a = a;
  joint.body_b = b;
  joint.anchor_a = anchor_a;
  joint.anchor_b = anchor_b;
  return joint;
}

Scene bridge(int planks) {
  Scene scene = planar_scene("bridge", "Planks on pins between two banks, with a load on them.");
  if (planks != 40) scene.name += "-" + std::to_string(planks);
  const float half = 0.5f * static_cast<float>(planks);
  SceneBody banks;
  banks.name = "banks";
  banks.kind = solver::BodyKind::kStatic;
  scene.bodies.push_back(banks);
  std::string before = "banks";
  Triple anchor = {-half, 10.0f, 0.0f};
  for (int i = 0; i < planks; ++i) {
    SceneBody plank;
    plank.name = "plank-" + std::to_string(i);
    plank.position = {static_cast<float>(i) + 0.5f - half, 10.0f, 0.0f};
    plank.linear_damping = 0.1f;
    plank.angular_damping = 0.1f;
    plank.shapes.push_back(box_shape(0.5f, 0.125f));
    plank.shapes[0].density = 20.0f;
    scene.bodies.push_back(plank);
    scene.joints.push_back(pin(before, anchor, plank.name, {-0.5f, 0.0f, 0.0f}));
    before = plank.name;
    anchor = {0.5f, 0.0f, 0.0f};
  }
  scene.joints.push_back(pin(before, anchor, "banks", {half, 10.0f, 0.0f}));
  for (int i = 0; i < 3; ++i) {
    SceneBody load;
    load.position = {static_cast<float>(i) * 3.0f - 3.0f, 12.0f, 0.0f};
    load.shapes.push_back(box_shape(0.6f, 0.6f));
    load.shapes[0].density = 10.0f;
    scene.bodies.push_back(load);
  }
  add_thrower(scene, {-0.25f * half, 16.0f, 0.0f}, {2.0f, 0.0f, 0.0f});
  return scene;
}

}  // namespace cycloid::scenes
