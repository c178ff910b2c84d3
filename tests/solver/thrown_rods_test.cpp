#include <algorithm>
#include <random>

#include "solver/bodies/turn_freely.hpp"
#include "tests/solver/space_fixture.hpp"

namespace cycloid::solver {

/// Rods in space, whose moment about their length is a thousandth of the others: what mistakes one
/// spin for the other makes a thousandfold of its energy.

/// Of the spin, J.
static double energy_of_spin(const Body<3>& body) {
  const Spin<3> own = rotate_back(body.rotation, body.spin);
  return 0.5 * dot(own, times(body.inertia.m, own));
}

static Vec<3> anywhere(float size, std::mt19937& random) {
  std::uniform_real_distribution<float> part(-size, size);
  const float x = part(random);
  const float y = part(random);
  return {{x, y, part(random)}};
}

/// A broomstick of 1.5 m at 8 m/s, turning and thrown downwards any way.
static BodyDef<3> broomstick(std::mt19937& random) {
  BodyDef<3> def;
  def.position = {{0.0f, 1.5f, 0.0f}};
  Vec<3> way = anywhere(1.0f, random);
  way[1] = -abs(way[1]) - 0.2f;
  def.velocity = (8.0f / length(way)) * way;
  def.rotation = rotation_by(anywhere(2.0f, random));
  def.spin = anywhere(5.0f, random);
  return def;
}

TEST(ThrownRods, GainNoEnergyWhereTheyAreStopped) {
  std::mt19937 random(7);
  for (int thrown = 0; thrown < 60; ++thrown) {
    SCOPED_TRACE(thrown);
    World<3> world = make_world(with_gravity<3>());
    add_ground(world, up<3>());
    const BodyId id = add(world, broomstick(random),
                          capsule_def({{0.0f, -0.75f, 0.0f}}, {{0.0f, 0.75f, 0.0f}}, 0.0125f));
    const auto energy = [&] {
      const Body<3>& body = world.state().bodies[id.index];
      const double height_m = body.position[1];
      return energy_of_spin(body) +
             body.mass * (0.5 * dot(body.velocity, body.velocity) + 10.0 * height_m);
    };
    const double most = 1.05 * energy();
    for (int tick = 0; tick < 120; ++tick) {
      step(world, 1);
      ASSERT_LT(energy(), most) << "tick " << tick;
    }
  }
}

TEST(ThrownRods, FlyWithTheirEnergyHoweverFastTheySpin) {
  constexpr float kAlong_kg_m2 = 0.0001f;
  constexpr float kAcross_kg_m2 = 0.4f;
  Body<3> body{};
  body.rotation = identity_rotation<3>();
  body.inertia.m[0] = kAlong_kg_m2;
  body.inverse_inertia.m[0] = 1.0f / kAlong_kg_m2;
  for (const int i : {4, 8}) {
    body.inertia.m[i] = kAcross_kg_m2;
    body.inverse_inertia.m[i] = 1.0f / kAcross_kg_m2;
  }
  std::mt19937 random(5);
  for (int flight = 0; flight < 2000; ++flight) {
    Motion<3> motion{};
    motion.delta_rotation = identity_rotation<3>();
    motion.spin = anywhere(100.0f, random);
    motion.spin[0] *= 50.0f;
    body.spin = motion.spin;
    body.rotation = identity_rotation<3>();
    const double before = energy_of_spin(body);
    turn_freely(1.0f / 240.0f, body, motion);
    body.spin = motion.spin;
    body.rotation = motion.delta_rotation;
    EXPECT_NEAR(energy_of_spin(body) / before, 1.0, 0.02) << "flight " << flight;
  }
}

}  // namespace cycloid::solver
