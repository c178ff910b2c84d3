#include "bench/tuning/passage.hpp"

#include <gtest/gtest.h>

#include "bench/accuracy/measure.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::tuning {
namespace {

/// Goal: tune's figures of parts speak of the rows of its table. Method: a chain that the tree
/// solver solves, counted by both.
TEST(PassageOfAScene, CountsTheRowsThatAMeasuredRunCounts) {
  const scenes::Scene scene = *scenes::find("chain-and-ball:links=8").scene;
  accuracy::MeasureOptions as_it_runs;
  as_it_runs.direct_rows_max = 0;
  as_it_runs.sleep = true;
  for (const char* method : {"soft-step", "soft-direct", "soft-islands"}) {
    const accuracy::Setting setting = accuracy::published(method);
    const Passage passage = run_passage(accuracy::with_setting(scene, setting), 30);
    const accuracy::Measured measured =
        accuracy::measure({scene, 30, nullptr}, setting, as_it_runs);
    EXPECT_EQ(passage.digest, measured.digest) << method;
    EXPECT_EQ(passage.rows_per_tick, measured.price.rows_per_tick) << method;
  }
}

/// Goal: a second is one of the scene's. Method: how many looks at every fifth tick lie in it.
TEST(PassageOfAScene, LastSecondIsOneAtAnyRateOfTicks) {
  scenes::Scene scene = *scenes::find("newtons-cradle").scene;
  for (const std::size_t looks : {6u, 12u, 24u}) {
    scene.tick_hz = 5.0f * static_cast<float>(looks);
    EXPECT_EQ(run_passage(scene, 150).late_looks, looks) << scene.tick_hz;
  }
  EXPECT_EQ(run_passage(scene, 10).late_looks, 3u) << "all, and the start, of a shorter run";
}

}  // namespace
}  // namespace cycloid::tuning
