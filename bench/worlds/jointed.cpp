#include <string>

#include "bench/worlds/bench_worlds.hpp"
#include "bench/worlds/parts.hpp"
#include "solver/trig.hpp"

namespace cycloid::worlds {

using solver::JointKind;

static std::string cell_name(int row, int column) {
  return std::to_string(row) + "-" + std::to_string(column);
}

// As the scene of the same name among the benchmarks of Box2D v3, without the pins between what
// does not move.
Scene joint_grid(int side) {
  Scene scene = plane_scene("Balls in a net of pins.", 0.6f, 0.0f);
  const auto is_held = [side](int row, int column) {
    return row == 0 && -3 <= column - side / 2 && column - side / 2 <= 3;
  };
  for (int row = 0; row < side; ++row)
    for (int column = 0; column < side; ++column) {
      SceneBody ball =
          scenes::body_at(cell_name(row, column),
                          {static_cast<float>(column) - 0.5f * static_cast<float>(side - 1),
                           -static_cast<float>(row), 0.0f},
                          scenes::ball_shape(0.4f));
      ball.shapes[0].filter = {2, 1, 0};
      if (is_held(row, column)) ball.kind = solver::BodyKind::kStatic;
      scene.bodies.push_back(ball);
      if (row > 0)
        scene.joints.push_back(
            scenes::joint_between(JointKind::kRevolute, cell_name(row - 1, column),
                                  {0.0f, -0.5f, 0.0f}, ball.name, {0.0f, 0.5f, 0.0f}));
      if (column > 0 && !(is_held(row, column) && is_held(row, column - 1)))
        scene.joints.push_back(scenes::joint_between(JointKind::kRevolute,
                                                     cell_name(row, column - 1), {0.5f, 0.0f, 0.0f},
                                                     ball.name, {-0.5f, 0.0f, 0.0f}));
    }
  return scene;
}

/// A pin of the world through the origin of the body at `place`, turned by a motor.
static void add_motor(Scene& scene, const Triple& place, const std::string& body, float speed,
                      float torque_max) {
  scene.bodies.push_back(scenes::frame());
  scenes::SceneJoint motor = scenes::joint_between(JointKind::kRevolute, "frame", place, body, {});
  motor.motor = solver::MotorKind::kSpeed;
  motor.motor_speed = speed;
  motor.motor_max = torque_max;
  scene.joints.push_back(motor);
}

// As the scene of the same name among the benchmarks of Box2D v3.
Scene tumbler(int side) {
  Scene scene = plane_scene("Small boxes in a box that a motor turns.", 0.6f, 0.0f);
  SceneBody drum;
  drum.name = "drum";
  drum.position = {0.0f, 10.0f, 0.0f};
  for (const float end : {-10.0f, 10.0f}) {
    for (const bool upright : {true, false}) {
      SceneShape wall = upright ? scenes::box_shape(0.5f, 10.0f) : scenes::box_shape(10.0f, 0.5f);
      for (Triple& corner : wall.points) corner[upright ? 0 : 1] += end;
      wall.density = 50.0f;
      drum.shapes.push_back(wall);
    }
  }
  scene.bodies.push_back(drum);
  add_motor(scene, drum.position, "drum", 25.0f * solver::kPi / 180.0f, 1e8f);
  for (int i = 0; i < side * side; ++i)
    add_body(scene,
             {0.4f * (static_cast<float>(i % side) - 0.5f * static_cast<float>(side)),
              0.4f * (static_cast<float>(i / side) - 0.5f * static_cast<float>(side)) + 10.0f, 0},
             scenes::box_shape(0.125f, 0.125f));
  return scene;
}

// As the scene of the same name among the benchmarks of Box2D v3, but for the bar: there it is 40 m
// long and reaches 0.2 m into the ring, so that an engine that holds the two apart holds the bar
// fast, and nothing is stirred. Here anything passes between its end and the ring.
Scene spinner(int bodies) {
  Scene scene = plane_scene("Mixed shapes in a ring, stirred by a bar.", 0.1f, 0.1f);
  constexpr int kSegments = 360;
  std::vector<Triple> ring;
  for (int i = 0; i < kSegments; ++i) {
    float sine = 0.0f;
    float cosine = 0.0f;
    // Counter-clockwise, so that the inside is free.
    solver::sin_cos(2.0f * solver::kPi * static_cast<float>(i) / kSegments, sine, cosine);
    ring.push_back({40.0f * cosine, 40.0f * sine + 32.0f, 0.0f});
  }
  SceneBody wall = scenes::body_at("", {}, scenes::chain_shape(ring, true));
  wall.kind = solver::BodyKind::kStatic;
  scene.bodies.push_back(wall);
  SceneBody bar = scenes::body_at("bar", {0.0f, 12.0f, 0.0f}, scenes::box_shape(0.4f, 18.5f));
  bar.shapes[0].radius = 0.2f;
  scene.bodies.push_back(bar);
  add_motor(scene, bar.position, "bar", 5.0f, 40000.0f);
  int placed = 0;
  for (int cell = 0; placed < bodies; ++cell) {
    const float x = static_cast<float>(cell % 49) - 24.0f;
    const float y = 2.0f + static_cast<float>(cell / 49);
    add_body(scene, {x, y, 0.0f}, mixed_shape(placed++));
    scene.bodies.back().shapes[0].density = 0.25f;
  }
  return scene;
}

Scene ragdoll_rain(int people) {
  Scene scene = plane_scene("Ragdolls rain onto a floor with steps.", 0.5f, 0.0f);
  constexpr int kColumns = 20;
  add_bin(scene, 1.5f * kColumns + 2.0f, 300.0f);
  for (int i = 0; i < kColumns / 2; ++i)
    add_wall(scene, {6.0f * static_cast<float>(i) - 27.0f, 0.4f, 0.0f}, 1.0f, 0.4f);
  const Scene one = scenes::ragdolls(1);
  for (int i = 0; i < people; ++i) {
    const std::string prefix = "p" + std::to_string(i) + "-";
    const auto renamed = [&](const std::string& name) { return prefix + name.substr(3); };
    const float x = 3.0f * (static_cast<float>(i % kColumns) - 0.5f * (kColumns - 1));
    const float y = 2.5f * static_cast<float>(i / kColumns) - 3.0f;
    for (SceneBody body : one.bodies) {
      if (!body.name.starts_with("p0-")) continue;
      body.name = renamed(body.name);
      // The one person stands at x = -5.
      body.position = {body.position[0] + x + 5.0f, body.position[1] + y, 0.0f};
      body.velocity = {};
      body.shapes[0].filter.group = -1 - i;
      scene.bodies.push_back(body);
    }
    for (scenes::SceneJoint joint : one.joints) {
      joint.name = "";
      joint.body_a = renamed(joint.body_a);
      joint.body_b = renamed(joint.body_b);
      scene.joints.push_back(joint);
    }
  }
  return scene;
}

}  // namespace cycloid::worlds
