#include <gtest/gtest.h>

#include <set>
#include <string>

#include "cli/sim/world.hpp"

namespace cycloid::sim {
namespace {

/// So many seeds at most until a bug is found.
constexpr std::uint64_t kPlantSeeds = 40;

struct PlantCase {
  Plant plant;
  std::set<Invariant> found_by;  ///< Any of these is a fair way to see it.
};

// A bug shows first where it is looked at first: a client that goes astray may be seen by itself,
// by its state, or by what it says to the room.
const PlantCase kPlants[] = {
    {Plant::kClientSkipsFrame, {Invariant::kHonesty, Invariant::kDigests}},
    {Plant::kClientAppliesLateInput, {Invariant::kDigests, Invariant::kHonesty}},
    {Plant::kClientComparesUnconfirmed, {Invariant::kHonesty}},
    {Plant::kRoomRepeatsFrame, {Invariant::kFrames}},
    {Plant::kRoomSwapsFrames, {Invariant::kFrames}},
    {Plant::kRoomForgetsEventAtSnapshot, {Invariant::kFrames}},
    {Plant::kRoomSharesSeat, {Invariant::kSeats, Invariant::kHonesty, Invariant::kInputs}},
    {Plant::kRoomOutboxUnbounded, {Invariant::kQueues}},
    {Plant::kRoomExtendsDeadline, {Invariant::kDeadline}},
    {Plant::kSnapshotWithoutImpulses, {Invariant::kDigests, Invariant::kHonesty}},
    {Plant::kLogDropsRecord, {Invariant::kLog}},
    {Plant::kLogSwapsRecords, {Invariant::kLog}},
    {Plant::kLogForgetsSync, {Invariant::kLog}},
    {Plant::kLogSpoilsKeyframe, {Invariant::kLog}},
    {Plant::kGateTrustsTokens, {Invariant::kRefusals}},
    {Plant::kRoomGivesEqualSecrets, {Invariant::kHonesty}},
    {Plant::kRoomHidesRewind, {Invariant::kFrames, Invariant::kHonesty}},
    {Plant::kRoomForgetsDelay, {Invariant::kDelay}},
};

class SimPlants : public testing::TestWithParam<PlantCase> {};

// The same seeds without a plant pass: SimWorld.HoldsItsInvariantsUnderTheQuickSeeds.
TEST_P(SimPlants, AreFound) {
  const PlantCase& planted = GetParam();
  for (std::uint64_t seed = 1; seed <= kPlantSeeds; ++seed) {
    Settings settings = draw_settings(seed);
    settings.plant = planted.plant;
    const SimReport report = simulate(settings);
    if (report.passed()) continue;
    EXPECT_TRUE(planted.found_by.contains(report.violation->invariant))
        << "seed " << seed << ": " << invariant_name(report.violation->invariant) << ": "
        << report.violation->text;
    RecordProperty("seed", std::to_string(seed));
    return;
  }
  FAIL() << plant_name(planted.plant) << " is not found in " << kPlantSeeds << " seeds";
}

// Every byte of its hello begins the wait anew, and nothing else about it is wrong: of an address
// that has said many bytes nobody is refused.
TEST(SimPlantOfTheDeadline, IsSeenByTheDeadlineAlone) {
  for (std::uint64_t seed = 1; seed <= kPlantSeeds; ++seed) {
    Settings settings = draw_settings(seed);
    settings.plant = Plant::kRoomExtendsDeadline;
    const SimReport report = simulate(settings);
    if (report.passed()) continue;
    EXPECT_EQ(report.violation->invariant, Invariant::kDeadline)
        << "seed " << seed << ": " << report.violation->text;
  }
}

std::string name_of(const testing::TestParamInfo<PlantCase>& info) {
  std::string name = plant_name(info.param.plant);
  std::erase(name, '-');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Each, SimPlants, testing::ValuesIn(kPlants), name_of);

TEST(SimPlantList, HasEveryPlant) {
  std::set<Plant> listed;
  for (const PlantCase& planted : kPlants) listed.insert(planted.plant);
  EXPECT_EQ(listed.size() + 1, static_cast<std::size_t>(Plant::kCount));
}

}  // namespace
}  // namespace cycloid::sim
