#include "bench/tuning/choose.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "bench/tuning/asked_error.hpp"
#include "bench/tuning/passage.hpp"
#include "scenes/accuracy.hpp"
#include "scenes/catalogue.hpp"
#include "tests/places.hpp"

namespace cycloid::tuning {
namespace {

scenes::Scene column() {
  const scenes::Loaded loaded =
      scenes::load_file(places::source("tests/tuning/column.json"), scenes::Untuned::kAllowed);
  EXPECT_TRUE(loaded.scene);
  return loaded.scene.value_or(scenes::Scene{});
}

/// A request over a grid that is small enough to be tried as a whole.
TuneRequest small_request(double error_m) {
  TuneRequest request;
  request.error_m = error_m;
  request.ticks = 120;
  request.lists = {{"soft-step", "tgs-ngs", "ngs"}, {1, 2, 4}, {1, 2}, {0, 1}};
  return request;
}

/// Goal: no clock is in the choice. Method: two runs, every number but the times.
TEST(ChooseSetting, IsTheSameTwice) {
  const TuneResult a = choose(column(), small_request(0.002));
  const TuneResult b = choose(column(), small_request(0.002));
  ASSERT_TRUE(a.chosen);
  EXPECT_EQ(a.chosen, b.chosen);
  ASSERT_EQ(a.tried.size(), b.tried.size());
  for (std::size_t i = 0; i < a.tried.size(); ++i) {
    EXPECT_EQ(a.tried[i].measured.setting, b.tried[i].measured.setting) << i;
    EXPECT_EQ(a.tried[i].digest, b.tried[i].digest) << i;
    EXPECT_EQ(a.tried[i].measured.price.rows_per_tick, b.tried[i].measured.price.rows_per_tick);
    EXPECT_EQ(a.tried[i].error_m, b.tried[i].error_m) << i;
    EXPECT_EQ(a.tried[i].moved_m, b.tried[i].moved_m) << i;
    EXPECT_EQ(a.tried[i].verdict, b.tried[i].verdict) << i;
  }
}

/// The fewest rows of any setting of the whole grid that meets the request.
double least_rows(const scenes::Scene& scene, const TuneRequest& request) {
  double least = 1.0e300;
  for (const accuracy::Setting& setting : accuracy::grid(request.lists)) {
    const Tried tried = try_setting(scene, request, setting);
    if (tried.verdict == TriedVerdict::kMeets)
      least = std::min(least, tried.measured.price.rows_per_tick);
  }
  return least;
}

struct GridCase {
  scenes::Scene scene;
  std::vector<double> errors_m;
  std::uint32_t ticks;
  accuracy::GridLists lists;
};

/// Goal: nothing cheaper of the grid would have done. Method: the whole grid, one by one; of a
/// scene whose rows grow with the sweeps, of one in which they also hang on who keeps contact, and
/// of one in which an island at once has more rows in a sweep than swept blocks in two.
TEST(ChooseSetting, IsTheCheapestOfTheWholeGridThatMeetsTheError) {
  const accuracy::GridLists swept{{"pgs", "ngs-block", "ngs"}, {1, 2, 4}, {1, 2}, {0}};
  const GridCase cases[] = {{column(), {0.0005, 0.02}, 240, swept},
                            {*scenes::find("stack-10").scene, {0.0119}, 240, swept},
                            {*scenes::find("ragdolls:count=2").scene,
                             {0.01},
                             180,
                             {{"soft-islands", "soft-coupled"}, {1, 2}, {1}, {0}}}};
  for (const auto& [scene, errors_m, ticks, lists] : cases) {
    for (const double error_m : errors_m) {
      TuneRequest request = small_request(error_m);
      request.ticks = ticks;
      request.lists = lists;
      const TuneResult result = choose(scene, request);
      const double least = least_rows(scene, request);
      ASSERT_EQ(result.chosen.has_value(), least < 1.0e300) << scene.name << error_m;
      if (!result.chosen) continue;
      EXPECT_EQ(result.tried[*result.chosen].measured.price.rows_per_tick, least)
          << scene.name << error_m;
    }
  }
}

/// The choice is stored, the file read back, and what it runs with is measured once more.
void expect_stored_as_measured(scenes::Scene scene, const TuneRequest& request) {
  const TuneResult result = choose(scene, request);
  ASSERT_TRUE(result.chosen);
  const Tried& best = result.tried[*result.chosen];
  scene.accuracy.error_m = static_cast<float>(request.error_m);
  scenes::store_choice(scene, best.tuning);
  const scenes::Loaded again = scenes::from_json(scenes::to_json(scene));
  ASSERT_TRUE(again.scene);
  scenes::Scene plain = as_tried(*again.scene, request.error_m);
  const accuracy::Measured measured =
      accuracy::measure({plain, request.ticks, nullptr}, best.measured.setting, {});
  EXPECT_LE(accuracy::position_error_m(measured), request.error_m);
  EXPECT_EQ(measured.digest, best.measured.digest);
  accuracy::MeasureOptions as_it_runs;
  as_it_runs.sleep = true;
  const accuracy::Measured asleep =
      accuracy::measure({plain, request.ticks, nullptr}, best.measured.setting, as_it_runs);
  EXPECT_LE(accuracy::position_error_m(asleep), request.error_m) << "with sleep, as in a match";
  EXPECT_EQ(asleep.digest, best.digest);
  EXPECT_EQ(run_passage(*again.scene, request.ticks).digest, best.digest) << "as it is stored";
  EXPECT_EQ(scenes::to_json(accuracy::with_setting(plain, best.measured.setting)),
            scenes::to_json(plain))
      << "the stored scene runs with the setting that was measured";
}

/// Goal: the promise of the stored scene. Method: a column, long enough for what has not settled to
/// fall asleep; and cloths, which have settings of their own.
TEST(ChooseSetting, MeetsItsErrorWhenTheStoredSceneIsMeasuredAgain) {
  TuneRequest request;
  request.error_m = error_of(*asked_by(column()), column());
  expect_stored_as_measured(column(), request);
  expect_stored_as_measured(*scenes::find("cloth").scene, small_request(0.005));
}

/// Goal: what the catalogue stores is what this solver chooses; `cycloid tune
/// scenes/catalogue/NAME.json --write` stores it anew.
TEST(ChooseSetting, CatalogueHoldsWhatIsChosenForTheSceneThatStatesNoMethod) {
  const scenes::Scene scene = *scenes::find("within-a-millimetre").scene;
  TuneRequest request;
  request.error_m = error_of(*asked_by(scene), scene);
  const TuneResult result = choose(scene, request);
  ASSERT_TRUE(result.chosen);
  scenes::Scene chosen = scene;
  scenes::store_choice(chosen, result.tried[*result.chosen].tuning);
  EXPECT_EQ(scenes::to_json(chosen), scenes::to_json(scene));
}

TEST(ChooseSetting, OfTheImpossibleIsNothingAndNamesTheNearest) {
  const TuneResult result = choose(column(), small_request(1.0e-9));
  EXPECT_FALSE(result.chosen);
  ASSERT_EQ(result.tried.size(), accuracy::grid(small_request(1.0).lists).size());
  const Tried& nearest = result.tried[result.nearest];
  EXPECT_EQ(nearest.verdict, TriedVerdict::kTooCoarse);
  for (const Tried& tried : result.tried) {
    EXPECT_NE(tried.verdict, TriedVerdict::kMeets);
    if (tried.verdict == TriedVerdict::kTooCoarse) {
      EXPECT_LE(nearest.error_m, tried.error_m);
    }
  }
}

TEST(ChooseSetting, BudgetRefusesWhatIsTooSlowAndChangesNothingElse) {
  TuneRequest request = small_request(0.01);
  const TuneResult free = choose(column(), request);
  ASSERT_TRUE(free.chosen);
  request.budget_us = 1.0e9;
  const TuneResult wide = choose(column(), request);
  ASSERT_TRUE(wide.chosen);
  EXPECT_EQ(wide.tried[*wide.chosen].measured.setting, free.tried[*free.chosen].measured.setting);
  request.budget_us = 1.0e-6;
  const TuneResult narrow = choose(column(), request);
  EXPECT_FALSE(narrow.chosen);
  EXPECT_EQ(narrow.tried[narrow.nearest].verdict, TriedVerdict::kTooSlow);
}

/// Goal: a pile that has fallen down overlaps little, and is no answer. Method: a stack of twenty
/// that a few sweeps do not hold, and an error that what lies on the floor meets.
TEST(ChooseSetting, RefusesWhatEndsElsewhereThoughItOverlapsLittle) {
  const scenes::Loaded stack = scenes::find("stack:count=20");
  ASSERT_TRUE(stack.scene);
  TuneRequest request;
  request.error_m = 0.05;
  request.ticks = 300;
  request.lists = {{"ngs", "soft-step", "xpbd"}, {1, 8}, {1, 2}, {0, 1}};
  const TuneResult result = choose(*stack.scene, request);
  ASSERT_TRUE(result.finest.known);
  std::size_t elsewhere = 0;
  for (const Tried& tried : result.tried)
    if (tried.verdict == TriedVerdict::kElsewhere) {
      ++elsewhere;
      EXPECT_LE(tried.error_m, request.error_m);
      EXPECT_GT(tried.moved_m, result.finest.tolerance_m);
    }
  EXPECT_GT(elsewhere, 0u);
  ASSERT_TRUE(result.chosen);
  EXPECT_LE(result.tried[*result.chosen].moved_m, result.finest.tolerance_m);
}

/// Goal: what jumps by itself is no answer, however little it overlaps at the end. Method: boxes
/// that start in each other, which Baumgarte's bias throws apart.
TEST(ChooseSetting, RefusesWhatGainsEnergyUnlessASeatGivesSome) {
  const scenes::Loaded loaded = scenes::from_json(R"({"gravity": [0, -10], "bodies": [
    {"kind": "static", "shapes": [{"kind": "half_space", "normal": [0, 1]}]},
    {"position": [0, 0.5], "shapes": [{"radius": 0.5}]},
    {"position": [0, 1.2], "shapes": [{"radius": 0.5}]}]})");
  ASSERT_TRUE(loaded.scene);
  TuneRequest request = small_request(0.02);
  const accuracy::Setting baumgarte{"pgs", 1, 8, 0};
  const Tried thrown = try_setting(*loaded.scene, request, baumgarte);
  EXPECT_EQ(thrown.verdict, TriedVerdict::kGainsEnergy) << name_of(thrown.verdict);
  EXPECT_LE(thrown.error_m, request.error_m);
  scenes::Scene played = *loaded.scene;
  played.seats.push_back({"idle", {}, {scenes::ScriptEntry{}}});
  EXPECT_NE(try_setting(played, request, baumgarte).verdict, TriedVerdict::kGainsEnergy);
}

}  // namespace
}  // namespace cycloid::tuning
