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

SceneShape ball_shape(float radius) {
  SceneShape shape;
  shape.radius = radius;
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

Scene planar_scene(const char* name, const char* summary) {
  Scene scene;
  scene.name = name;
  scene.summary = summary;
  scene.gravity = {0.0f, -10.0f, 0.0f};
  scene.materials.push_back({"default", 0.6f, 0.0f});
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
