#include "scenes/generators/generators.hpp"
#include "solver/trig.hpp"

namespace cycloid::scenes {

static constexpr std::uint32_t kJumpButton = 1;  ///< As a bit.
static constexpr float kRampTop = 1.5f;
static constexpr float kPlateau = kRampTop + 0.9f;  ///< Three stairs higher, m.

static void add_block(SceneBody& course, const Triple& middle, const Triple& half) {
  SceneShape block = solid_box(half);
  block.points = {middle};
  course.shapes.push_back(block);
}

/// A slab that rises from `foot` at z = 0 along x by `angle` rad: `length` m of its upper face.
static void add_slope(SceneBody& course, const Triple& foot, float angle, float length) {
  float sine = 0.0f;
  float cosine = 0.0f;
  solver::sin_cos(angle, sine, cosine);
  constexpr float kThick = 0.2f;
  SceneShape slab = solid_box({0.5f * length, kThick, 2.0f});
  slab.points = {{foot[0] + 0.5f * length * cosine + kThick * sine,
                  foot[1] + 0.5f * length * sine - kThick * cosine, 0.0f}};
  solver::sin_cos(0.5f * angle, slab.rotation[2], slab.rotation[3]);
  course.shapes.push_back(slab);
}

/// From left to right: a slope of 55 degrees, a run, a ramp of 30 degrees, stairs, a plateau with
/// a gap, two walls that meet in a corner of 10 degrees, and a mesh of hills to walk down.
static SceneBody course() {
  SceneBody body = ground();
  add_slope(body, {-2.0f, 0.0f, 0.0f}, solver::kPi - 55.0f / 180.0f * solver::kPi, 4.0f);
  add_slope(body, {4.0f, 0.0f, 0.0f}, solver::kPi / 6.0f, 3.0f);
  const float top = 4.0f + 3.0f * 0.8660254f;
  add_block(body, {top + 0.75f, 0.5f * kRampTop, 0.0f}, {0.75f, 0.5f * kRampTop, 2.0f});
  for (int i = 1; i <= 3; ++i) {
    const float height = kRampTop + 0.3f * static_cast<float>(i);
    const float x = top + 1.5f + 0.4f * static_cast<float>(i);
    add_block(body, {x - 0.2f, 0.5f * height, 0.0f}, {0.2f, 0.5f * height, 2.0f});
  }
  const float plateau = top + 2.7f;
  add_block(body, {plateau + 2.0f, 0.5f * kPlateau, 0.0f}, {2.0f, 0.5f * kPlateau, 2.0f});
  add_block(body, {plateau + 8.0f, 0.5f * kPlateau, 0.0f}, {2.5f, 0.5f * kPlateau, 3.0f});
  // A funnel of two walls at the far end, 10 degrees between them.
  for (const float side : {-1.0f, 1.0f}) {
    SceneShape wall = solid_box({1.5f, 1.0f, 0.1f});
    float sine = 0.0f;
    float cosine = 0.0f;
    solver::sin_cos(side * 2.5f / 180.0f * solver::kPi, sine, cosine);
    wall.points = {{plateau + 9.0f, kPlateau + 1.0f, side * 0.32f}};
    wall.rotation = {0.0f, sine, 0.0f, cosine};
    body.shapes.push_back(wall);
  }
  return body;
}

/// A landscape of its own, off to the side: what it stands on there is triangles.
static SceneBody hills() {
  SceneBody body = frame();
  body.name = "hills";
  SceneShape& field = body.shapes.emplace_back();
  field.kind = solver::ShapeKind::kHeightField;
  field.columns = 13;
  field.cell = {1.0f, 1.0f};
  field.points = {{-6.0f, 0.0f, 4.0f}};
  for (int row = 0; row < 9; ++row)
    for (int column = 0; column < 13; ++column) {
      float sine = 0.0f;
      float cosine = 0.0f;
      solver::sin_cos(0.7f * static_cast<float>(column + 2 * row), sine, cosine);
      field.heights.push_back(0.05f + 0.3f * (1.0f + sine) * (row > 0 ? 1.0f : 0.0f));
    }
  return body;
}

static void add_walker(Scene& scene, const std::string& name, const Triple& position) {
  SceneCharacter walker;
  walker.name = name;
  walker.position = position;
  walker.speed = 4.0f;
  scene.characters.push_back(walker);
  Seat& seat = scene.seats.emplace_back();
  seat.name = name;
  seat.controls = {walk_control(0, name, {1.0f, 0.0f, 0.0f}),
                   walk_control(1, name, {0.0f, 0.0f, 1.0f}), jump_control(name)};
}

static ScriptEntry walk_both(std::uint32_t from, std::uint32_t until, float x, float z) {
  ScriptEntry entry = walk_entry(from, until, x, 0);
  entry.axes[1] = z;
  return entry;
}

Scene character_course_3d() {
  Scene scene = spatial_scene("character-course-3d",
                              "Two capsules that walk: over a ramp, stairs, a gap and into a "
                              "corner; and over hills.");
  scene.bodies = {course(), hills()};
  SceneBody crate =
      body_at("crate", {9.5f + 3.0f, kPlateau + 0.35f, 0.29f}, solid_box({0.35f, 0.35f, 0.35f}));
  crate.shapes[0].density = 100.0f;
  scene.bodies.push_back(crate);
  for (int i = 0; i < 4; ++i)
    scene.bodies.push_back(body_at("", {-1.0f + 0.8f * static_cast<float>(i), 1.2f, 8.0f},
                                   i % 2 == 0 ? solid_box({0.2f, 0.2f, 0.2f}) : ball_shape(0.2f)));
  add_walker(scene, "climber", {0.0f, 0.02f, 0.0f});
  add_walker(scene, "wanderer", {0.0f, 1.0f, 6.0f});
  scene.seats[0].script = {walk_entry(1, 60, -1.0f, 0), walk_entry(60, 0, 1.0f, 0),
                           walk_both(200, 215, 1.0f, 0.3f), walk_entry(300, 0, 1.0f, 0)};
  ScriptEntry leap = walk_entry(298, 0, 1.0f, kJumpButton);
  leap.every = 40;
  leap.hold = 2;
  scene.seats[0].script.push_back(leap);
  scene.seats[1].script = {walk_both(20, 140, 1.0f, 0.5f), walk_both(140, 320, -1.0f, 0.2f),
                           walk_both(320, 460, 0.4f, -1.0f), walk_both(460, 0, 0.7f, 0.7f)};
  return scene;
}

}  // namespace cycloid::scenes
