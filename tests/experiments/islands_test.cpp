#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "bench/trials/judges.hpp"
#include "scenes/build.hpp"
#include "solver/validate.hpp"
#include "tests/experiments/begin_trial.hpp"

namespace cycloid::trials {

static solver::Tuning islands_at_once() {
  solver::Tuning tuning = solver::Tuning::soft_step();
  tuning.contact_block = solver::ContactBlockRows::kIsland;
  return tuning;
}

static scenes::Simulation begin_islands_at_once(const std::string& name) {
  return begin_trial(name, islands_at_once());
}

/// Blows on pyramids, joints with contacts in loops, motors against limits, and four points of a
/// box in space.
static constexpr const char* kTrialsOfIslands[] = {"trial-heavy-apexes", "trial-bridge",
                                                   "trial-ragdoll-stress", "trial-arch",
                                                   "trial-duplicate-points"};

TEST(IslandsAtOnce, WorkersAndLanesAreInvisible) {
  for (const char* name : kTrialsOfIslands)
    expect_workers_and_lanes_invisible(name, islands_at_once());
}

TEST(IslandsAtOnce, RestoredFromMemoryAndFromBytesTheyGoOnAsTheyWere) {
  for (const char* name : kTrialsOfIslands) {
    scenes::Simulation simulation = begin_islands_at_once(name);
    for (int tick = 0; tick < 45; ++tick) ASSERT_TRUE(simulation.step({}).ok());
    scenes::Simulation::Saved saved;
    simulation.save(saved);
    std::vector<std::byte> bytes;
    simulation.encode(bytes);
    std::vector<std::uint64_t> digests;
    for (int tick = 0; tick < 45; ++tick) {
      ASSERT_TRUE(simulation.step({}).ok());
      digests.push_back(simulation.digest());
    }
    simulation.restore(saved);
    scenes::Simulation fresh = begin_islands_at_once(name);
    ASSERT_TRUE(fresh.decode(bytes).ok());
    for (const std::uint64_t digest : digests) {
      ASSERT_TRUE(simulation.step({}).ok());
      ASSERT_TRUE(fresh.step({}).ok());
      ASSERT_EQ(simulation.digest(), digest) << name;
      ASSERT_EQ(fresh.digest(), digest) << name;
    }
  }
}

/// What is sorted into islands is kept while the same things hold each other; masses and friction
/// are not part of that, and a world that sorts anew knows no other.
TEST(IslandsAtOnce, WhatIsKeptOfThemKnowsOfEdits) {
  scenes::Simulation kept = begin_islands_at_once("trial-pyramid-20");
  for (int tick = 0; tick < 30; ++tick) ASSERT_TRUE(kept.step({}).ok());
  std::vector<std::byte> bytes;
  kept.encode(bytes);
  scenes::Simulation fresh = begin_islands_at_once("trial-pyramid-20");
  ASSERT_TRUE(fresh.decode(bytes).ok());
  const std::uint64_t before = kept.digest();
  for (scenes::Simulation* simulation : {&kept, &fresh}) {
    solver::World<2>& world = *simulation->planar();
    const std::size_t last = world.state().bodies.size() - 1;
    const solver::BodyId id{static_cast<std::uint32_t>(last),
                            world.state().bodies[last].generation};
    ASSERT_TRUE(world.set_mass(id, 50.0f * world.state().bodies[last].mass).ok());
    solver::Material material = world.state().materials[0];
    material.friction = 0.3f;
    ASSERT_TRUE(world.set_material(0, material).ok());
  }
  ASSERT_NE(kept.digest(), before);
  for (int tick = 0; tick < 60; ++tick) {
    ASSERT_TRUE(kept.step({}).ok());
    ASSERT_TRUE(fresh.step({}).ok());
    ASSERT_EQ(kept.digest(), fresh.digest()) << tick;
  }
}

TEST(IslandsAtOnce, HoldWhatSoftSweepsLetFall) {
  struct Claim {
    const char* trial;
    double most;
  };
  constexpr Claim kClaims[] = {{"trial-heavy-on-light-1000", 0.001}, {"trial-stack-30", 0.01},
                               {"trial-400-on-thin-ground", 0.001},  {"trial-arch", 0.05},
                               {"trial-ball-and-chain", 0.005},      {"trial-chain-50000", 0.005}};
  for (const Claim& claim : kClaims) {
    const scenes::Trial& trial = trial_named(claim.trial);
    const Outcome held = judge(trial, islands_at_once());
    EXPECT_TRUE(held.ended) << claim.trial;
    EXPECT_LT(held.value, claim.most) << claim.trial;
    const Outcome swept = judge(trial, solver::Tuning::soft_step());
    EXPECT_TRUE(!swept.ended || swept.value > claim.most) << claim.trial;
  }
}

// The impulses that have stopped a load would lift it as the next warm start, and so on for ever:
// what was solved is solved again until nothing is left. Nor do gaps of a rounding count, which
// would set it going again.
TEST(IslandsAtOnce, AreLeftAloneOnceTheWarmStartHoldsThem) {
  for (const char* name : {"trial-heavy-on-light-1000", "trial-400-on-thick-ground",
                           "trial-card-house", "trial-heavy-apexes"}) {
    scenes::Simulation simulation = begin_islands_at_once(name);
    int solved = 0;
    for (int tick = 1; tick <= 600; ++tick) {
      ASSERT_TRUE(simulation.step({}).ok());
      if (was_solved(simulation.statistics(), islands_at_once())) ++solved;
    }
    EXPECT_GT(solved, 0) << name;
    EXPECT_LT(solved, 120) << name;
  }
}

/// Kinetic energy and that of height, J.
static double energy_of(const solver::WorldState<2>& state) {
  double energy = 0.0;
  for (const solver::Body<2>& body : state.bodies) {
    if (body.kind != solver::BodyKind::kDynamic) continue;
    const double mass = static_cast<double>(body.mass);
    const double spin = static_cast<double>(body.spin[0]);
    energy += 0.5 * mass * static_cast<double>(dot(body.velocity, body.velocity)) +
              0.5 * static_cast<double>(body.inertia.m[0]) * spin * spin -
              mass * static_cast<double>(dot(state.header.gravity, body.position)) *
                  static_cast<double>(body.gravity_scale);
  }
  return energy;
}

static void expect_no_energy_gained(const char* name, const solver::Tuning& tuning) {
  SCOPED_TRACE(name);
  scenes::Scene scene = trial_named(name).make();
  scene.tuning = with_method(scene.tuning, tuning);
  std::vector<scenes::Mistake> mistakes;
  const auto built = scenes::build<2>(scene, mistakes);
  ASSERT_TRUE(built != nullptr);
  const auto energy = [&] { return energy_of(built->world.state()); };
  const double start = energy();
  double least = start;
  double most = start;
  for (int tick = 0; tick < 240; ++tick) {
    ASSERT_TRUE(built->world.step().ok());
    most = std::max(most, energy());
    least = std::min(least, energy());
  }
  EXPECT_LE(most - start, 0.01 * (start - least) + 1.0e-3 * std::abs(start));
}

// Blows, falls and swings; overlap that positions are moved out of lifts what lies on it. The
// planks of the bridge are as straight as its pins, so that joints which close throw them, and its
// load.
TEST(IslandsAtOnce, GainNoEnergy) {
  for (const solver::Tuning& tuning : {islands_at_once(), solver::Tuning::soft_loaded()})
    for (const char* name :
         {"trial-stack-30", "trial-heavy-apexes", "trial-card-house", "trial-arch", "trial-bridge",
          "trial-ball-and-chain", "trial-chain-1000", "trial-chain-50000", "trial-joint-grid-30"})
      expect_no_energy_gained(name, tuning);
  expect_no_energy_gained("trial-joint-grid-100", solver::Tuning::soft_loaded());
}

// A step along tangents would part each joint of a chain that swings, until its bias sees it.
TEST(IslandsAtOnce, ChainsThatSwingKeepTheirLength) {
  for (const solver::Tuning& tuning : {islands_at_once(), solver::Tuning::soft_loaded()})
    for (const char* name : {"trial-ball-and-chain", "trial-chain-100", "trial-chain-1000"})
      EXPECT_LT(judge(trial_named(name), tuning).value, 1.0e-4) << name;  // m
}

TEST(IslandsAtOnce, AreRefusedUnderMethodsWithoutSoftness) {
  solver::Tuning tuning = solver::Tuning::pgs();
  tuning.contact_block = solver::ContactBlockRows::kIsland;
  const solver::Error error = solver::validate(tuning);
  EXPECT_EQ(error.code, solver::Code::kInvalid);
  EXPECT_STREQ(error.field, "contact_block");
  EXPECT_TRUE(solver::validate(islands_at_once()).ok());
}

}  // namespace cycloid::trials
