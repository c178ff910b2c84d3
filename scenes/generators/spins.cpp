#include "scenes/generators/generators.hpp"
#include "solver/trig.hpp"

namespace cycloid::scenes {

Scene dzhanibekov() {
  Scene scene = spatial_scene("dzhanibekov", "A handle spins about its middle axis in free fall.");
  scene.gravity = {};
  // A bar and a shorter one across its middle: three different moments.
  SceneBody handle = body_at("handle", {}, solid_box({0.6f, 0.1f, 0.1f}));
  handle.shapes.push_back(solid_box({0.08f, 0.3f, 0.08f}));
  handle.shapes[1].points = {{0.0f, -0.4f, 0.0f}};
  handle.spin = {0.01f, 5.0f, 0.01f};
  scene.bodies.push_back(handle);
  SceneBody wing = body_at("wing", {3.0f, 0.0f, 0.0f}, solid_box({0.8f, 0.05f, 0.4f}));
  wing.spin = {0.01f, 0.02f, 6.0f};
  scene.bodies.push_back(wing);
  Seat seat;
  seat.name = "hand";
  Control twist = force_control(0, "wing", {0.05f, 0.0f, 0.0f});
  twist.effect = Effect::kTorque;
  seat.controls.push_back(twist);
  seat.script.push_back({300, 0, 300, 10, {1.0f, 0.0f, 0.0f, 0.0f}, 0});
  scene.seats.push_back(seat);
  return scene;
}

/// A disc of 16 corners on a thin stem; the tip of the stem is the origin of the body.
static SceneBody top_at(const std::string& name, const Triple& tip, float tilt, float rate) {
  SceneShape disc;
  disc.kind = solver::ShapeKind::kHull;
  for (int i = 0; i < 16; ++i) {
    float sine = 0.0f;
    float cosine = 0.0f;
    solver::sin_cos(0.125f * solver::kPi * static_cast<float>(i), sine, cosine);
    for (const float y : {0.45f, 0.55f}) disc.points.push_back({0.4f * cosine, y, 0.4f * sine});
  }
  SceneBody top = body_at(name, tip, disc);
  SceneShape stem = capsule_shape({0.0f, 0.05f, 0.0f}, {0.0f, 0.7f, 0.0f}, 0.04f);
  top.shapes.push_back(stem);
  float sine = 0.0f;
  float cosine = 0.0f;
  solver::sin_cos(0.5f * tilt, sine, cosine);
  top.rotation = {0.0f, 0.0f, sine, cosine};
  solver::sin_cos(tilt, sine, cosine);
  top.spin = {-rate * sine, rate * cosine, 0.0f};
  return top;
}

Scene top() {
  Scene scene = spatial_scene("top", "Three tops on pivots: asleep, in precession, and falling.");
  scene.bodies.push_back(ground());
  const char* names[3] = {"sleeping", "precessing", "falling"};
  const float tilts[3] = {0.002f, 0.4f, 0.05f};
  const float rates[3] = {60.0f, 60.0f, 8.0f};
  for (int i = 0; i < 3; ++i) {
    const Triple tip = {2.0f * static_cast<float>(i) - 2.0f, 1.0f, 0.0f};
    scene.bodies.push_back(top_at(names[i], tip, tilts[i], rates[i]));
    scene.joints.push_back(
        joint_between(solver::JointKind::kRevolute, "ground", tip, names[i], {}));
  }
  Seat seat;
  seat.name = "finger";
  seat.controls.push_back(impulse_control(0, "sleeping", {0.02f, 0.0f, 0.0f}));
  seat.script.push_back({240, 0, 240, 3, {}, 1});
  scene.seats.push_back(seat);
  return scene;
}

}  // namespace cycloid::scenes
