#include "bench/tuning/needs.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scenes/catalogue.hpp"

namespace cycloid::tuning {
namespace {

using testing::HasSubstr;

constexpr const char* kFloor =
    R"({"kind": "static",
        "shapes": [{"kind": "half_space", "normal": [0, 1], "material": "stone"}]})";
constexpr const char* kBox =
    R"("kind": "polygon", "points": [[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])";

/// A scene of the plane with a floor of stone.
scenes::Scene scene_of(const std::string& bodies, const std::string& members = "") {
  const scenes::Loaded loaded = scenes::from_json(
      R"({"gravity": [0, -10], "materials": [{"name": "stone"}, {"name": "rubber"}], )" + members +
      "\"bodies\": [" + kFloor + ", " + bodies + "]}");
  for (const scenes::Mistake& mistake : loaded.mistakes)
    ADD_FAILURE() << mistake.path << ": " << mistake.reason;
  return loaded.scene.value_or(scenes::Scene{});
}

PartNeed part_of(const scenes::Scene& scene, const std::string& part,
                 const NeedsRequest& request = {0.001, 120}) {
  for (const PartNeed& need : find_needs(scene, accuracy::Setting{}, request)) {
    if (need.verdict == PartVerdict::kNotNeeded) {
      EXPECT_LE(need.moved_m, request.bound_m) << need.part << ": " << need.finding;
      EXPECT_TRUE(need.measured) << need.part;
      EXPECT_FALSE(need.change.empty() && need.part != "all") << need.part;
    }
    if (need.part == part) return need;
  }
  ADD_FAILURE() << "nothing is said of " << part;
  return {};
}

PartVerdict verdict_of(const scenes::Scene& scene, const std::string& part) {
  return part_of(scene, part).verdict;
}

std::string box_at(const std::string& position, const std::string& members = "") {
  return "{\"position\": [" + position + "], " + members + "\"shapes\": [{" + kBox + "}]}";
}

TEST(PartNeeds, RotationOfWhatStandsIsNotNeededAndOfWhatRollsIs) {
  const scenes::Scene stands = scene_of(box_at("0, 0.5") + ", " + box_at("3, 0.5"));
  const PartNeed need = part_of(stands, "rotation");
  EXPECT_EQ(need.verdict, PartVerdict::kNotNeeded) << need.finding;
  EXPECT_LT(need.without.turning_rows_per_sweep, need.with.turning_rows_per_sweep);
  EXPECT_THAT(need.change, HasSubstr("bodies 1, 2"));
  const std::string ball =
      R"({"position": [0, 0.5], "velocity": [2], "shapes": [{"radius": 0.5}]})";
  EXPECT_EQ(verdict_of(scene_of(ball), "rotation"), PartVerdict::kNeeded);
  // Of two bodies the one that stands.
  const PartNeed one = part_of(scene_of(ball + ", " + box_at("-9, 0.5")), "rotation");
  EXPECT_EQ(one.verdict, PartVerdict::kNotNeeded);
  EXPECT_THAT(one.finding, HasSubstr("1 of 2"));
  EXPECT_THAT(one.change, HasSubstr("bodies 2"));
  EXPECT_EQ(verdict_of(scene_of(box_at("0, 0.5", "\"fixed_rotation\": true, ")), "rotation"),
            PartVerdict::kNotThere);
}

TEST(PartNeeds, TangentsAreNotNeededWhereNothingSlides) {
  const PartNeed falls = part_of(scene_of(box_at("0, 0.6")), "tangents");
  EXPECT_EQ(falls.verdict, PartVerdict::kNotNeeded) << falls.finding;
  EXPECT_LT(falls.without.rows_per_tick, falls.with.rows_per_tick);
  EXPECT_EQ(verdict_of(scene_of(box_at("0, 0.5", "\"velocity\": [1], ")), "tangents"),
            PartVerdict::kNeeded);
  scenes::Scene ice = scene_of(box_at("0, 0.5"));
  for (scenes::SceneMaterial& material : ice.materials) material.friction = 0.0f;
  EXPECT_EQ(verdict_of(ice, "tangents"), PartVerdict::kNotThere);
  // The rubber falls on nothing, so its friction acts on nothing.
  const PartNeed one = part_of(
      scene_of(box_at("0, 0.5", "\"velocity\": [1], ") +
               R"(, {"position": [9, 99], "shapes": [{"radius": 1, "material": "rubber"}]})"),
      "tangents");
  EXPECT_EQ(one.verdict, PartVerdict::kNotNeeded);
  EXPECT_THAT(one.change, HasSubstr("materials rubber"));
}

TEST(PartNeeds, SleepIsKeptWhereABodySleeps) {
  const PartNeed rests = part_of(scene_of(box_at("0, 0.5")), "sleep");
  EXPECT_EQ(rests.verdict, PartVerdict::kNeeded);
  EXPECT_GT(rests.without.rows_per_tick, rests.with.rows_per_tick) << "what sleep saves is shown";
  const PartNeed spins =
      part_of(scene_of(box_at("0, 9", "\"gravity_scale\": 0, \"spin\": [3], ")), "sleep");
  EXPECT_EQ(spins.verdict, PartVerdict::kNotNeeded) << spins.finding;
  EXPECT_EQ(spins.moved_m, 0.0);
  EXPECT_EQ(verdict_of(scene_of(box_at("0, 0.5"), R"("tuning": {"sleep_s": 0}, )"), "sleep"),
            PartVerdict::kNotThere);
}

TEST(PartNeeds, ContinuousCollisionIsNeededByABullet) {
  EXPECT_EQ(verdict_of(scene_of(box_at("0, 0.5")), "continuous"), PartVerdict::kNotNeeded);
  const std::string wall = R"({"kind": "static", "position": [20, 2], "shapes": [{"kind": "polygon",
      "points": [[-0.01, -2], [0.01, -2], [0.01, 2], [-0.01, 2]]}]})";
  const std::string bullet =
      R"({"position": [0, 2], "velocity": [300], "shapes": [{"radius": 0.05}]})";
  EXPECT_EQ(verdict_of(scene_of(wall + ", " + bullet), "continuous"), PartVerdict::kNeeded);
  EXPECT_EQ(
      verdict_of(scene_of(box_at("0, 0.5"), R"("tuning": {"continuous": 0}, )"), "continuous"),
      PartVerdict::kNotThere);
}

TEST(PartNeeds, TheThirdAxisIsNotNeededByMotionInAPlane) {
  const auto box_in_space = [](const std::string& velocity, const std::string& spin) {
    const scenes::Loaded loaded = scenes::from_json(
        R"({"dimension": 3, "gravity": [0, -10], "bodies": [{"position": [0, 9], "velocity": )" +
        velocity + ", \"spin\": " + spin +
        R"(, "shapes": [{"kind": "box", "half": [0.5, 0.5, 0.5]}]}]})");
    EXPECT_TRUE(loaded.scene);
    return loaded.scene.value_or(scenes::Scene{});
  };
  const PartNeed falls = part_of(box_in_space("[2, 0, 0]", "[0, 0, 1]"), "3D");
  EXPECT_EQ(falls.verdict, PartVerdict::kNoSwitch);
  EXPECT_THAT(falls.finding, HasSubstr("across z"));
  EXPECT_THAT(falls.change, HasSubstr("nothing switches it off"));
  EXPECT_EQ(verdict_of(box_in_space("[2, 0, 1]", "[0, 0, 0]"), "3D"), PartVerdict::kNeeded);
  EXPECT_EQ(verdict_of(box_in_space("[0, 0, 0]", "[1, 1, 1]"), "3D"), PartVerdict::kNeeded);
  EXPECT_EQ(verdict_of(scene_of(box_at("0, 0.5")), "3D"), PartVerdict::kNotThere);
}

/// Goal: what is said of each part alone holds for all of them. Method: the last entry ran without
/// all that is not needed.
TEST(PartNeeds, AllThatIsNotNeededIsDroppedAtOnceToo) {
  const PartNeed all = part_of(scene_of(box_at("0, 0.6")), "all");
  EXPECT_EQ(all.verdict, PartVerdict::kNotNeeded) << all.finding;
  EXPECT_LT(all.without.rows_per_tick, all.with.rows_per_tick);
  EXPECT_LE(all.without.error_m, all.with.error_m + 0.001);
}

}  // namespace
}  // namespace cycloid::tuning
