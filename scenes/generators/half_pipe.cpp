#include "scenes/generators/generators.hpp"
#include "solver/trig.hpp"

namespace cycloid::scenes {

static constexpr int kEdges = 128;
static constexpr float kHeight = 3.0f;  ///< m, from rim to bottom, of both ramps.
static constexpr float kRider = 0.3f;   ///< m, radius.
static constexpr float kStart = 2.6f;   ///< m, height of the riders' centres at the start.

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

/// One arch of the cycloid x = r (t - sin t), y = r (1 + cos t), turned to a bowl: of all curves
/// the one on which every start takes the same time to the bottom, and none takes less.
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

struct Place {
  float x;
  float y;
};

/// Where a rider's centre is while it touches the circle, seen from the ramp's middle.
static Place on_circle(float height) {
  const float radius = kHeight - kRider;
  const float below = kHeight - height;
  return {-solver::sqrt(radius * radius - below * below), height};
}

/// The same on the cycloid: the curve at t, and from there the rider's radius along the normal
/// (cos t/2, sin t/2). The height falls as t grows, so halving finds it.
static Place on_cycloid(float height) {
  const float r = 0.5f * kHeight;
  float low = 0.2f;
  float high = 3.0f;
  Place place{};
  for (int i = 0; i < 40; ++i) {
    const float t = 0.5f * (low + high);
    float sine = 0.0f;
    float cosine = 0.0f;
    float half_sine = 0.0f;
    float half_cosine = 0.0f;
    solver::sin_cos(t, sine, cosine);
    solver::sin_cos(0.5f * t, half_sine, half_cosine);
    place = {r * (t - sine) + kRider * half_cosine - r * solver::kPi,
             r * (1.0f + cosine) + kRider * half_sine};
    (place.y > height ? low : high) = t;
  }
  return place;
}

static SceneBody rider(const char* name, float x, float y) {
  SceneBody body;
  body.name = name;
  body.position = {x, y, 0.0f};
  body.mass = 80.0f;
  body.shapes.push_back(ball_shape(kRider));
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
  Scene scene = planar_scene("half-pipe", "Two riders: one ramp is a circle, the other a cycloid.");
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
  // Both start at the same height, at rest on their ramp.
  const Place circle_start = on_circle(kStart);
  const Place cycloid_start = on_cycloid(kStart);
  scene.bodies.push_back(rider("circle", circle_x + circle_start.x, circle_start.y));
  scene.bodies.push_back(rider("cycloid", cycloid_x + cycloid_start.x, cycloid_start.y));
  scene.seats.push_back(seat_of("circle", 0));
  scene.seats.push_back(seat_of("cycloid", 0));
  return scene;
}

}  // namespace cycloid::scenes
