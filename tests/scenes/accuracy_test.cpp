#include "scenes/accuracy.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "solver/version.hpp"

namespace cycloid::scenes {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

const std::string kVersion = std::to_string(solver::kSolverVersion);

/// A ball on the ground, with these members besides.
std::string asking(const std::string& members) {
  return R"({"gravity": [0, -10], "bodies": [
    {"kind": "static", "shapes": [{"kind": "half_space", "normal": [0, 1]}]},
    {"position": [0, 0.5], "shapes": [{"radius": 0.5}]}], )" +
         members + "}";
}

Scene good(const std::string& members) {
  const Loaded loaded = from_json(asking(members));
  for (const Mistake& mistake : loaded.mistakes)
    ADD_FAILURE() << mistake.path << ": " << mistake.reason;
  return loaded.scene.value_or(Scene{});
}

std::uint64_t digest_after(const Scene& scene, int ticks) {
  solver::Result<Simulation> simulation = Simulation::create(scene);
  EXPECT_TRUE(simulation.ok());
  for (int i = 0; i < ticks; ++i) EXPECT_TRUE(simulation.value().step({}).ok());
  return simulation.value().digest();
}

/// Goal: nothing is lost on the way. Method: choices that differ from the defaults in one field
/// each, and in all, through both forms.
TEST(SceneAccuracyKey, IsReadAsItWasWritten) {
  const std::vector<std::function<void(SceneAccuracy&)>> changes = {
      [](SceneAccuracy&) {},
      [](SceneAccuracy& a) { a.tuned = {}; },
      [](SceneAccuracy& a) { a.tuned.tuning.substeps = 17; },
      [](SceneAccuracy& a) { a.tuned.tuning.sweeps = 3; },
      [](SceneAccuracy& a) { a.tuned.tuning.relax_sweeps = 0; },
      [](SceneAccuracy& a) { a.tuned.tuning.slop = 0.0005f; },
      [](SceneAccuracy& a) { a.tuned.tuning = solver::Tuning::pgs_ngs_block(); },
      [](SceneAccuracy& a) { a.tuned.tuning = solver::Tuning::xpbd(); },
      [](SceneAccuracy& a) { a.tuned.tuning.joint_solver = solver::JointSolver::kDirect; },
      [](SceneAccuracy& a) {
        a.error_m = 0.0f;
        a.error_percent = 0.3f;
      }};
  const Scene asks =
      good(R"("accuracy": {"error_m": 0.001, "tuned": {"solver_version": )" + kVersion + "}}");
  for (std::size_t i = 0; i < changes.size(); ++i) {
    Scene scene = asks;
    changes[i](scene.accuracy);
    const std::string json = to_json(scene);
    const Loaded read = from_json(json, Untuned::kAllowed);
    ASSERT_TRUE(read.scene) << json;
    EXPECT_EQ(to_json(*read.scene), json);
    const std::vector<std::byte> binary = to_binary(scene);
    const Loaded unpacked = from_binary(binary, Untuned::kAllowed);
    ASSERT_TRUE(unpacked.scene) << json;
    EXPECT_EQ(to_json(*unpacked.scene), json);
    EXPECT_EQ(to_binary(*unpacked.scene), binary);
    EXPECT_EQ(json.find("error_percent") != std::string::npos, i + 1 == changes.size());
  }
}

TEST(SceneAccuracyKey, OfASceneThatAsksForNothingIsNowhere) {
  Scene scene = good(R"("name": "plain")");
  EXPECT_EQ(to_json(scene).find("accuracy"), std::string::npos);
  const std::vector<std::byte> plain = to_binary(scene);
  scene.accuracy.error_m = 0.001f;
  EXPECT_GT(to_binary(scene).size(), plain.size());
  EXPECT_EQ(tuning_of(good(R"("name": "")")).substeps, solver::Tuning{}.substeps);
}

/// Goal: a stored choice is the method, and nothing but the method. Method: the same scene with the
/// same setting in its own tuning: equal digests of the scene and of the states.
TEST(SceneAccuracyKey, RunsAsIfTheChoiceStoodInTheTuning) {
  const Scene asks = good(
      R"("tuning": {"sleep_s": 0.25, "restitution_threshold": 0.5}, "accuracy": {"error_m": 0.001,
         "tuned": {"solver_version": )" +
      kVersion + R"(, "tuning": {"substeps": 3, "sweeps": 2, "stabilisation": "ngs"}}})");
  const Scene states = good(R"("tuning": {"sleep_s": 0.25, "restitution_threshold": 0.5,
         "substeps": 3, "sweeps": 2, "stabilisation": "ngs"})");
  EXPECT_EQ(scene_digest(asks), scene_digest(states));
  EXPECT_EQ(digest_after(asks, 90), digest_after(states, 90));
  Scene other = asks;
  other.accuracy.error_m = 0.5f;
  EXPECT_EQ(scene_digest(other), scene_digest(asks)) << "what is asked for moves no bit";
  other.accuracy.tuned.tuning.sweeps = 3;
  EXPECT_NE(scene_digest(other), scene_digest(asks));
}

TEST(SceneAccuracyKey, IsRefusedUntilThisSolverHasChosen) {
  for (const char* tuned :
       {"", R"(, "tuned": {"solver_version": 9})", R"(, "tuned": {"tuning": {"substeps": 8}})"}) {
    const std::string json = asking(std::string(R"("accuracy": {"error_m": 0.001)") + tuned + "}");
    const Loaded refused = from_json(json);
    ASSERT_EQ(refused.mistakes.size(), 1u) << json;
    EXPECT_EQ(refused.mistakes[0].path, "/accuracy/tuned");
    EXPECT_THAT(refused.mistakes[0].reason, HasSubstr("cycloid tune SCENE --write"));
    const Loaded allowed = from_json(json, Untuned::kAllowed);
    ASSERT_TRUE(allowed.scene) << json;
    EXPECT_FALSE(from_binary(to_binary(*allowed.scene)).scene);
    const Loaded unpacked = from_binary(to_binary(*allowed.scene), Untuned::kAllowed);
    ASSERT_TRUE(unpacked.scene) << json;
    EXPECT_EQ(to_json(*unpacked.scene), to_json(*allowed.scene));
    const solver::Result<Simulation> simulation = Simulation::create(*allowed.scene);
    ASSERT_FALSE(simulation.ok());
    EXPECT_STREQ(simulation.error().field, "accuracy");
  }
}

TEST(SceneAccuracyKey, MistakesAreNamedByPathAndReason) {
  struct BadKey {
    const char* members;
    const char* path;
    const char* reason;
  };
  const BadKey bad_keys[] = {
      {R"("accuracy": 0.001)", "/accuracy", "has to be an object"},
      {R"("accuracy": {})", "/accuracy", "has to state error_m or error_percent"},
      {R"("accuracy": {"error_m": 0})", "/accuracy", "has to state error_m or error_percent"},
      {R"("accuracy": {"error_m": "1mm"})", "/accuracy/error_m", "has to be a number"},
      {R"("accuracy": {"error_m": -0.001})", "/accuracy/error_m", "above 0"},
      {R"("accuracy": {"error_m": 1001})", "/accuracy/error_m", "at most 1000"},
      {R"("accuracy": {"error_m": 1e40})", "/accuracy/error_m", "finite"},
      {R"("accuracy": {"error_percent": -1})", "/accuracy/error_percent", "above 0"},
      {R"("accuracy": {"error_percent": 101})", "/accuracy/error_percent", "at most 100"},
      {R"("accuracy": {"error_m": 1, "error_percent": 1})", "/accuracy", "one of the two"},
      {R"("accuracy": {"tuned": {"solver_version": 1}})", "/accuracy", "has to state error_m"},
      {R"("accuracy": {"eror_m": 1})", "/accuracy/eror_m", "is 'error_m' meant?"},
      {R"("accuracy": {"error_m": 1, "tuned": {"version": 1}})", "/accuracy/tuned/version",
       "is not a field here"},
      {R"("accuracy": {"error_m": 1, "tuned": {"tuning": {"substep": 1}}})",
       "/accuracy/tuned/tuning/substep", "is 'substeps' meant?"},
      {R"("accuracy": {"error_m": 1, "tuned": {"tuning": {"substeps": 0}}})",
       "/accuracy/tuned/tuning/substeps", "out of range"},
      {R"("accuracy": {"error_m": 1, "tuned": {"tuning": {"sleep_s": 9}}})",
       "/accuracy/tuned/tuning/sleep_s", "state it in /tuning"},
      {R"("accuracy": {"error_m": 1}, "tuning": {"sweeps": 9})", "/tuning/sweeps",
       "leave out one of the two"},
      {R"("accuracy": {"error_m": 1}, "tuning": {"sleep_speed": -1})", "/tuning/sleep_speed",
       "out of range"}};
  for (const BadKey& bad : bad_keys) {
    const Loaded loaded = from_json(asking(bad.members), Untuned::kAllowed);
    EXPECT_FALSE(loaded.scene) << bad.members;
    bool found = false;
    for (const Mistake& mistake : loaded.mistakes)
      found = found ||
              (mistake.path == bad.path && mistake.reason.find(bad.reason) != std::string::npos);
    EXPECT_TRUE(found) << bad.members << " gave "
                       << (loaded.mistakes.empty()
                               ? "nothing"
                               : loaded.mistakes[0].path + ": " + loaded.mistakes[0].reason);
  }
}

TEST(SceneAccuracyKey, StoringAChoiceMovesTheMethodAndKeepsTheRest) {
  Scene scene = good(R"("tuning": {"sweeps": 7, "slop": 0.002, "sleep_s": 0.25})");
  solver::Tuning chosen = solver::Tuning::pgs_ngs().in_substeps(2);
  chosen.slop = 0.0005f;
  chosen.sleep_s = 99.0f;  // The scene's own word counts.
  scene.accuracy.error_m = 0.001f;
  store_choice(scene, chosen);
  EXPECT_THAT(check(scene), IsEmpty());
  EXPECT_EQ(scene.accuracy.tuned.solver_version, solver::kSolverVersion);
  const solver::Tuning runs = tuning_of(scene);
  EXPECT_EQ(runs.sweeps, chosen.sweeps);
  EXPECT_EQ(runs.substeps, 2u);
  EXPECT_EQ(runs.slop, 0.0005f);
  EXPECT_EQ(runs.stabilisation, solver::Stabilisation::kNgs);
  EXPECT_EQ(runs.sleep_s, 0.25f);
}

}  // namespace
}  // namespace cycloid::scenes
