#include <cmath>

#include "bench/worlds/bench_worlds.hpp"
#include "bench/worlds/parts.hpp"

namespace cycloid::worlds {

Scene one_box(int) {
  Scene scene = plane_scene("A box on the ground.", 0.6f, 0.0f);
  add_wall(scene, {0.0f, -1.0f, 0.0f}, 100.0f, 1.0f);
  add_body(scene, {0.0f, 0.5f, 0.0f}, scenes::box_shape(0.5f, 0.5f));
  return scene;
}

Scene moving_room(int movers) {
  Scene scene = plane_scene("Seen from above: balls and boxes that never lose speed.", 0.0f, 1.0f);
  scene.gravity = {};
  const float half = 1.1f * std::sqrt(static_cast<float>(movers)) + 1.0f;  // Equal density.
  for (const float side : {-1.0f, 1.0f}) {
    add_wall(scene, {0.0f, side * (half + 0.5f), 0.0f}, half + 1.0f, 0.5f);
    add_wall(scene, {side * (half + 0.5f), 0.0f, 0.0f}, 0.5f, half + 1.0f);
  }
  const int columns = static_cast<int>(std::ceil(std::sqrt(static_cast<float>(movers))));
  const float step = (2.0f * half - 1.5f) / static_cast<float>(columns);
  const float first = 0.5f * (1.0f - static_cast<float>(columns));
  scenes::Random random{77};
  for (int i = 0; i < movers; ++i) {
    const Triple place = {(first + static_cast<float>(i % columns)) * step,
                          (first + static_cast<float>(i / columns)) * step, 0.0f};
    add_body(scene, place, mixed_shape(i % 2));
    const float x = random.between(-6.0f, 6.0f);
    scene.bodies.back().velocity = {x, random.between(-6.0f, 6.0f), 0.0f};
  }
  return scene;
}

Scene heap(int bodies) {
  Scene scene = plane_scene("Balls, boxes and capsules piled up in a bin.", 0.6f, 0.0f);
  const float half = 0.6f * std::sqrt(static_cast<float>(bodies)) + 0.5f;
  add_bin(scene, half, 42.0f);
  const int columns = std::max(1, static_cast<int>(2.0f * half / 1.1f));
  const float first = 0.5f * (1.0f - static_cast<float>(columns));
  scenes::Random random{99};
  for (int i = 0; i < bodies; ++i) {
    const float x = 1.1f * (first + static_cast<float>(i % columns)) + random.between(0.0f, 0.05f);
    add_body(scene, {x, 0.6f + 1.2f * static_cast<float>(i / columns), 0.0f}, mixed_shape(i));
  }
  return scene;
}

}  // namespace cycloid::worlds
