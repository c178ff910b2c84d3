#include "bench/experiments/worlds.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace cycloid::experiments {

using namespace solver;

void require(const Error& error) {
  if (!error.ok()) throw std::logic_error(std::string("experiment: ") + error.field);
}

Tuning velocities_only(std::uint32_t sweeps, Order order) {
  Tuning tuning = Tuning::pgs();
  tuning.sweeps = sweeps;
  tuning.order = order;
  tuning.baumgarte = 0.0f;
  tuning.sleep_s = 0.0f;
  return tuning;
}

World<2> make_world(const Tuning& tuning, const Material& material, double gravity, double tick_s) {
  WorldDef<2> def;
  def.gravity[1] = static_cast<float>(-gravity);
  def.tick_s = static_cast<float>(tick_s);
  def.tuning = tuning;
  def.tuning.sleep_s = 0.0f;
  def.materials = {material};
  return require(World<2>::create(def));
}

ShapeDef<2> ball(double radius) {
  ShapeDef<2> shape;
  shape.radius = static_cast<float>(radius);
  return shape;
}

ShapeDef<2> box(double half_x, double half_y) {
  const auto x = static_cast<float>(half_x);
  const auto y = static_cast<float>(half_y);
  ShapeDef<2> shape;
  shape.kind = ShapeKind::kPolygon;
  shape.points = {{{-x, -y}}, {{x, -y}}, {{x, y}}, {{-x, y}}};
  return shape;
}

BodyId add_ground(World<2>& world, double angle) {
  ShapeDef<2> shape;
  shape.kind = ShapeKind::kHalfSpace;
  shape.normal = {{static_cast<float>(-std::sin(angle)), static_cast<float>(std::cos(angle))}};
  return add(world, shape, 0.0, 0.0, 0.0, BodyKind::kStatic);
}

BodyId add(World<2>& world, const ShapeDef<2>& shape, double x, double y, double mass,
           BodyKind kind) {
  BodyDef<2> def;
  def.kind = kind;
  def.position = {{static_cast<float>(x), static_cast<float>(y)}};
  def.mass = static_cast<float>(mass);
  return require(world.create_body(def, std::span(&shape, 1)));
}

BodyId add_point(World<2>& world, double x, double y, double mass) {
  BodyDef<2> def;
  def.kind = mass > 0.0 ? BodyKind::kParticle : BodyKind::kStatic;
  def.position = {{static_cast<float>(x), static_cast<float>(y)}};
  def.mass = static_cast<float>(mass);
  return require(world.create_body(def, {}));
}

void step(World<2>& world, int ticks) {
  for (int i = 0; i < ticks; ++i) require(world.step());
}

BodyView<2> view(const World<2>& world, BodyId id) {
  return require(world.body(id));
}

World<2> stack_of_balls(const std::vector<double>& masses, const Tuning& tuning) {
  World<2> world = make_world(tuning);
  add_ground(world);
  for (std::size_t i = 0; i < masses.size(); ++i)
    add(world, ball(0.5), 0.0, 0.5 + static_cast<double>(i), masses[i]);
  return world;
}

std::vector<double> normal_impulses(const World<2>& world) {
  std::vector<double> impulses;
  for (const Contact<2>& contact : world.state().contacts)
    for (std::uint32_t p = 0; p < contact.point_count; ++p)
      impulses.push_back(static_cast<double>(contact.points[p].normal_impulse));
  return impulses;
}

std::vector<double> exact_impulses(const std::vector<double>& masses, double speed) {
  std::vector<double> impulses(masses.size());
  double carried = 0.0;
  for (std::size_t i = masses.size(); i-- > 0;) impulses[i] = (carried += masses[i]) * speed;
  return impulses;
}

/// The impulses of one tick with so many sweeps; the world stays as it was.
static std::vector<double> impulses_after(World<2>& world, const WorldState<2>& before,
                                          int sweeps) {
  world.restore(before);
  Tuning tuning = world.tuning();
  tuning.sweeps = static_cast<std::uint32_t>(sweeps);
  require(world.set_tuning(tuning));
  step(world);
  std::vector<double> impulses = normal_impulses(world);
  world.restore(before);
  return impulses;
}

std::vector<std::vector<double>> impulses_by_sweep(World<2>& world, int most) {
  const WorldState<2> before = world.state();
  std::vector<std::vector<double>> impulses;
  for (int sweeps = 1; sweeps <= most; ++sweeps)
    impulses.push_back(impulses_after(world, before, sweeps));
  return impulses;
}

double slowest_error(const std::vector<double>& impulses, const std::vector<double>& exact) {
  double error = impulses.size() == exact.size() ? 0.0 : INFINITY;
  for (std::size_t i = 0; i < std::min(impulses.size(), exact.size()); ++i)
    error = std::max(error, std::abs(impulses[i] - exact[i]) / exact[i]);
  return error;
}

int sweeps_to(World<2>& world, const std::vector<double>& exact, double tolerance, int most) {
  const WorldState<2> before = world.state();
  for (int sweeps = 1; sweeps <= most; ++sweeps)
    if (slowest_error(impulses_after(world, before, sweeps), exact) <= tolerance) return sweeps;
  return 0;
}

}  // namespace cycloid::experiments
