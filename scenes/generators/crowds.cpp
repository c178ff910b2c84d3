#include "scenes/generators/generators.hpp"

namespace cycloid::scenes {

static void add_half_space(SceneBody& body, const Triple& normal, float offset) {
  SceneShape& shape = body.shapes.emplace_back();
  shape.kind = solver::ShapeKind::kHalfSpace;
  shape.normal = normal;
  shape.offset = offset;
}

static SceneBody box_of_planes(float half_x, float half_z, bool spatial) {
  SceneBody body;
  body.name = "walls";
  body.kind = solver::BodyKind::kStatic;
  add_half_space(body, {0.0f, 1.0f, 0.0f}, 0.0f);
  add_half_space(body, {1.0f, 0.0f, 0.0f}, -half_x);
  add_half_space(body, {-1.0f, 0.0f, 0.0f}, -half_x);
  if (!spatial) return body;
  add_half_space(body, {0.0f, 0.0f, 1.0f}, -half_z);
  add_half_space(body, {0.0f, 0.0f, -1.0f}, -half_z);
  return body;
}

Scene ball_pit(int balls) {
  Scene scene = planar_scene("ball-pit-3d", "Balls in a box of half-spaces, stirred by a seat.");
  if (balls != 150) scene.name = "ball-pit-3d-" + std::to_string(balls);
  scene.dimension = 3;
  scene.materials[0] = {"plastic", 0.4f, 0.3f};
  scene.bodies.push_back(box_of_planes(3.0f, 3.0f, true));
  Random random{17};
  for (int i = 0; i < balls; ++i) {
    SceneBody ball;
    if (i == 0) ball.name = "stirrer";
    const int layer = i / 25;
    ball.position = {static_cast<float>(i % 5) * 1.1f - 2.2f + random.between(-0.05f, 0.05f),
                     0.6f + static_cast<float>(layer) * 1.1f,
                     static_cast<float>(i / 5 % 5) * 1.1f - 2.2f + random.between(-0.05f, 0.05f)};
    ball.shapes.push_back(ball_shape(random.between(0.3f, 0.5f)));
    scene.bodies.push_back(ball);
  }
  Seat seat;
  seat.name = "stirrer";
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    Control push;
    push.index = axis;
    push.target = "stirrer";
    push.value[axis] = axis == 1 ? 3.0f : 2.0f;
    seat.controls.push_back(push);
  }
  SceneBody drop;
  drop.name = "drop";
  drop.shapes.push_back(ball_shape(0.45f));
  scene.prefabs.push_back(drop);
  Control spawning;
  spawning.source = Source::kButton;
  spawning.effect = Effect::kSpawn;
  spawning.target = "drop";
  spawning.position = {0.0f, 9.0f, 0.0f};
  spawning.velocity = {0.5f, -2.0f, 0.25f};
  spawning.limit = 8;
  seat.controls.push_back(spawning);
  seat.script.push_back({1, 0, 90, 30, {1.0f, 1.0f, 0.0f, 0.0f}, 0});
  seat.script.push_back({31, 0, 90, 30, {-1.0f, 1.0f, 1.0f, 0.0f}, 0});
  seat.script.push_back({61, 0, 90, 30, {0.0f, 1.0f, -1.0f, 0.0f}, 1});
  scene.seats.push_back(seat);
  return scene;
}

static SceneShape mixed_shape(int i, Random& random) {
  if (i % 3 == 0) return ball_shape(random.between(0.2f, 0.4f));
  if (i % 3 == 1) return box_shape(random.between(0.2f, 0.4f), random.between(0.2f, 0.4f));
  SceneShape shape;
  shape.kind = i % 2 == 0 ? solver::ShapeKind::kCapsule : solver::ShapeKind::kPolygon;
  const float half = random.between(0.2f, 0.35f);
  if (shape.kind == solver::ShapeKind::kCapsule) {
    shape.points = {{-half, 0.0f, 0.0f}, {half, 0.0f, 0.0f}};
    shape.radius = 0.15f;
  } else {
    shape.points = {{-half, -0.2f, 0.0f}, {half, -0.2f, 0.0f}, {0.1f, 0.3f, 0.0f}};
    shape.radius = 0.05f;
  }
  return shape;
}

/// A player: a ball that its seat drives about and that can drop boxes into the room.
static void add_player(Scene& scene, int i, int players, float half_width) {
  const std::string name = "player-" + std::to_string(i);
  SceneBody body;
  body.name = name;
  body.position = {
      (static_cast<float>(i) + 0.5f) / static_cast<float>(players) * 2.0f * half_width - half_width,
      14.0f, 0.0f};
  body.shapes.push_back(ball_shape(0.5f));
  body.shapes[0].density = 3.0f;
  scene.bodies.push_back(body);
  Seat seat;
  seat.name = name;
  Control drive;
  drive.target = name;
  drive.value = {60.0f, 0.0f, 0.0f};
  seat.controls.push_back(drive);
  Control jump;
  jump.source = Source::kButton;
  jump.effect = Effect::kImpulse;
  jump.target = name;
  jump.value = {0.0f, 18.0f, 0.0f};
  seat.controls.push_back(jump);
  Control drop;
  drop.source = Source::kButton;
  drop.index = 1;
  drop.effect = Effect::kSpawn;
  drop.target = "crate";
  drop.position = {body.position[0] * 0.8f, 16.0f, 0.0f};
  drop.velocity = {i % 2 == 0 ? 1.0f : -1.0f, -3.0f, 0.0f};
  drop.limit = 3;
  seat.controls.push_back(drop);
  const auto phase = static_cast<std::uint32_t>(1 + 11 * i);
  const float side = i % 2 == 0 ? 1.0f : -1.0f;
  seat.script.push_back({phase, 0, 120, 60, {side, 0.0f, 0.0f, 0.0f}, 0});
  seat.script.push_back({phase + 60, 0, 120, 60, {-side, 0.0f, 0.0f, 0.0f}, 0});
  seat.script.push_back({phase + 20, 0, 75, 4, {side, 0.0f, 0.0f, 0.0f}, 1});
  seat.script.push_back({phase + 50, 0, 130, 4, {}, 2});
  scene.seats.push_back(seat);
}

Scene room(int bodies) {
  Scene scene = planar_scene("room", "Mixed bodies in a closed room that eight players stir.");
  scene.name += "-" + std::to_string(bodies);
  scene.materials[0] = {"default", 0.5f, 0.1f};
  scene.materials.push_back({"bouncy", 0.2f, 0.6f});
  const int players = 8;
  const float half_width = 12.0f;
  scene.bodies.push_back(box_of_planes(half_width, 0.0f, false));
  Random random{static_cast<std::uint64_t>(bodies)};
  for (int i = 0; i < bodies - players; ++i) {
    SceneBody body;
    body.name = "body-" + std::to_string(i);
    body.position = {static_cast<float>(i % 20) * 1.15f - 11.0f,
                     0.6f + static_cast<float>(i / 20) * 1.05f, 0.0f};
    body.angle = random.between(-1.5f, 1.5f);
    body.shapes.push_back(mixed_shape(i, random));
    if (i % 7 == 0) body.shapes[0].material = "bouncy";
    scene.bodies.push_back(body);
  }
  for (int i = 0; i + 1 < bodies - players; i += 20) {
    SceneJoint joint;
    joint.name = "link-" + std::to_string(i / 20);
    joint.kind = i % 40 == 0 ? solver::JointKind::kRevolute : solver::JointKind::kDistance;
    joint.body_a = "body-" + std::to_string(i);
    joint.body_b = "body-" + std::to_string(i + 1);
    joint.anchor_a = {0.55f, 0.0f, 0.0f};
    joint.anchor_b = {-0.55f, 0.0f, 0.0f};
    joint.length = 0.5f;
    joint.hertz = 4.0f;
    joint.damping_ratio = 0.5f;
    scene.joints.push_back(joint);
  }
  SceneBody crate;
  crate.name = "crate";
  crate.shapes.push_back(box_shape(0.3f, 0.3f));
  scene.prefabs.push_back(crate);
  for (int i = 0; i < players; ++i) add_player(scene, i, players, half_width);
  return scene;
}

}  // namespace cycloid::scenes
