#include "scenes/generators/generators.hpp"
#include "scenes/generators/trial_scenes.hpp"
#include "solver/trig.hpp"

namespace cycloid::scenes {

Scene trial_scene(const char* name, const char* summary) {
  Scene scene = planar_scene(name, summary);
  scene.tuning.sleep_s = 0.0f;
  return scene;
}

Scene quiet(Scene scene, const char* name) {
  scene.name = name;
  scene.tuning.sleep_s = 0.0f;
  scene.prefabs.clear();
  scene.seats.clear();
  return scene;
}

SceneBody trial_box(float x, float y, float half, float density) {
  SceneBody body = body_at("", {x, y, 0.0f}, box_shape(half, half));
  body.shapes[0].density = density;
  return body;
}

static Scene heavy_on_light_at(const char* name, float ratio) {
  Scene scene = trial_scene(name, "A box under another of many times its mass.");
  scene.bodies = {ground(), trial_box(0.0f, 0.5f, 0.5f, 1.0f), trial_box(0.0f, 1.5f, 0.5f, ratio)};
  return scene;
}
Scene trial_heavy_10() {
  return heavy_on_light_at("trial-heavy-on-light-10", 10.0f);
}
Scene trial_heavy_100() {
  return heavy_on_light_at("trial-heavy-on-light-100", 100.0f);
}
Scene trial_heavy_1000() {
  return heavy_on_light_at("trial-heavy-on-light-1000", 1000.0f);
}

Scene trial_stack_10() {
  return quiet(stack(10), "trial-stack-10");
}
Scene trial_stack_20() {
  return quiet(stack(20), "trial-stack-20");
}
Scene trial_stack_30() {
  return quiet(stack(30), "trial-stack-30");
}

/// Boxes in a pyramid about x, and one of `apex` kg falling 2 m onto its top.
static void add_pyramid(Scene& scene, float x, int base, float apex) {
  for (int row = 0; row < base; ++row)
    for (int i = 0; i < base - row; ++i) {
      const float across = static_cast<float>(i) - 0.5f * static_cast<float>(base - row - 1);
      const bool top = row + 1 == base && apex > 0.0f;
      const float y = 0.5f + static_cast<float>(row) + (top ? 2.0f : 0.0f);
      scene.bodies.push_back(trial_box(x + across, y, 0.5f, top ? apex : 1.0f));
    }
}

Scene trial_pyramid() {
  Scene scene = trial_scene("trial-pyramid-20", "A pyramid of 210 unit boxes.");
  scene.bodies.push_back(ground());
  add_pyramid(scene, 0.0f, 20, 0.0f);
  return scene;
}

// Source of the measures: Catto's Solver2D (2024), High Mass Ratio 1 to 3.
Scene trial_heavy_apexes() {
  Scene scene = trial_scene("trial-heavy-apexes", "100, 200 and 300 kg fall onto three pyramids.");
  scene.materials[0].friction = 0.5f;
  scene.bodies.push_back(ground());
  for (int i = 0; i < 3; ++i)
    add_pyramid(scene, 30.0f * static_cast<float>(i - 1), 10, 100.0f * static_cast<float>(i + 1));
  return scene;
}

static Scene heavy_on_two(const char* name, const char* summary, const SceneBody& below) {
  Scene scene = trial_scene(name, summary);
  scene.bodies = {below, trial_box(-9.0f, 0.5f, 0.5f, 1.0f), trial_box(9.0f, 0.5f, 0.5f, 1.0f),
                  trial_box(0.0f, 16.0f, 10.0f, 1.0f)};
  return scene;
}
Scene trial_thin_ground() {
  SceneBody line = ground();
  line.shapes = {chain_shape({{-40.0f, 0.0f, 0.0f}, {40.0f, 0.0f, 0.0f}}, false)};
  return heavy_on_two("trial-400-on-thin-ground",
                      "400 m^2 of box fall on two of 1 m^2 that stand on a line.", line);
}
Scene trial_thick_ground() {
  return heavy_on_two("trial-400-on-thick-ground",
                      "400 m^2 of box fall on two of 1 m^2 that stand on a half-space.", ground());
}

static Scene box_on_pole(const char* name, float half) {
  Scene scene = trial_scene(name, "A box of 2 m balances on a pole that is much narrower.");
  SceneBody pole = body_at("", {0.0f, -1.0f, 0.0f}, box_shape(half, 1.0f));
  pole.kind = solver::BodyKind::kStatic;
  scene.bodies = {pole, trial_box(0.003f, 1.0f, 1.0f, 1.0f)};
  return scene;
}
Scene trial_pole_25() {
  return box_on_pole("trial-box-on-pole-25", 0.25f);
}
Scene trial_pole_5() {
  return box_on_pole("trial-box-on-pole-5", 0.05f);
}

Scene trial_tall_box() {
  Scene scene = trial_scene("trial-tall-box",
                            "A box four times as tall as wide lands on an edge of its foot.");
  scene.bodies = {ground(), body_at("", {0.0f, 2.05f, 0.0f}, box_shape(0.5f, 2.0f))};
  scene.bodies[1].angle = 0.02f;
  return scene;
}

Scene trial_card_house() {
  return quiet(card_house(5), "trial-card-house");
}

/// A point at `share` of half a circle from the right.
static Triple on_circle(float radius, float share) {
  float sine = 0.0f;
  float cosine = 0.0f;
  solver::sin_cos(solver::kPi * share, sine, cosine);
  return {radius * cosine, radius * sine, 0.0f};
}

Scene trial_arch() {
  Scene scene = trial_scene("trial-arch", "Seventeen stones in half a circle, held by friction.");
  scene.bodies.push_back(ground());
  constexpr float kStones = 17.0f;
  for (float i = 0.0f; i < kStones; i += 1.0f) {
    const Triple middle = on_circle(4.5f, (i + 0.5f) / kStones);
    SceneShape stone;
    stone.kind = solver::ShapeKind::kPolygon;
    stone.points = {on_circle(5.0f, i / kStones), on_circle(5.0f, (i + 1.0f) / kStones),
                    on_circle(4.0f, (i + 1.0f) / kStones), on_circle(4.0f, i / kStones)};
    for (Triple& point : stone.points)
      for (std::size_t axis = 0; axis < 2; ++axis) point[axis] -= middle[axis];
    scene.bodies.push_back(body_at("", middle, stone));
  }
  return scene;
}

Scene trial_overlap() {
  return quiet(overlap(4), "trial-overlap");
}

Scene trial_confined() {
  Scene scene = trial_scene("trial-confined", "625 discs in a box that has room for 324.");
  scene.gravity = {};
  for (int side = 0; side < 4; ++side) {
    const bool across = side < 2;
    const float place = side % 2 == 0 ? -10.0f : 10.0f;
    SceneBody wall = body_at("", {across ? 0.0f : place, across ? place : 0.0f, 0.0f},
                             across ? box_shape(12.0f, 1.0f) : box_shape(1.0f, 12.0f));
    wall.kind = solver::BodyKind::kStatic;
    scene.bodies.push_back(wall);
  }
  for (int i = 0; i < 625; ++i) {
    const auto column = static_cast<float>(i % 25);
    const auto row = static_cast<float>(i / 25);
    scene.bodies.push_back(
        body_at("", {0.7f * (column - 12.0f), 0.7f * (row - 12.0f), 0.0f}, ball_shape(0.5f)));
  }
  return scene;
}

Scene trial_dropped_load() {
  Scene scene = trial_scene("trial-warm-start-removal",
                            "Three discs of densities 1, 1 and 100; the heavy one is taken away.");
  scene.bodies.push_back(ground());
  for (int i = 0; i < 3; ++i) {
    scene.bodies.push_back(
        body_at("", {0.0f, 0.5f + static_cast<float>(i), 0.0f}, ball_shape(0.5f)));
    scene.bodies.back().shapes[0].density = i == 2 ? 100.0f : 1.0f;
  }
  return scene;
}

Scene trial_dominoes() {
  Scene scene = trial_scene("trial-double-domino", "Fifteen dominoes; the first is pushed.");
  scene.bodies.push_back(ground());
  for (int i = 0; i < 15; ++i)
    scene.bodies.push_back(
        body_at("", {static_cast<float>(i) - 7.0f, 0.5f, 0.0f}, box_shape(0.125f, 0.5f)));
  scene.bodies[1].velocity = {0.8f, 0.0f, 0.0f};
  scene.bodies[1].spin = {-2.0f, 0.0f, 0.0f};
  return scene;
}

Scene trial_far_stack() {
  Scene scene = trial_scene("trial-far-stack", "Five boxes at 47 km from the origin.");
  SceneBody slab = body_at("", {40000.0f, -25001.0f, 0.0f}, box_shape(10.0f, 1.0f));
  slab.kind = solver::BodyKind::kStatic;
  scene.bodies.push_back(slab);
  for (int i = 0; i < 5; ++i)
    scene.bodies.push_back(
        trial_box(40000.0f, -25000.0f + 0.5f + static_cast<float>(i), 0.5f, 1.0f));
  return scene;
}

Scene trial_marble() {
  Scene scene = trial_scene("trial-marble", "A marble of 1 mm on a slab of 100 m.");
  SceneBody slab = body_at("", {0.0f, -1.0f, 0.0f}, box_shape(50.0f, 1.0f));
  slab.kind = solver::BodyKind::kStatic;
  scene.bodies = {slab, body_at("", {0.0f, 0.001f, 0.0f}, ball_shape(0.001f))};
  return scene;
}

Scene trial_pebble() {
  Scene scene = trial_scene("trial-pebble", "A pebble of 5 cm under one edge of a box of 10 m.");
  SceneBody box = trial_box(0.0f, 5.1f, 5.0f, 1.0f);
  scene.bodies = {ground(), body_at("", {4.0f, 0.05f, 0.0f}, ball_shape(0.05f)), box};
  return scene;
}

Scene trial_reversed() {
  Scene scene = trial_pyramid();
  scene.name = "trial-order";
  scene.summary = "A pyramid of ten whose boxes are made from the top down.";
  scene.bodies.resize(1);
  add_pyramid(scene, 0.0f, 10, 0.0f);
  for (std::size_t i = 1, j = scene.bodies.size() - 1; i < j; ++i, --j)
    std::swap(scene.bodies[i], scene.bodies[j]);
  return scene;
}

Scene trial_rush() {
  Scene scene = trial_scene("trial-rush", "400 heavy discs are drawn to one point with 1 kN each.");
  scene.gravity = {};
  for (int i = 0; i < 400; ++i) {
    const auto column = static_cast<float>(i % 20);
    const auto row = static_cast<float>(i / 20);
    SceneBody disc =
        body_at("", {1.5f * (column - 9.5f), 1.5f * (row - 9.5f), 0.0f}, ball_shape(0.5f));
    disc.shapes[0].density = 100.0f;
    scene.bodies.push_back(disc);
  }
  return scene;
}

Scene trial_substeps_change() {
  Scene scene = quiet(stack(10), "trial-substeps-change");
  scene.summary = "A stack of ten whose substeps become fewer while it stands.";
  return scene;
}

}  // namespace cycloid::scenes
