#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/accuracy.hpp"
#include "scenes/catalogue.hpp"
#include "tests/cli/program.hpp"
#include "tests/places.hpp"

namespace cycloid::cli {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kColumn = places::source("tests/tuning/column.json");

/// A copy of the scene that asks for half a millimetre.
class TuneCommand : public testing::Test {
 protected:
  TuneCommand() : scene_(folder_.file("column.json")) { write_text(scene_, read_text(kColumn)); }

  Folder folder_;
  std::string scene_;
};

/// Goal: the choice depends on the build alone. Method: two runs; all but the times is equal.
TEST_F(TuneCommand, ChoosesTheSameTwice) {
  nlohmann::json results[2];
  for (nlohmann::json& result : results) {
    const Ran ran = run_program({"tune", scene_, "--ticks", "120", "--json"});
    ASSERT_EQ(ran.exit, 0) << ran.err;
    result = ran.json();
    ASSERT_GT(result["tried"].size(), 3u);
    for (nlohmann::json& tried : result["tried"]) tried.erase("ns_per_tick");
    result["chosen"].erase("ns_per_tick");
    for (nlohmann::json& need : result["needs"])
      for (const char* side : {"with", "without"})
        if (need.contains(side)) need[side].erase("us_per_tick");
  }
  EXPECT_EQ(results[0], results[1]);
}

TEST_F(TuneCommand, TableIsInOrderOfRowsAndMarksTheFirstThatMeets) {
  const Ran ran = run_program({"tune", scene_, "--error", "2mm", "--ticks", "120", "--json"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  const nlohmann::json object = ran.json();
  double rows = 0.0;
  nlohmann::json first;
  for (const nlohmann::json& tried : object["tried"]) {
    EXPECT_GE(tried["rows_per_tick"].get<double>(), rows);
    rows = tried["rows_per_tick"];
    if (first.is_null() && tried["verdict"] == "meets") first = tried;
  }
  EXPECT_EQ(object["chosen"], first);
  EXPECT_LE(first["error_m"].get<double>(), 0.002);
  const Ran text = run_program({"tune", scene_, "--error", "2mm", "--ticks", "120"});
  for (const char* words : {"rows/tick", "us/tick", "<- chosen", "chosen: ", "what the scene needs",
                            "rotation", "tangents", "sleep", "continuous", "3D"})
    EXPECT_THAT(text.out, HasSubstr(words));
  EXPECT_THAT(text.out, HasSubstr(first["digest"].get<std::string>()));
}

/// Goal: a match never chooses. Method: the scene is refused until it is tuned, runs then, and to
/// the digest of the table.
TEST_F(TuneCommand, WritesWhatRunRefusedBefore) {
  for (const char* command : {"run", "profile", "trace"}) {
    const Ran refused = run_program({command, scene_});
    EXPECT_EQ(refused.exit, 3) << command;
    EXPECT_THAT(refused.err, HasSubstr("/accuracy/tuned: "));
    EXPECT_THAT(refused.err, HasSubstr("cycloid tune SCENE --write"));
  }
#ifdef CYCLOID_NETWORK
  const Ran served = run_program({"serve", scene_, "--port", "0"});
  EXPECT_EQ(served.exit, 3);
  EXPECT_THAT(served.err, HasSubstr("/accuracy/tuned: "));
#endif
  const Ran tuned = run_program({"tune", scene_, "--ticks", "120", "--write", "--json"});
  ASSERT_EQ(tuned.exit, 0) << tuned.err;
  EXPECT_EQ(tuned.json()["written"], scene_);
  EXPECT_THAT(read_text(scene_), HasSubstr("\"solver_version\":"));
  const Ran ran = run_program({"run", scene_, "--ticks", "120", "--json"});
  ASSERT_EQ(ran.exit, 0) << ran.err;
  EXPECT_EQ(ran.json()["digest"], tuned.json()["chosen"]["digest"]);
  EXPECT_EQ(run_program({"scene", "check", scene_}).exit, 0);
}

TEST_F(TuneCommand, WritingKeepsTheRestOfTheScene) {
  ASSERT_EQ(run_program({"tune", scene_, "--ticks", "120", "--no-needs", "--write"}).exit, 0);
  const scenes::Loaded before = scenes::load_file(kColumn, scenes::Untuned::kAllowed);
  const scenes::Loaded after = scenes::load_file(scene_);
  ASSERT_TRUE(before.scene && after.scene);
  scenes::Scene expected = *before.scene;
  expected.accuracy.tuned = after.scene->accuracy.tuned;
  EXPECT_EQ(read_text(scene_), scenes::to_json(expected));
  // Again, over its own choice and with another error; and in the binary form to another file.
  ASSERT_EQ(
      run_program({"tune", scene_, "--error", "3mm", "--ticks", "120", "--no-needs", "--write"})
          .exit,
      0);
  EXPECT_THAT(read_text(scene_), HasSubstr("\"error_m\":0.003"));
  const std::string binary = folder_.file("column.cyscene");
  const std::string other = folder_.file("other.cyscene");
  ASSERT_EQ(run_program({"scene", "export", scene_, "--binary", "-o", binary}).exit, 0);
  const std::string bytes = read_text(binary);
  ASSERT_EQ(run_program({"tune", binary, "--ticks", "120", "--no-needs", "-o", other}).exit, 0);
  EXPECT_EQ(read_text(binary), bytes);
  EXPECT_EQ(read_text(other), bytes) << "the same choice in the same form";
}

TEST_F(TuneCommand, OfAMethodStatedBeforeTheChoiceTakesThePlace) {
  const std::string stated = folder_.file("stated.json");
  write_text(stated,
             R"({"gravity": [0, -10], "tuning": {"substeps": 9, "sleep_s": 0.25}, "bodies": [
    {"kind": "static", "shapes": [{"kind": "half_space", "normal": [0, 1]}]},
    {"position": [0, 0.5], "shapes": [{"radius": 0.5}]}]})");
  ASSERT_EQ(
      run_program({"tune", stated, "--error", "1%", "--ticks", "60", "--no-needs", "--write"}).exit,
      0);
  const scenes::Loaded after = scenes::load_file(stated);
  ASSERT_TRUE(after.scene);
  EXPECT_EQ(after.scene->tuning.substeps, solver::Tuning{}.substeps);
  EXPECT_EQ(after.scene->tuning.sleep_s, 0.25f);
  EXPECT_EQ(after.scene->accuracy.error_percent, 1.0f);
  EXPECT_FALSE(scenes::lacks_choice(*after.scene));
}

TEST_F(TuneCommand, OfTheImpossibleSaysSoNamesTheNearestAndWritesNothing) {
  const Ran ran = run_program({"tune", scene_, "--error", "0.000001mm", "--ticks", "60",
                               "--methods", "ngs,soft-step", "--write"});
  EXPECT_EQ(ran.exit, 5);
  EXPECT_THAT(ran.err, HasSubstr("none meets 1e-06 mm; the nearest is "));
  EXPECT_THAT(ran.err, HasSubstr("too coarse, error "));
  EXPECT_THAT(ran.out, Not(HasSubstr("chosen")));
  EXPECT_EQ(read_text(scene_), read_text(kColumn));
  const Ran slow = run_program({"tune", scene_, "--error", "5mm", "--budget-us", "0.000001",
                                "--ticks", "60", "--methods", "ngs", "--write", "--json"});
  EXPECT_EQ(slow.exit, 5);
  EXPECT_THAT(slow.err, HasSubstr("within 1e-06 us"));
  EXPECT_TRUE(slow.json()["chosen"].is_null());
  EXPECT_EQ(slow.json()["nearest"]["verdict"], "too slow");
  EXPECT_EQ(slow.json()["exit"], 5);
  EXPECT_EQ(read_text(scene_), read_text(kColumn));
}

TEST_F(TuneCommand, RefusesWhatItCannotDoAndNamesIt) {
  struct BadTune {
    std::vector<std::string> arguments;
    const char* words;
  };
  const BadTune bad_tunes[] = {{{"tune"}, "SCENE"},
                               {{"tune", "no-such-scene", "--error", "1mm"}, "no-such-scene"},
                               {{"tune", "stack-10"}, "say --error 1mm"},
                               {{"tune", "stack-10", "--error", "1mm", "--write"}, "-o FILE"},
                               {{"tune", scene_, "--error", "1"}, "has no unit"},
                               {{"tune", scene_, "--error", "1 inch"}, "not known"},
                               {{"tune", scene_, "--error", "-1mm"}, "above 0"},
                               {{"tune", scene_, "--error", "0%"}, "above 0"},
                               {{"tune", scene_, "--budget-us", "0"}, "--budget-us"},
                               {{"tune", scene_, "--budget-us", "fast"}, "--budget-us"},
                               {{"tune", scene_, "--ticks", "3"}, "--ticks"},
                               {{"tune", scene_, "--methods", "magic"}, "magic"},
                               {{"tune", scene_, "--write", "-o", scene_}, "--write"}};
  for (const BadTune& bad : bad_tunes) {
    const Ran ran = run_program(bad.arguments);
    EXPECT_EQ(ran.exit, 2) << bad.words << ran.err;
    EXPECT_THAT(ran.err, HasSubstr(bad.words));
    EXPECT_EQ(ran.out, "") << bad.words;
  }
  EXPECT_EQ(read_text(scene_), read_text(kColumn));
  const std::string still = folder_.file("still.json");
  write_text(still, R"({"bodies": [{"kind": "static", "shapes": [{"radius": 1}]}]})");
  const Ran nothing = run_program({"tune", still, "--error", "1%"});
  EXPECT_EQ(nothing.exit, 2);
  EXPECT_THAT(nothing.err, HasSubstr("no body moves"));
  const Ran cloth = run_program({"tune", "cloth", "--error", "1mm", "--ticks", "60"});
  EXPECT_EQ(cloth.exit, 0) << cloth.err;
  EXPECT_THAT(cloth.out, HasSubstr("cloths are solved apart"));
  write_text(still, "{\"bodies\": 7}");
  EXPECT_EQ(run_program({"tune", still, "--error", "1mm"}).exit, 3);
}

}  // namespace
}  // namespace cycloid::cli
