#include "scenes/generators/generators.hpp"
#include "scenes/generators/trial_scenes.hpp"
#include "solver/trig.hpp"

namespace cycloid::scenes {

// A rod of 1 m leans at 63.4 degrees, where Painleve's number is 4/3, and slides on its foot.
static Scene sliding_rod_at(const char* name, float friction, float speed) {
  Scene scene = trial_scene(name, "A leaning rod slides on its foot, with much friction.");
  scene.materials[0].friction = friction;
  const float angle = 63.4349488f * solver::kPi / 180.0f;
  float sine = 0.0f;
  float cosine = 0.0f;
  solver::sin_cos(angle, sine, cosine);
  SceneBody rod = body_at("", {0.5f * cosine, 0.5f * sine + 0.01f, 0.0f},
                          capsule_shape({-0.5f, 0.0f, 0.0f}, {0.5f, 0.0f, 0.0f}, 0.01f));
  rod.angle = angle;
  rod.velocity = {speed, 0.0f, 0.0f};
  scene.bodies = {ground(), rod};
  return scene;
}
Scene trial_rod_forwards() {
  return sliding_rod_at("trial-sliding-rod-forwards", 1.5f, 2.0f);
}
Scene trial_rod_backwards() {
  return sliding_rod_at("trial-sliding-rod-backwards", 1.5f, -2.0f);
}

/// The ground rises by 0.25; a box lies on it.
static Scene ramp(const char* name, const char* summary, float friction) {
  Scene scene = trial_scene(name, summary);
  scene.materials[0].friction = friction;
  const float angle = 0.24497866f;
  float sine = 0.0f;
  float cosine = 0.0f;
  solver::sin_cos(angle, sine, cosine);
  SceneBody slope = ground();
  slope.shapes[0].normal = {-sine, cosine, 0.0f};
  SceneBody box = trial_box(-0.5f * sine, 0.5f * cosine, 0.5f, 25.0f);
  box.angle = angle;
  scene.bodies = {slope, box};
  return scene;
}
Scene trial_ramp_sticks() {
  return ramp("trial-ramp-sticks", "A box on a slope of 0.25 with friction 0.35.", 0.35f);
}
Scene trial_ramp_slides() {
  return ramp("trial-ramp-slides", "A box on a slope of 0.25 with friction 0.1.", 0.1f);
}

static Scene shot(const char* name, float speed) {
  Scene scene = trial_scene(name, "A ball of 5 cm is shot at a wall of 2 cm.");
  scene.gravity = {};
  SceneBody wall = body_at("", {10.0f, 0.0f, 0.0f}, box_shape(0.01f, 5.0f));
  wall.kind = solver::BodyKind::kStatic;
  scene.bodies = {wall};
  for (int i = 0; i < 16; ++i) {
    const float back = 0.173f * static_cast<float>(i);
    SceneBody ball =
        body_at("", {-back, 0.5f * static_cast<float>(i) - 4.0f, 0.0f}, ball_shape(0.05f));
    ball.velocity = {speed, 0.0f, 0.0f};
    scene.bodies.push_back(ball);
  }
  return scene;
}
Scene trial_shot_200() {
  return shot("trial-projectile-200", 200.0f);
}
Scene trial_shot_1000() {
  return shot("trial-projectile-1000", 1000.0f);
}

Scene trial_spinning_rod() {
  Scene scene = trial_scene("trial-spinning-rod", "Rods of 2 m at 50 rad/s come upon small pegs.");
  scene.gravity = {};
  for (int i = 0; i < 8; ++i) {
    const float y = 5.0f * static_cast<float>(i);
    SceneBody peg = body_at("", {0.0f, y, 0.0f}, ball_shape(0.02f));
    peg.kind = solver::BodyKind::kStatic;
    scene.bodies.push_back(peg);
    SceneBody rod =
        body_at("", {-1.5f - 0.02f * static_cast<float>(i), y, 0.0f}, box_shape(1.0f, 0.01f));
    rod.velocity = {1.0f, 0.0f, 0.0f};
    rod.spin = {50.0f, 0.0f, 0.0f};
    scene.bodies.push_back(rod);
  }
  return scene;
}

static Scene wedge(const char* name, float degrees) {
  Scene scene = trial_scene(name, "A ball is pressed into an acute corner without friction.");
  scene.materials[0].friction = 0.0f;
  float sine = 0.0f;
  float cosine = 0.0f;
  solver::sin_cos(0.5f * degrees * solver::kPi / 180.0f, sine, cosine);
  SceneBody corner = ground();
  corner.shapes[0].normal = {cosine, sine, 0.0f};
  corner.shapes.push_back(corner.shapes[0]);
  corner.shapes[1].normal = {-cosine, sine, 0.0f};
  // On one wall, 3 mm from where it would touch both.
  const float aside = 0.003f;
  scene.bodies = {corner,
                  body_at("", {aside, (0.5f + aside * cosine) / sine, 0.0f}, ball_shape(0.5f))};
  return scene;
}
Scene trial_corner_30() {
  return wedge("trial-corner-30", 30.0f);
}
Scene trial_corner_5() {
  return wedge("trial-corner-5", 5.0f);
}

Scene trial_rolling_wheel() {
  Scene scene = trial_scene("trial-rolling-wheel", "A wheel of 0.5 m rolls at 100 rad/s.");
  SceneBody wheel = body_at("", {0.0f, 0.5f, 0.0f}, ball_shape(0.5f));
  wheel.velocity = {50.0f, 0.0f, 0.0f};
  wheel.spin = {-100.0f, 0.0f, 0.0f};
  scene.bodies = {ground(), wheel};
  return scene;
}

static Scene space(const char* name, const char* summary) {
  Scene scene = spatial_scene(name, summary);
  scene.tuning.sleep_s = 0.0f;
  return scene;
}

Scene trial_handle() {
  Scene scene = space("trial-dzhanibekov", "A handle turns about its middle axis.");
  scene.gravity = {};
  SceneBody handle = body_at("", {}, solid_box({0.6f, 0.1f, 0.1f}));
  handle.shapes.push_back(solid_box({0.08f, 0.3f, 0.08f}));
  handle.shapes[1].points = {{0.0f, -0.4f, 0.0f}};
  handle.spin = {0.01f, 5.0f, 0.01f};
  scene.bodies = {handle};
  return scene;
}

Scene trial_needle() {
  Scene scene = space("trial-needle", "A needle, its inertias 100 to 1, spins at 100 rad/s.");
  scene.gravity = {};
  SceneBody needle = body_at("", {}, solid_box({1.0f, 0.0709f, 0.0709f}));
  needle.spin = {100.0f, 1.0f, 0.0f};
  scene.bodies = {needle};
  return scene;
}

Scene trial_duplicate_points() {
  Scene scene =
      space("trial-duplicate-points",
            "A cube at rest on two floors that lie in one another: eight points for four.");
  SceneBody twice = ground();
  twice.shapes.push_back(twice.shapes[0]);
  scene.bodies = {twice, body_at("", {0.0f, 0.5f, 0.0f}, solid_box({0.5f, 0.5f, 0.5f}))};
  return scene;
}

}  // namespace cycloid::scenes
