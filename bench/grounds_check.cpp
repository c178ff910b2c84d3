// cycloid_grounds: drops a ball onto every kind of ground in every engine, and says where one does
// not hold it. A ground that an adapter of bench/peers hands over wrongly, as a chain whose solid
// side is the other one, makes every comparison on it worthless, and its world cheap.

#include <cmath>
#include <cstdio>

#include "bench/peers/engine.hpp"
#include "scenes/generators/generators.hpp"
#include "solver/trig.hpp"

namespace cycloid::peers {
namespace {

using scenes::Scene;
using scenes::SceneBody;
using scenes::SceneShape;
using scenes::Triple;
using solver::ShapeKind;

/// A static body whose surface is at height 0 above the origin.
struct Ground {
  const char* name;
  SceneBody body;
};

SceneBody static_at(const Triple& place, const SceneShape& shape) {
  SceneBody body = scenes::body_at("", place, shape);
  body.kind = solver::BodyKind::kStatic;
  return body;
}

SceneShape pointed(ShapeKind kind, std::vector<Triple> points) {
  SceneShape shape;
  shape.kind = kind;
  shape.points = std::move(points);
  return shape;
}

std::vector<Ground> grounds_of_plane() {
  // A chain that is on its head before its body is turned by half a turn.
  SceneBody turned = static_at(
      {0.0f, -1.0f, 0.0f},
      scenes::chain_shape({{4.0f, -1.0f, 0.0f}, {0.0f, -1.0f, 0.0f}, {-4.0f, -1.0f, 0.0f}}, false));
  turned.angle = solver::kPi;
  return {
      {"half-space", scenes::ground()},
      {"box", static_at({0.0f, -1.0f, 0.0f}, scenes::box_shape(4.0f, 1.0f))},
      {"polygon",
       static_at({}, pointed(ShapeKind::kPolygon,
                             {{-4.0f, 0.0f, 0.0f}, {0.0f, -3.0f, 0.0f}, {4.0f, 0.0f, 0.0f}}))},
      {"capsule", static_at({0.0f, -0.5f, 0.0f},
                            scenes::capsule_shape({-4.0f, 0.0f, 0.0f}, {4.0f, 0.0f, 0.0f}, 0.5f))},
      {"ball", static_at({0.0f, -3.0f, 0.0f}, scenes::ball_shape(3.0f))},
      {"chain",
       static_at({}, scenes::chain_shape(
                         {{-4.0f, 1.0f, 0.0f}, {-2.0f, 0.0f, 0.0f}, {2.0f, 0.0f, 0.0f}}, false))},
      {"loop", static_at({}, scenes::chain_shape({{-4.0f, 4.0f, 0.0f},
                                                  {-4.0f, 0.0f, 0.0f},
                                                  {4.0f, 0.0f, 0.0f},
                                                  {4.0f, 4.0f, 0.0f}},
                                                 true))},
      {"turned chain", turned},
  };
}

std::vector<Ground> grounds_of_space() {
  const std::vector<Triple> flat = {
      {-4.0f, 0.0f, -4.0f}, {-4.0f, 0.0f, 4.0f}, {4.0f, 0.0f, 4.0f}, {4.0f, 0.0f, -4.0f}};
  SceneShape mesh = pointed(ShapeKind::kMesh, flat);
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  SceneShape field;
  field.kind = ShapeKind::kHeightField;
  field.columns = 3;
  field.cell = {2.0f, 2.0f};
  field.heights.assign(9, 0.0f);
  std::vector<Triple> wedge = flat;
  wedge.push_back({0.0f, -2.0f, 0.0f});
  return {
      {"half-space", scenes::ground()},
      {"box", static_at({0.0f, -1.0f, 0.0f}, scenes::solid_box({4.0f, 1.0f, 4.0f}))},
      {"hull", static_at({}, pointed(ShapeKind::kHull, wedge))},
      {"capsule", static_at({0.0f, -0.5f, 0.0f},
                            scenes::capsule_shape({-4.0f, 0.0f, 0.0f}, {4.0f, 0.0f, 0.0f}, 0.5f))},
      {"ball", static_at({0.0f, -3.0f, 0.0f}, scenes::ball_shape(3.0f))},
      {"mesh", static_at({}, mesh)},
      {"height field", static_at({-1.5f, 0.0f, -1.7f}, field)},
  };
}

/// How far from where it would lie on a ground the ball is two seconds after it fell from half a
/// metre, m. @pre `why` is empty; says there why the engine does not take the scene.
template <int D>
float way_off(const EngineKind<D>& kind, const SceneBody& ground, std::string& why) {
  constexpr float kRadius = 0.25f;
  Scene scene = D == 2 ? scenes::planar_scene("ground", "A ball on a ground.")
                       : scenes::spatial_scene("ground", "A ball on a ground.");
  scene.bodies = {ground,
                  scenes::body_at("ball", {0.0f, 0.75f, 0.0f}, scenes::ball_shape(kRadius))};
  std::vector<scenes::Mistake> mistakes;
  const auto built = scenes::build<D>(scene, mistakes);
  if (built == nullptr) {
    why = mistakes.front().path + ": " + mistakes.front().reason;
    return 0.0f;
  }
  const auto engine = kind.make({scene, *built, {}}, why);
  if (engine == nullptr) return 0.0f;
  for (int tick = 0; tick < 120; ++tick) engine->step({});
  return engine->pose(1).position[1] - kRadius;
}

/// @returns how many engines do not hold the ball on how many grounds.
template <int D>
int count_failures(const std::vector<Ground>& grounds) {
  constexpr float kBound_m = 0.05f;  // Bullet keeps 0.04 around a hull.
  int failures = 0;
  for (const EngineKind<D>& kind : engines<D>())
    for (const Ground& ground : grounds) {
      std::string why;
      const float off = way_off<D>(kind, ground.body, why);
      const bool holds = why.empty() && std::abs(off) < kBound_m;
      // Ours takes all of them.
      if (!why.empty() && &kind != engines<D>().data()) continue;
      if (holds) continue;
      ++failures;
      std::fprintf(stderr, "cycloid_grounds: %s, %s, in %s: the ball is %.3f m off %s\n", kind.name,
                   ground.name, D == 2 ? "the plane" : "space", static_cast<double>(off),
                   why.c_str());
    }
  return failures;
}

}  // namespace
}  // namespace cycloid::peers

int main() {
  using namespace cycloid::peers;
  const int failures =
      count_failures<2>(grounds_of_plane()) + count_failures<3>(grounds_of_space());
  if (failures == 0) std::printf("every engine holds a ball on every ground that it takes\n");
  return failures == 0 ? 0 : 1;
}
