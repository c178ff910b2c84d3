#include "scenes/generators/generators.hpp"

namespace cycloid::scenes {

static SceneBody fixed_ball(float x, float y, float z, float radius) {
  SceneBody body;
  body.kind = solver::BodyKind::kStatic;
  body.position = {x, y, z};
  body.shapes = {ball_shape(radius)};
  return body;
}

static Cloth rope(const Triple& from, const Triple& step, std::uint32_t count) {
  Cloth cloth;
  cloth.name = "rope";
  cloth.origin = from;
  cloth.across = step;
  cloth.columns = count;
  cloth.pins = {{0, 0, ""}};
  return cloth;
}

/// Enough for cloths that are looked at: they stretch by a few per cent, at a third of the cost.
static void set_particle_tuning(Scene& scene) {
  scene.tuning.particle_substeps = 12;
  scene.tuning.particle_sweeps = 4;
}

/// A ball that a seat throws at what hangs.
static void add_ball_thrower(Scene& scene) {
  add_thrower(scene, {-6.0f, 2.5f, 0.0f}, {7.0f, 3.0f, 0.0f});
}

Scene cloth(int columns) {
  Scene scene = planar_scene("cloth", "A net hangs by two corners over a ball; a rope over a box");
  scene.bodies = {ground(), fixed_ball(0.3f, 1.0f, 0.0f, 0.4f)};
  SceneBody box;
  box.name = "box";
  box.kind = solver::BodyKind::kStatic;
  box.position = {3.0f, 0.5f};
  box.shapes = {box_shape(0.5f, 0.5f)};
  scene.bodies.push_back(box);
  Cloth net;
  net.name = "net";
  net.origin = {-1.0f, 3.0f, 0.0f};
  const float spacing = 2.0f / static_cast<float>(columns - 1);
  net.across = {spacing, 0.0f, 0.0f};
  net.down = {0.0f, -0.5f * spacing, 0.0f};
  net.columns = static_cast<std::uint32_t>(columns);
  net.rows = static_cast<std::uint32_t>(columns) / 2;
  net.shear_compliance = 1.0e-3f;
  net.pins = {{0, 0, ""}, {net.columns - 1, 0, ""}};
  set_particle_tuning(scene);
  scene.cloths = {net, rope({2.2f, 3.0f, 0.0f}, {0.08f, 0.0f, 0.0f}, 30)};
  add_ball_thrower(scene);
  return scene;
}

Scene cloth_3d(int columns) {
  Scene scene;
  scene.name = "cloth-3d";
  scene.summary =
      "A cloth falls over a ball, a box and a capsule, another hangs by two corners, and a rope "
      "swings";
  scene.dimension = 3;
  scene.gravity = {0.0f, -10.0f, 0.0f};
  scene.materials = {{"default", 0.5f, 0.0f, 0.0f}};
  SceneBody floor;
  floor.kind = solver::BodyKind::kStatic;
  SceneShape half_space;
  half_space.kind = solver::ShapeKind::kHalfSpace;
  half_space.normal = {0.0f, 1.0f, 0.0f};
  floor.shapes = {half_space};
  scene.bodies = {floor, fixed_ball(0.0f, 0.8f, 0.0f, 0.6f)};
  // The sheet's corners come down on a box and a capsule, the rope swings over the box.
  SceneBody corner = body_at("", {-0.9f, 0.3f, 0.9f}, solid_box({0.3f, 0.3f, 0.3f}));
  corner.kind = solver::BodyKind::kStatic;
  scene.bodies.push_back(corner);
  SceneBody log = body_at("", {0.9f, 0.3f, -0.9f},
                          capsule_shape({-0.4f, 0.0f, 0.0f}, {0.4f, 0.2f, 0.0f}, 0.2f));
  log.kind = solver::BodyKind::kStatic;
  scene.bodies.push_back(log);
  const float spacing = 2.0f / static_cast<float>(columns - 1);
  Cloth sheet;
  sheet.name = "sheet";
  sheet.origin = {-1.0f, 1.8f, -1.0f};
  sheet.across = {spacing, 0.0f, 0.0f};
  sheet.down = {0.0f, 0.0f, spacing};
  sheet.columns = static_cast<std::uint32_t>(columns);
  sheet.rows = sheet.columns;
  sheet.shear_compliance = 1.0e-3f;
  Cloth flag = sheet;
  flag.name = "flag";
  flag.origin = {2.0f, 3.0f, 0.0f};
  flag.down = {0.0f, 0.0f, spacing};
  flag.pins = {{0, 0, ""}, {sheet.columns - 1, 0, ""}};
  set_particle_tuning(scene);
  scene.cloths = {sheet, flag, rope({-2.0f, 3.0f, 0.0f}, {0.08f, 0.0f, 0.0f}, 30)};
  add_ball_thrower(scene);
  return scene;
}

}  // namespace cycloid::scenes
