#include <algorithm>

#include "bench/worlds/bench_worlds.hpp"
#include "bench/worlds/parts.hpp"

namespace cycloid::worlds {

/// Unit boxes that touch, row on row; its lowest row stands on y = `floor`.
static void add_pyramid(Scene& scene, int base, float middle, float floor) {
  for (int row = 0; row < base; ++row)
    for (int i = 0; i < base - row; ++i) {
      const float x = static_cast<float>(i) - 0.5f * static_cast<float>(base - row - 1);
      add_body(scene, {middle + x, floor + 0.5f + static_cast<float>(row), 0.0f},
               scenes::box_shape(0.5f, 0.5f));
    }
}

Scene box_pyramid(int base) {
  Scene scene = plane_scene("Unit boxes in a pyramid.", 0.6f, 0.0f);
  add_wall(scene, {0.0f, -1.0f, 0.0f}, 100.0f, 1.0f);
  add_pyramid(scene, base, 0.0f, 0.0f);
  return scene;
}

/// Pyramids of ten boxes' base, twelve metres apart, `columns` of them on each floor.
static void add_pyramids(Scene& scene, int count, int columns) {
  constexpr int kBase = 10;
  const int rows = (count + columns - 1) / columns;
  const float width = 12.0f * static_cast<float>(columns);
  for (int row = 0; row < rows; ++row) {
    const float floor = 14.0f * static_cast<float>(row);
    add_wall(scene, {0.5f * (width - 12.0f), floor - 0.5f, 0.0f}, 0.5f * width + 2.0f, 0.5f);
    for (int i = 0; i < std::min(columns, count - row * columns); ++i)
      add_pyramid(scene, kBase, 12.0f * static_cast<float>(i), floor);
  }
}

Scene many_pyramids(int side) {
  Scene scene = plane_scene("Pyramids of 55 boxes in rows, each row on its floor.", 0.6f, 0.0f);
  add_pyramids(scene, side * side, side);
  return scene;
}

Scene pyramid_field(int bodies) {
  constexpr int kEach = 55;
  Scene scene = plane_scene("Pyramids of 55 boxes, more or fewer of them.", 0.6f, 0.0f);
  const int count = (bodies + kEach - 1) / kEach;
  int columns = 1;
  while (columns * columns < count) ++columns;
  add_pyramids(scene, count, columns);
  return scene;
}

Scene sleeping_field(int bodies) {
  Scene scene = plane_scene("Boxes that sleep, beside one pyramid on a turntable.", 0.6f, 0.0f);
  // The floor of the pyramid moves by less than a sleeper's reach, and so keeps it awake.
  SceneBody table = scenes::body_at("", {0.0f, -0.5f, 0.0f}, scenes::box_shape(8.0f, 0.5f));
  table.kind = solver::BodyKind::kKinematic;
  table.velocity = {0.1f, 0.0f, 0.0f};
  scene.bodies.push_back(table);
  add_pyramid(scene, 10, 0.0f, 0.0f);
  const int sleepers = std::max(0, bodies - 55);
  constexpr int kColumns = 200;
  const int rows = (sleepers + kColumns - 1) / kColumns;
  for (int row = 0; row < rows; ++row)
    add_wall(scene, {400.0f, 4.0f * static_cast<float>(row) - 0.5f, 0.0f}, 220.0f, 0.5f);
  for (int i = 0; i < sleepers; ++i)
    add_body(scene,
             {200.0f + 2.0f * static_cast<float>(i % kColumns),
              4.0f * static_cast<float>(i / kColumns) + 0.5f, 0.0f},
             scenes::box_shape(0.5f, 0.5f));
  return scene;
}

Scene falling_balls(int balls) {
  Scene scene = plane_scene("Balls that fall into a bin.", 0.4f, 0.2f);
  constexpr int kColumns = 60;
  add_bin(scene, 0.45f * kColumns + 0.5f, 80.0f);
  scenes::Random random{17};
  for (int i = 0; i < balls; ++i) {
    const float x = 0.9f * (static_cast<float>(i % kColumns) - 0.5f * (kColumns - 1));
    add_body(scene,
             {x + random.between(-0.02f, 0.02f), 0.5f + 0.9f * static_cast<float>(i / kColumns), 0},
             scenes::ball_shape(random.between(0.25f, 0.42f)));
  }
  return scene;
}

Scene smash(int columns) {
  Scene scene = plane_scene("A heavy box flies into a block of small ones.", 0.6f, 0.0f);
  scene.gravity = {};
  add_body(scene, {-20.0f, 0.0f, 0.0f}, scenes::box_shape(4.0f, 4.0f));
  scene.bodies.back().shapes[0].density = 8.0f;
  scene.bodies.back().velocity = {40.0f, 0.0f, 0.0f};
  const int rows = columns * 2 / 3;
  for (int i = 0; i < columns * rows; ++i)
    add_body(scene,
             {0.4f * static_cast<float>(i % columns),
              0.4f * (static_cast<float>(i / columns) - 0.5f * static_cast<float>(rows)), 0.0f},
             scenes::box_shape(0.2f, 0.2f));
  return scene;
}

Scene compounds(int bodies) {
  Scene scene = plane_scene("Bodies of two triangles each, dropped into a bin.", 0.6f, 0.0f);
  constexpr int kColumns = 20;
  add_bin(scene, 1.5f * kColumns + 1.0f, 600.0f);
  for (int i = 0; i < bodies; ++i) {
    const float x = 3.0f * (static_cast<float>(i % kColumns) - 0.5f * (kColumns - 1));
    const float y = 0.5f + 2.5f * static_cast<float>(i / kColumns);
    SceneBody body;
    body.position = {x + (i / kColumns % 2 == 0 ? 0.0f : 0.7f), y, 0.0f};
    for (const float side : {-1.0f, 1.0f}) {
      SceneShape& half = body.shapes.emplace_back();
      half.kind = solver::ShapeKind::kPolygon;
      half.points = {{side, 0.0f, 0.0f}, {-0.5f * side, 1.0f, 0.0f}, {0.0f, 2.0f, 0.0f}};
    }
    scene.bodies.push_back(body);
  }
  return scene;
}

}  // namespace cycloid::worlds
