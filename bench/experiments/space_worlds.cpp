#include "bench/experiments/space_worlds.hpp"

namespace cycloid::experiments::space {

using namespace solver;

World<3> make_world(const Tuning& tuning, double gravity, const Material& material) {
  WorldDef<3> def;
  def.gravity[1] = static_cast<float>(-gravity);
  def.tick_s = static_cast<float>(kTick);
  def.tuning = tuning;
  def.tuning.sleep_s = 0.0f;
  def.materials = {material};
  return require(World<3>::create(def));
}

ShapeDef<3> ball(double radius) {
  ShapeDef<3> shape;
  shape.radius = static_cast<float>(radius);
  return shape;
}

ShapeDef<3> box(double half_x, double half_y, double half_z) {
  ShapeDef<3> shape;
  shape.kind = ShapeKind::kBox;
  shape.half = {
      {static_cast<float>(half_x), static_cast<float>(half_y), static_cast<float>(half_z)}};
  return shape;
}

BodyId add_ground(World<3>& world) {
  ShapeDef<3> shape;
  shape.kind = ShapeKind::kHalfSpace;
  shape.normal = {{0.0f, 1.0f, 0.0f}};
  BodyDef<3> def;
  def.kind = BodyKind::kStatic;
  return require(world.create_body(def, std::span(&shape, 1)));
}

BodyId add(World<3>& world, std::span<const ShapeDef<3>> shapes, double y, double mass) {
  BodyDef<3> def;
  def.position[1] = static_cast<float>(y);
  def.mass = static_cast<float>(mass);
  return require(world.create_body(def, shapes));
}

World<3> stack_of_balls(const std::vector<double>& masses, const Tuning& tuning) {
  World<3> world = make_world(tuning);
  add_ground(world);
  const ShapeDef<3> shape = ball(0.5);
  for (std::size_t i = 0; i < masses.size(); ++i)
    add(world, std::span(&shape, 1), 0.5 + static_cast<double>(i), masses[i]);
  return world;
}

std::vector<double> normal_impulses(const World<3>& world) {
  std::vector<double> impulses;
  for (const Contact<3>& contact : world.state().contacts)
    for (std::uint32_t p = 0; p < contact.point_count; ++p)
      impulses.push_back(static_cast<double>(contact.points[p].normal_impulse));
  return impulses;
}

void step(World<3>& world, int ticks) {
  for (int i = 0; i < ticks; ++i) require(world.step());
}

}  // namespace cycloid::experiments::space
