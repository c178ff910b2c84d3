#include "bench/trials/perturb.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "scenes/catalogue.hpp"
#include "tests/experiments/begin_trial.hpp"

namespace cycloid::trials {

static scenes::Scene started(const std::string& trial, const Start& start) {
  scenes::Scene scene = trial_named(trial).make();
  perturb(scene, start);
  return scene;
}

static std::vector<float> velocities(const scenes::Scene& scene) {
  std::vector<float> all;
  for (const scenes::SceneBody& body : scene.bodies)
    all.insert(all.end(), body.velocity.begin(), body.velocity.end());
  return all;
}

class PerturbedTrial : public testing::TestWithParam<const char*> {};

TEST_P(PerturbedTrial, BeginsOtherwiseInEveryRun) {
  std::set<std::vector<float>> starts;
  for (std::uint32_t run = 0; run < 50; ++run)
    starts.insert(velocities(started(GetParam(), {1, run})));
  EXPECT_EQ(starts.size(), 50u);
}

TEST_P(PerturbedTrial, DiffersInVelocitiesOfBodiesThatMoveAndByNoMoreThanTheBound) {
  const scenes::Scene before = trial_named(GetParam()).make();
  for (std::uint32_t run = 1; run < 50; ++run) {
    scenes::Scene after = started(GetParam(), {1, run});
    EXPECT_TRUE(scenes::check(after).empty());
    for (std::size_t i = 0; i < before.bodies.size(); ++i) {
      const bool moves = before.bodies[i].kind == solver::BodyKind::kDynamic;
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const float was = before.bodies[i].velocity[axis];
        const float is = after.bodies[i].velocity[axis];
        // What rounding the sum of a fast body and a small change may add.
        const float rounding = std::abs(was) * 1.0e-7f;
        const bool may = moves && axis < before.dimension;
        EXPECT_LE(std::abs(is - was), may ? 1.0e-3f + rounding : 0.0f) << i;
      }
      after.bodies[i].velocity = before.bodies[i].velocity;
    }
    EXPECT_EQ(scenes::to_json(after), scenes::to_json(before)) << "nothing else has changed";
  }
}

INSTANTIATE_TEST_SUITE_P(Some, PerturbedTrial,
                         testing::Values("trial-card-house", "trial-bridge",
                                         "trial-projectile-1000", "trial-dzhanibekov"));

TEST(Perturb, LeavesTheFirstRunAsItIs) {
  const scenes::Trial& trial = trial_named("trial-card-house");
  EXPECT_EQ(velocities(started(trial.name, {1, 0})), velocities(trial.make()));
  const solver::Tuning method = solver::Tuning::soft_loaded();
  const scenes::Trial& cheap = trial_named("trial-heavy-on-light-10");
  EXPECT_EQ(outcome_text(judge_from(cheap, method, {9, 0})), outcome_text(judge(cheap, method)));
}

TEST(Perturb, DependsOnSeedAndRunAlone) {
  const auto start = [](std::uint64_t seed, std::uint32_t run) {
    return velocities(started("trial-card-house", {seed, run}));
  };
  EXPECT_EQ(start(1, 3), start(1, 3));
  EXPECT_NE(start(1, 3), start(2, 3));
  EXPECT_NE(start(1, 2), start(2, 1));
}

/// Goal: every machine begins alike. Method: numbers that one of them drew.
TEST(Perturb, DrawsTheSameNumbersEverywhere) {
  const scenes::Scene scene = started("trial-stack-10", {1, 1});
  std::vector<int> drawn_um_s;
  for (const scenes::SceneBody& body : scene.bodies)
    if (body.kind == solver::BodyKind::kDynamic)
      for (const std::size_t axis : {0u, 1u})
        drawn_um_s.push_back(static_cast<int>(std::lround(body.velocity[axis] * 1.0e6f)));
  drawn_um_s.resize(6);
  EXPECT_EQ(drawn_um_s, (std::vector<int>{306, -780, 365, 639, -293, 442}));
}

/// Goal: the whole width is used. Method: the extremes and the mean of 10,000 draws.
TEST(Perturb, DrawsFromTheWholeWidth) {
  scenes::Scene scene;
  scene.bodies.resize(5000);
  perturb(scene, {1, 1});
  double sum = 0.0;
  float least = 1.0f;
  float most = -1.0f;
  for (const scenes::SceneBody& body : scene.bodies)
    for (const std::size_t axis : {0u, 1u}) {
      sum += static_cast<double>(body.velocity[axis]);
      least = std::min(least, body.velocity[axis]);
      most = std::max(most, body.velocity[axis]);
    }
  EXPECT_LT(least, -0.99e-3f);
  EXPECT_GT(most, 0.99e-3f);
  EXPECT_LT(std::abs(sum / 10000), 0.03e-3);
}

}  // namespace cycloid::trials
