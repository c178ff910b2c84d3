#include <algorithm>
#include <string>

#include "tests/solver/space_fixture.hpp"

namespace cycloid::solver {

static constexpr int kColumns = 41;
static constexpr float kCell = 0.5f;

/// Waves and bumps of up to 0.1 m in a wide bowl, which keeps everything on the field.
static float corner_height(int column, int row) {
  const float x = kCell * static_cast<float>(column - kColumns / 2);
  const float z = kCell * static_cast<float>(row - kColumns / 2);
  const int bump = (column * 7919 + row * 104729 + column * row * 31) % 17;
  return 0.2f * std::sin(0.9f * x) * std::cos(0.7f * z) + 0.006f * static_cast<float>(bump) +
         0.03f * (x * x + z * z);
}

/// Of the two triangles of a cell, which share the diagonal from its first corner.
static float ground_at(const Vec<3>& point) {
  const float u = point[0] / kCell + static_cast<float>(kColumns / 2);
  const float v = point[2] / kCell + static_cast<float>(kColumns / 2);
  const int column = std::clamp(static_cast<int>(u), 0, kColumns - 2);
  const int row = std::clamp(static_cast<int>(v), 0, kColumns - 2);
  const float s = u - static_cast<float>(column);
  const float t = v - static_cast<float>(row);
  const float first = corner_height(column, row);
  const float last = corner_height(column + 1, row + 1);
  const float other = t > s ? corner_height(column, row + 1) : corner_height(column + 1, row);
  return t > s ? first + t * (other - first) + s * (last - other)
               : first + s * (other - first) + t * (last - other);
}

static ShapeDef<3> rough_ground() {
  ShapeDef<3> field;
  field.kind = ShapeKind::kHeightField;
  field.columns = kColumns;
  field.cell = {kCell, kCell};
  const float corner = -kCell * static_cast<float>(kColumns / 2);
  field.points = {{{corner, 0.0f, corner}}};
  for (int row = 0; row < kColumns; ++row)
    for (int column = 0; column < kColumns; ++column)
      field.heights.push_back(corner_height(column, row));
  return field;
}

/// A body, and points of it none of which is to be below the ground: of round ones the core.
struct Dropped {
  const char* name;
  ShapeDef<3> shape;
  std::vector<Vec<3>> points;
};

static std::vector<Dropped> dropped() {
  const Vec<3> half = {{0.3f, 0.15f, 0.2f}};
  std::vector<Vec<3>> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back(
        {{i & 1 ? half[0] : -half[0], i & 2 ? half[1] : -half[1], i & 4 ? half[2] : -half[2]}});
  // A skew prism over a hexagon, narrower at its top.
  ShapeDef<3> hull;
  hull.kind = ShapeKind::kHull;
  for (int i = 0; i < 12; ++i) {
    const float angle = 1.0471976f * static_cast<float>(i % 6);
    const float radius = i < 6 ? 0.3f : 0.2f;
    hull.points.push_back(
        {{radius * std::cos(angle), i < 6 ? -0.2f : 0.25f, radius * std::sin(angle)}});
  }
  const Vec<3> end = {{0.0f, 0.0f, 0.3f}};
  return {{"box", box_def(half), corners},
          {"hull", hull, hull.points},
          {"capsule", capsule_def(-end, end, 0.15f), {-end, end}},
          {"ball", ball<3>(0.25f), {Vec<3>::zero()}}};
}

/// J.
static float kinetic_energy(const Body<3>& body) {
  const Vec<3> spin = rotate_back(body.rotation, body.spin);
  return 0.5f * body.mass * dot(body.velocity, body.velocity) +
         0.5f * dot(spin, body.inertia * spin);
}

/// With the potential energy above the lowest of the ground, J.
static float energy_of(const Body<3>& body) {
  return kinetic_energy(body) + body.mass * 10.0f * (body.position[1] + 0.2f);
}

static float height_above_ground(const BodyView<3>& body, const std::vector<Vec<3>>& points) {
  float least = 1.0e30f;
  for (const Vec<3>& point : points) {
    const Vec<3> at = body.position + rotate(body.rotation, point);
    least = std::min(least, at[1] - ground_at(at));
  }
  return least;
}

/// What a body has been through in 5 s.
struct Ride {
  float way = 0.0f;        ///< m.
  float clearance = 1.0f;  ///< The least, m.
  float kick = 0.0f;       ///< The most kinetic energy won in a tick, but for what gravity does, J.
  float shift = 0.0f;      ///< The farthest moved in a tick but by its velocity, m.
  float most = 0.0f;       ///< Energy, J.
  float start = 0.0f;      ///< Energy, J.
};

static Ride drop(const Dropped& dropped, const Vec<3>& velocity, float turn, float friction) {
  Material material;
  material.friction = friction;
  World<3> world = make_world(with_gravity<3>(material));
  BodyDef<3> ground;
  ground.kind = BodyKind::kStatic;
  add(world, ground, rough_ground());
  BodyDef<3> def;
  def.position = {{-0.5f * velocity[0], 0.0f, -0.5f * velocity[2]}};
  def.position[1] = ground_at(def.position) + 0.5f;
  def.rotation = turned_about({{0.6f, 0.0f, 0.8f}}, turn);
  def.velocity = velocity;
  const BodyId id = add(world, def, dropped.shape);
  const Body<3>& body = world.state().bodies[id.index];
  Ride ride;
  ride.start = ride.most = energy_of(body);
  for (int tick = 0; tick < 300; ++tick) {
    const Body<3> before = body;
    step(world, 1);
    ride.way += length(body.position - before.position);
    ride.clearance = std::min(ride.clearance, height_above_ground(view(world, id), dropped.points));
    const Vec<3> moved = (0.5f / 60.0f) * (before.velocity + body.velocity);
    ride.shift = std::max(ride.shift, length(body.position - before.position - moved));
    const float fallen = -0.5f * (before.velocity[1] + body.velocity[1]) / 60.0f;
    ride.kick = std::max(
        ride.kick, kinetic_energy(body) - kinetic_energy(before) - body.mass * 10.0f * fallen);
    ride.most = std::max(ride.most, energy_of(body));
  }
  return ride;
}

// What stumbles over an inner edge, or is pushed out of a triangle that it is beside of, is thrown.
// Overlap leaves by itself, without velocity, and so may lift a body: that is no kick.
TEST(RoughGround, NothingFallsThroughItOrIsKickedByItsEdges) {
  for (const Dropped& body : dropped())
    for (const float friction : {0.0f, 0.3f, 0.8f})
      for (const float turn : {0.0f, 0.7f, 2.0f})
        for (const float speed : {0.0f, 2.0f, 4.0f}) {
          const Ride ride = drop(body, {{0.8f * speed, 0.0f, 0.6f * speed}}, turn, friction);
          SCOPED_TRACE(std::string(body.name) + " friction " + std::to_string(friction) + " turn " +
                       std::to_string(turn) + " speed " + std::to_string(speed));
          EXPECT_GT(ride.clearance, -0.02f);
          EXPECT_LT(ride.kick, 0.002f * ride.start);
          EXPECT_LT(ride.shift, 0.07f);
          EXPECT_LT(ride.most, 1.01f * ride.start);
          EXPECT_GT(ride.way, 0.3f + 0.1f * speed);
        }
}

}  // namespace cycloid::solver
