#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "bench/trials/course.hpp"
#include "bench/trials/judges.hpp"
#include "solver/validate.hpp"
#include "tests/experiments/begin_trial.hpp"

namespace cycloid::trials {

using solver::ContactBlockRows;
using solver::Tuning;

static Tuning with_rows(Tuning tuning, ContactBlockRows rows) {
  tuning.contact_block = rows;
  return tuning;
}

/// A load on two boxes, a stack, blows on pyramids, joints with contacts in loops, motors that jam,
/// a box in space, and joints alone, held from the start or apart.
static constexpr const char* kTrialsOfLoads[] = {
    "trial-heavy-on-light-1000", "trial-stack-30",
    "trial-heavy-apexes",        "trial-bridge",
    "trial-ragdoll-stress",      "trial-duplicate-points",
    "trial-joint-grid-30",       "trial-ball-and-chain",
    "trial-stretched-chain"};

TEST(LoadedIslands, WorkersAndLanesAreInvisible) {
  for (const char* name : kTrialsOfLoads)
    expect_workers_and_lanes_invisible(name, Tuning::soft_loaded());
}

// What is loaded is read from the state alone: a world that has just been restored, or made of
// bytes, and has kept nothing of its islands, takes the same.
TEST(LoadedIslands, RestoredTheyGoOnAsTheyWere) {
  for (const char* name : kTrialsOfLoads) {
    scenes::Simulation simulation = begin_trial(name, Tuning::soft_loaded());
    for (int tick = 0; tick < 45; ++tick) {
      ASSERT_TRUE(simulation.step({}).ok());
      std::vector<std::byte> bytes;
      simulation.encode(bytes);
      scenes::Simulation fresh = begin_trial(name, Tuning::soft_loaded());
      ASSERT_TRUE(fresh.decode(bytes).ok());
      scenes::Simulation::Saved saved;
      simulation.save(saved);
      ASSERT_TRUE(simulation.step({}).ok());
      ASSERT_TRUE(fresh.step({}).ok());
      ASSERT_EQ(fresh.digest(), simulation.digest()) << name << ", tick " << tick;
      const std::uint64_t digest = simulation.digest();
      for (int more = 0; more < 3; ++more) ASSERT_TRUE(simulation.step({}).ok());
      simulation.restore(saved);
      ASSERT_TRUE(simulation.step({}).ok());
      ASSERT_EQ(simulation.digest(), digest) << name << ", tick " << tick;
    }
  }
}

template <int N>
static bool same(const solver::Vec<N>& a, const solver::Vec<N>& b) {
  for (int i = 0; i < N; ++i)
    if (a[i] != b[i]) return false;
  return true;
}

/// Without a slop the default's springs are those of Soft Step.
static scenes::Simulation begin_without_slop(const std::string& name, const Tuning& method) {
  scenes::Scene scene = trial_named(name).make();
  scene.tuning = with_method(scene.tuning, method);
  scene.tuning.slop = 0.0f;
  return begin_scene(scene);
}

/// Bit for bit, over so many ticks, but for the tuning that the state names.
static bool moves_alike(const std::string& name, const Tuning& a, const Tuning& b, int ticks) {
  scenes::Simulation one = begin_without_slop(name, a);
  scenes::Simulation other = begin_without_slop(name, b);
  for (int tick = 0; tick < ticks; ++tick) {
    EXPECT_TRUE(one.step({}).ok()) << name;
    EXPECT_TRUE(other.step({}).ok()) << name;
    const auto& bodies = one.planar()->state().bodies;
    const auto& others = other.planar()->state().bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i)
      if (!same(bodies[i].position, others[i].position) ||
          !same(bodies[i].velocity, others[i].velocity) || !same(bodies[i].spin, others[i].spin))
        return false;
  }
  return true;
}

TEST(LoadedIslands, LightAndThickOnesAreSweptAsSoftStepSweepsThem) {
  // Light loads; a pyramid of twenty and a card house under heavy loads, but thick.
  for (const char* name : {"trial-tall-box", "trial-box-on-pole-5", "trial-corner-30",
                           "trial-pyramid-20", "trial-card-house"})
    EXPECT_TRUE(moves_alike(name, Tuning::soft_loaded(), Tuning::soft_step(), 120)) << name;
  for (const char* name : {"trial-heavy-on-light-1000", "trial-stack-30", "trial-bridge"})
    EXPECT_FALSE(moves_alike(name, Tuning::soft_loaded(), Tuning::soft_step(), 120)) << name;
}

TEST(LoadedIslands, HoldWhatSoftSweepsLetFall) {
  struct Claim {
    const char* trial;
    double most;
  };
  // 400 times the mass falls by 5 m on what stands on a line: of two contacts the slop stays.
  constexpr Claim kClaims[] = {{"trial-heavy-on-light-1000", 0.005}, {"trial-stack-30", 0.02},
                               {"trial-400-on-thin-ground", 0.015},  {"trial-arch", 0.05},
                               {"trial-ball-and-chain", 0.005},      {"trial-bridge", 0.005},
                               {"trial-stretched-chain", 0.002}};
  for (const Claim& claim : kClaims) {
    const Outcome held = judge(trial_named(claim.trial), Tuning::soft_loaded());
    EXPECT_TRUE(held.ended) << claim.trial;
    EXPECT_LT(held.value, claim.most) << claim.trial;
    const Outcome swept = judge(trial_named(claim.trial), Tuning::soft_step());
    EXPECT_TRUE(!swept.ended || swept.value > claim.most) << claim.trial;
  }
}

// Their load would tell only once swept joints have stretched the chain to 3 mm in each.
TEST(LoadedIslands, ChainsOfUnequalMassesAreHeldFromTheFirstTick) {
  for (const char* name :
       {"trial-ball-and-chain", "trial-chain-100", "trial-chain-1000", "trial-chain-50000"}) {
    const Course course = run_trial(trial_named(name), Tuning::soft_loaded(), nullptr);
    EXPECT_TRUE(course.ended) << name;
    EXPECT_LT(*std::max_element(course.gaps_m.begin(), course.gaps_m.end()), 0.0005) << name;
  }
}

// Its joints carry nothing yet when it begins, at twice its length.
TEST(LoadedIslands, WhatHasPartedIsSolvedFromTheFirstTick) {
  EXPECT_FALSE(moves_alike("trial-stretched-chain", Tuning::soft_loaded(), Tuning::soft_step(), 1));
}

// At rest an island may miss 0.4 mm/s in each contact, and a stack of thirty that
// leans falls like a pendulum on its head: while biased sweeps passed it by, it was never at rest.
TEST(LoadedIslands, AStackOfThirtyStandsForAMinute) {
  scenes::Simulation stack = begin_trial("trial-stack-30", Tuning::soft_loaded());
  float fastest_square = 0.0f;
  for (int tick = 0; tick < 3600; ++tick) {
    ASSERT_TRUE(stack.step({}).ok());
    if (tick < 1800) continue;
    for (const solver::Body<2>& body : stack.planar()->state().bodies)
      fastest_square = std::max(fastest_square, dot(body.velocity, body.velocity));
  }
  EXPECT_LT(fastest_square, 0.005f * 0.005f) << "it leans further before it is caught";
  const auto& bodies = stack.planar()->state().bodies;
  const solver::Body<2>& top = bodies[bodies.size() - 1];
  EXPECT_NEAR(top.position[0], 0.0f, 0.5f);
  EXPECT_NEAR(top.position[1], 29.5f, 0.05f);
}

// A solve that left what has stopped a stack as the guess of the next substep would have it solved
// in four ticks of five for as long as it stands.
TEST(LoadedIslands, WhatStandsIsSeldomSolved) {
  for (const char* name : {"trial-stack-20", "trial-stack-30", "trial-arch"}) {
    scenes::Simulation trial = begin_trial(name, Tuning::soft_loaded());
    int solved = 0;
    for (int tick = 0; tick < 1200; ++tick) {
      ASSERT_TRUE(trial.step({}).ok()) << name;
      if (tick >= 200 && was_solved(trial.planar()->statistics(), Tuning::soft_loaded())) ++solved;
    }
    EXPECT_LT(solved, 100) << name;
  }
}

// What is kept of islands is of one kind of them; a world that never had the other knows no other.
TEST(LoadedIslands, TheTuningMayChangeOnTheWay) {
  scenes::Simulation kept = begin_trial("trial-heavy-apexes", Tuning::soft_loaded());
  for (const ContactBlockRows rows :
       {ContactBlockRows::kIsland, ContactBlockRows::kLoadedIsland, ContactBlockRows::kNone,
        ContactBlockRows::kLoadedIsland, ContactBlockRows::kIsland}) {
    for (int tick = 0; tick < 20; ++tick) ASSERT_TRUE(kept.step({}).ok());
    std::vector<std::byte> bytes;
    kept.encode(bytes);
    scenes::Simulation fresh = begin_trial("trial-heavy-apexes", Tuning::soft_loaded());
    ASSERT_TRUE(fresh.decode(bytes).ok());
    const Tuning tuning = with_rows(kept.planar()->state().header.tuning, rows);
    ASSERT_TRUE(kept.planar()->set_tuning(tuning).ok());
    ASSERT_TRUE(fresh.planar()->set_tuning(tuning).ok());
    for (int tick = 0; tick < 20; ++tick) {
      ASSERT_TRUE(kept.step({}).ok());
      ASSERT_TRUE(fresh.step({}).ok());
      ASSERT_EQ(kept.digest(), fresh.digest()) << tick;
    }
  }
}

TEST(LoadedIslands, ActUnderNoOtherMethod) {
  const Tuning direct = [] {
    Tuning tuning = Tuning::soft_step();
    tuning.joint_solver = solver::JointSolver::kDirect;
    return tuning;
  }();
  for (const Tuning& method : {Tuning::pgs(), Tuning::pgs_ngs(), Tuning::xpbd(), direct}) {
    const Tuning asked = with_rows(method, ContactBlockRows::kLoadedIsland);
    EXPECT_TRUE(solver::validate(asked).ok());
    EXPECT_TRUE(moves_alike("trial-stack-20", asked, method, 60));
    EXPECT_TRUE(moves_alike("trial-ball-and-chain", asked, method, 60));
  }
}

}  // namespace cycloid::trials
