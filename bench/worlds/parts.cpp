#include "bench/worlds/parts.hpp"

namespace cycloid::worlds {

Scene plane_scene(const char* summary, float friction, float restitution) {
  Scene scene = scenes::planar_scene("", summary);
  scene.materials[0].friction = friction;
  scene.materials[0].restitution = restitution;
  return scene;
}

void add_wall(Scene& scene, const Triple& middle, float half_x, float half_y) {
  SceneBody wall = scenes::body_at("", middle, scenes::box_shape(half_x, half_y));
  wall.kind = solver::BodyKind::kStatic;
  scene.bodies.push_back(wall);
}

void add_bin(Scene& scene, float half, float height) {
  add_wall(scene, {0.0f, -0.5f, 0.0f}, half + 1.0f, 0.5f);
  for (const float side : {-1.0f, 1.0f})
    add_wall(scene, {side * (half + 0.5f), 0.5f * height - 1.0f, 0.0f}, 0.5f, 0.5f * height);
}

SceneShape mixed_shape(int turn) {
  switch (turn % 3) {
    case 0:
      return scenes::ball_shape(0.4f);
    case 1:
      return scenes::box_shape(0.4f, 0.4f);
    default:
      return scenes::capsule_shape({-0.25f, 0.0f, 0.0f}, {0.25f, 0.0f, 0.0f}, 0.25f);
  }
}

void add_body(Scene& scene, const Triple& position, SceneShape shape) {
  scene.bodies.push_back(scenes::body_at("", position, shape));
}

}  // namespace cycloid::worlds
