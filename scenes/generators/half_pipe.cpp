#include "scenes/generators/generators.hpp"
#include "solver/trig.hpp"

namespace cycloid::scenes {

static constexpr int kEdges = 128;
static constexpr float kHeight = 3.0f;  ///< m, from rim to bottom, of both ramps.

static SceneShape chain_of(std::vector<Triple> points) {
  SceneShape shape;
  shape.kind = solver::ShapeKind::kChain;
  shape.points = std::move(points);
  return shape;
}

/// A half circle of radius kHeight, from rim to rim through the bottom, with upright ends.
static std::vector<Triple> circle(float centre_x) {
  std::vector<Triple> points = {{centre_x - kHeight, kHeight + 3.0f, 0.0f}};
  for (int i = 0; i <= kEdges; ++i) {
    const float angle = solver::kPi * (1.0f + static_cast<float>(i) / kEdges);
    float sine = 0.0f;
    float cosine = 0.0f;
    solver::sin_cos(angle, sine, cosine);
    points.push_back({centre_x + kHeight * cosine, kHeight + kHeight * sine, 0.0f});
  }
  points.push_back({centre_x + kHeight, kHeight + 3.0f, 0.0f});
  return points;
}

/// One arch of the cycloid x = r (t - sin t), y = r (1 + cos t), turned to a bowl: of all curves the
/// one on which every start takes the same time to the bottom, and none takes less.
static std::vector<Triple> cycloid(float centre_x) {
  const float r = 0.5f * kHeight;
  const float half_width = r * solver::kPi;
  std::vector<Triple> points = {{centre_x - half_width, kHeight + 3.0f, 0.0f}};
  for (int i = 0; i <= kEdges; ++i) {
    const float t = 2.0f * solver::kPi * (static_cast<float>(i) / kEdges);
    float sine = 0.0f;
    float cosine = 0.0f;
    solver::sin_cos(t, sine, cosine);
    points.push_back({centre_x - half_width + r * (t - sine), r * (1.0f + cosine), 0.0f});
  }
  points.push_back({centre_x + half_width, kHeight + 3.0f, 0.0f});
  return points;
}

static SceneBody rider(const char* name, float x, float y) {
  SceneBody body;
  body.name = name;
  body.position = {x, y, 0.0f};
  body.mass = 80.0f;
  body.shapes.push_back(ball_shape(0.3f));
  body.shapes[0].material = "wheels";
  return body;
}

/// Pumps: pushes along the ride for a third of a second, alternately, and hops now and then.
static Seat seat_of(const char* name, std::uint32_t phase) {
  Seat seat;
  seat.name = name;
  Control push;
  push.target = name;
  push.value = {160.0f, 0.0f, 0.0f};
  seat.controls.push_back(push);
  Control hop;
  hop.source = Source::kButton;
  hop.effect = Effect::kImpulse;
  hop.target = name;
  hop.value = {0.0f, 120.0f, 0.0f};
  seat.controls.push_back(hop);
  ScriptEntry right;
  right.from = 60 + phase;
  right.every = 160;
  right.hold = 20;
  right.axes = {1.0f, 0.0f, 0.0f, 0.0f};
  seat.script.push_back(right);
  ScriptEntry left = right;
  left.from += 80;
  left.axes[0] = -1.0f;
  seat.script.push_back(left);
  ScriptEntry hopping;
  hopping.from = 150 + phase;
  hopping.every = 300;
  hopping.hold = 3;
  hopping.buttons = 1;
  seat.script.push_back(hopping);
  return seat;
}

Scene half_pipe() {
  Scene scene =
      planar_scene("half-pipe", "Two riders: one ramp is a circle, the other a cycloid.");
  scene.materials[0].name = "ramp";
  scene.materials.push_back({"wheels", 0.0f, 0.0f});
  const float circle_x = -5.0f;
  const float cycloid_x = 5.0f;
  SceneBody ramps;
  ramps.name = "ramps";
  ramps.kind = solver::BodyKind::kStatic;
  ramps.shapes.push_back(chain_of(circle(circle_x)));
  ramps.shapes.push_back(chain_of(cycloid(cycloid_x)));
  scene.bodies.push_back(ramps);
  // Both start at the same height, at rest against the ramp or just above it.
  scene.bodies.push_back(rider("circle", circle_x - 2.55f, 2.75f));
  scene.bodies.push_back(rider("cycloid", cycloid_x - 3.85f, 2.75f));
  scene.seats.push_back(seat_of("circle", 0));
  scene.seats.push_back(seat_of("cycloid", 0));
  return scene;
}

}  // namespace cycloid::scenes
