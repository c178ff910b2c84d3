#include "scenes/stage_profile.hpp"

#include <gtest/gtest.h>

#include "scenes/catalogue.hpp"

namespace cycloid::scenes {

/// A clock that moves by 1 ns whenever it is read, so that times count reads.
static std::uint64_t reads = 0;
static std::uint64_t counting_clock() {
  return ++reads;
}

static std::vector<SeatInput> script(const Scene& scene, std::uint64_t tick) {
  std::vector<SeatInput> inputs;
  for (std::size_t seat = 0; seat < scene.seats.size(); ++seat)
    inputs.push_back(scripted_input(scene, static_cast<int>(seat), tick));
  return inputs;
}

TEST(StageProfiles, ChangeNoBitOfAStep) {
  for (const char* name : {"half-pipe", "ragdolls-3d", "cloth"}) {
    const Scene scene = *find(name).scene;
    Simulation plain = std::move(Simulation::create(scene).value());
    Simulation profiled = std::move(Simulation::create(scene).value());
    StageProfile profile(counting_clock);
    for (std::uint64_t tick = 1; tick <= 20; ++tick) {
      ASSERT_TRUE(plain.step(script(scene, tick)).ok());
      ASSERT_TRUE(profile.step(profiled, script(scene, tick)).ok());
      ASSERT_EQ(plain.digest(), profiled.digest()) << name << " tick " << tick;
    }
    EXPECT_EQ(profile.steps(), 20u);
  }
}

TEST(StageProfiles, CountEveryPhaseAndLeaveNoTimeOut) {
  const Scene scene = *find("stack-10").scene;
  Simulation simulation = std::move(Simulation::create(scene).value());
  StageProfile profile(counting_clock);
  std::uint64_t substeps = 0;
  for (std::uint64_t tick = 1; tick <= 10; ++tick) {
    ASSERT_TRUE(profile.step(simulation, script(scene, tick)).ok());
    substeps += simulation.statistics().substeps;
  }
  EXPECT_EQ(profile.stage(solver::Phase::kCollide).calls, 10u);
  EXPECT_GE(substeps, 20u);
  EXPECT_EQ(profile.stage(solver::Phase::kSweep).calls, substeps);
  EXPECT_EQ(profile.stage(solver::Phase::kProject).calls, 0u);
  std::uint64_t sum_ns = profile.rest_ns();
  for (std::uint32_t i = 0; i < solver::kPhases; ++i)
    sum_ns += profile.stage(solver::Phase(i)).time_ns;
  EXPECT_EQ(sum_ns, profile.total_ns());
  EXPECT_EQ(profile.stage(solver::Phase::kCollide).time_ns, 10u);
}

}  // namespace cycloid::scenes
