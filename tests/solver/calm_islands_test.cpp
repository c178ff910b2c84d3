#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// A ball of 1000 kg on one of 1 kg on a platform, an island that is solved at once; without
/// friction, so that nothing turns.
struct LoadedPlatform {
  World<2> world;
  BodyId heavy;
};

static LoadedPlatform make_loaded_platform(float rising_speed) {
  Material material;
  material.friction = 0.0f;
  WorldDef<2> def = with_gravity<2>(material);
  def.tuning.sleep_s = 0.0f;
  World<2> world = make_world<2>(def);
  BodyDef<2> body;
  body.kind = BodyKind::kKinematic;
  body.velocity[1] = rising_speed;
  add(world, body, box(5.0f, 0.5f));
  body.kind = BodyKind::kDynamic;
  body.mass = 1.0f;
  body.position[1] = 1.0f;
  add(world, body, ball<2>(0.5f));
  body.mass = 1000.0f;
  body.position[1] = 2.0f;
  const BodyId heavy = add(world, body, ball<2>(0.5f));
  return {std::move(world), heavy};
}

/// Of both contacts in a tick, N s.
static float impulse_of(const World<2>& world) {
  float sum = 0.0f;
  for (const Contact<2>& contact : world.state().contacts) sum += contact.points[0].normal_impulse;
  return sum * static_cast<float>(world.state().header.tuning.substeps);
}

// Both move as slowly as what is calm, but that is not what a solve would stop: with a guess of the
// load and that taken from it, impulses would be 15 N s of 333 off.
TEST(CalmIslands, WhatRidesSlowlyIsCarriedByItsWeight) {
  for (const float rising_speed : {0.0f, 0.005f, -0.005f}) {
    LoadedPlatform loaded = make_loaded_platform(rising_speed);
    step(loaded.world, 60);
    const float weight = (1001.0f + 1000.0f) * 10.0f / 60.0f;
    for (int tick = 0; tick < 60; ++tick) {
      step(loaded.world, 1);
      EXPECT_NEAR(impulse_of(loaded.world), weight, 0.01f * weight);
      EXPECT_NEAR(view(loaded.world, loaded.heavy).velocity[1], rising_speed, 1.0e-4f);
    }
  }
}

}  // namespace cycloid::solver
