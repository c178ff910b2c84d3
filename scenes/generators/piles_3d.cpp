#include "scenes/generators/generators.hpp"
#include "solver/trig.hpp"

namespace cycloid::scenes {

static SceneBody cube_at(const Triple& position, float half) {
  return body_at("", position, solid_box({half, half, half}));
}

Scene stack_3d(int count) {
  Scene scene = spatial_scene("stack-" + std::to_string(count) + "-3d",
                              "Unit cubes one on the other; a seat throws balls at them.");
  scene.bodies.push_back(ground());
  for (int i = 0; i < count; ++i)
    scene.bodies.push_back(
        cube_at({i % 2 == 0 ? 0.01f : -0.01f, 0.5f + static_cast<float>(i), 0.0f}, 0.5f));
  add_thrower(scene, {-12.0f, 3.0f, 0.3f}, {10.0f, 4.0f, 0.0f});
  return scene;
}

Scene pyramid_3d(int layers) {
  Scene scene = spatial_scene("pyramid-3d", "Unit cubes in square layers; a seat throws balls.");
  if (layers != 10) scene.name += "-" + std::to_string(layers);
  scene.bodies.push_back(ground());
  for (int layer = 0; layer < layers; ++layer) {
    const int side = layers - layer;
    const float first = -0.525f * static_cast<float>(side - 1);
    for (int i = 0; i < side * side; ++i)
      scene.bodies.push_back(
          cube_at({first + 1.05f * static_cast<float>(i % side), 0.5f + static_cast<float>(layer),
                   first + 1.05f * static_cast<float>(i / side)},
                  0.5f));
  }
  const float reach = 0.6f * static_cast<float>(layers) + 8.0f;
  add_thrower(scene, {-reach, 4.0f, 0.4f}, {14.0f, 4.0f, 0.0f});
  return scene;
}

Scene wall(int courses) {
  Scene scene = spatial_scene("wall", "Bricks in running bond; a seat throws balls at them.");
  if (courses != 12) scene.name += "-" + std::to_string(courses);
  scene.bodies.push_back(ground());
  constexpr int kBricks = 10;
  for (int course = 0; course < courses; ++course) {
    const bool shifted = course % 2 != 0;
    const float y = 0.25f + 0.5f * static_cast<float>(course);
    for (int i = 0; i < kBricks; ++i) {
      const float x = static_cast<float>(i) - 0.5f * kBricks + (shifted ? 0.5f : 0.0f);
      const bool end = shifted && i + 1 == kBricks;
      // Half bricks close the ends of every other course.
      if (shifted && i == 0)
        scene.bodies.push_back(body_at("", {x - 0.75f, y, 0.0f}, solid_box({0.25f, 0.25f, 0.25f})));
      scene.bodies.push_back(body_at("", {end ? x - 0.25f : x, y, 0.0f},
                                     solid_box({end ? 0.25f : 0.5f, 0.25f, 0.25f})));
    }
  }
  add_thrower(scene, {0.3f, 3.0f, -12.0f}, {0.0f, 4.0f, 14.0f});
  return scene;
}

/// The part of a ring from `angle` to `angle` + `step` [rad], counted from the horizontal, as a
/// hull about its own middle.
static SceneBody voussoir(float angle, float step) {
  constexpr float kInner = 4.0f;
  constexpr float kOuter = 5.2f;
  SceneShape stone;
  stone.kind = solver::ShapeKind::kHull;
  Triple middle{};
  for (const float at : {angle, angle + step})
    for (const float radius : {kInner, kOuter})
      for (const float z : {-0.75f, 0.75f}) {
        float sine = 0.0f;
        float cosine = 0.0f;
        solver::sin_cos(at, sine, cosine);
        stone.points.push_back({radius * cosine, radius * sine, z});
        middle[0] += 0.125f * radius * cosine;
        middle[1] += 0.125f * radius * sine;
      }
  for (Triple& point : stone.points) {
    point[0] -= middle[0];
    point[1] -= middle[1];
  }
  stone.density = 2.0f;
  return body_at("", {middle[0], middle[1] + 1.0f, 0.0f}, stone);
}

Scene arch_3d(int stones) {
  Scene scene = spatial_scene("arch-3d", "A round arch of loose stones carries a load.");
  if (stones != 13) scene.name += "-" + std::to_string(stones);
  scene.materials[0].friction = 0.8f;
  scene.bodies.push_back(ground());
  for (const float side : {-4.6f, 4.6f}) {
    SceneBody pier = body_at("", {side, 0.5f, 0.0f}, solid_box({1.0f, 0.5f, 1.0f}));
    pier.kind = solver::BodyKind::kStatic;
    scene.bodies.push_back(pier);
  }
  const float step = solver::kPi / static_cast<float>(stones);
  for (int i = 0; i < stones; ++i)
    scene.bodies.push_back(voussoir(step * static_cast<float>(i), step));
  SceneBody load = body_at("load", {0.0f, 6.75f, 0.0f}, solid_box({0.5f, 0.5f, 0.5f}));
  scene.bodies.push_back(load);
  add_thrower(scene, {-12.0f, 5.0f, 0.0f}, {8.0f, 4.0f, 0.0f});
  scene.prefabs[0].shapes[0].density = 0.5f;
  scene.seats[0].script[0].from = 300;
  return scene;
}

// The scene that Fiedler's talks on networked physics measure snapshots with: 30 x 30 small cubes,
// and one cube that a player rolls through them.
Scene cubes(int side) {
  Scene scene = spatial_scene("cubes-" + std::to_string(side * side + 1),
                              "A player rolls a large cube through a field of small ones.");
  scene.bodies.push_back(ground());
  SceneBody player = body_at("player", {0.0f, 3.0f, 0.0f}, solid_box({0.75f, 0.75f, 0.75f}));
  player.shapes[0].density = 2.0f;
  scene.bodies.push_back(player);
  for (int i = 0; i < side * side; ++i) {
    const float x = static_cast<float>(i % side) - 0.5f * static_cast<float>(side - 1);
    const float z = static_cast<float>(i / side) - 0.5f * static_cast<float>(side - 1);
    scene.bodies.push_back(cube_at({x, 0.2f, z}, 0.2f));
  }
  Seat seat;
  seat.name = "player";
  seat.controls.push_back(force_control(0, "player", {70.0f, 0.0f, 0.0f}));
  seat.controls.push_back(force_control(1, "player", {0.0f, 0.0f, 70.0f}));
  seat.controls.push_back(impulse_control(0, "player", {0.0f, 40.0f, 0.0f}));
  // Round and round, with a leap.
  seat.script.push_back({30, 0, 240, 60, {1.0f, 0.2f, 0.0f, 0.0f}, 0});
  seat.script.push_back({90, 0, 240, 60, {-0.2f, 1.0f, 0.0f, 0.0f}, 0});
  seat.script.push_back({150, 0, 240, 60, {-1.0f, -0.2f, 0.0f, 0.0f}, 0});
  seat.script.push_back({210, 0, 240, 60, {0.2f, -1.0f, 0.0f, 0.0f}, 1});
  scene.seats.push_back(seat);
  return scene;
}

}  // namespace cycloid::scenes
