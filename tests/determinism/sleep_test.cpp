#include "tests/determinism/scene_test.hpp"

namespace cycloid::history {
namespace {

class Sleep : public SceneTest {
 protected:
  /// Two runs under the same rule of sleep, of which one is made with everything at once.
  /// @returns how many bodies slept at most.
  std::uint32_t compare(const Scene& scene, std::uint64_t ticks) {
    std::uint32_t asleep = 0;
    Simulation one = begin(scene);
    Simulation other = begin(scene);
    set_up(one, 1, 1);
    for (std::uint64_t tick = 0; tick < ticks; ++tick) {
      // Another setting now and then, in the middle of the run.
      if (tick % 40 == 0) set_up(other, tick % 80 == 0 ? 3 : 2, tick % 80 == 0 ? 8 : 16);
      play(scene, one);
      play(scene, other);
      EXPECT_EQ(one.digest(), other.digest())
          << "tick " << one.tick() << ": " << first_difference(one, other);
      if (HasFailure()) break;
      asleep = std::max(asleep, one.statistics().asleep);
    }
    return asleep;
  }
};

TEST_P(Sleep, OnAndOffWorkersAndLanesAreInvisible) {
  Scene scene = this->scene();
  if (scene.tuning.sleep_s > 0.0f) compare(scene, 120);
  scene.tuning.sleep_s = 0.0f;
  EXPECT_EQ(compare(scene, 120), 0u);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Sleep, testing::ValuesIn(scene_names()), scene_test_name);

// Else the test above would compare worlds that never sleep.
TEST(SleepOfScenes, ManyScenesSleepWhereSleepIsOn) {
  int sleeping = 0;
  for (const char* name : {"stack-10", "method-pgs", "card-house", "pyramid-3d"}) {
    const Scene scene = std::move(*scenes::find(name).scene);
    Simulation simulation = begin(scene);
    std::uint32_t asleep = 0;
    for (int tick = 0; tick < 120; ++tick) {
      play(scene, simulation);
      asleep = std::max(asleep, simulation.statistics().asleep);
    }
    sleeping += asleep > 0 ? 1 : 0;
  }
  EXPECT_EQ(sleeping, 4);
}

}  // namespace
}  // namespace cycloid::history
