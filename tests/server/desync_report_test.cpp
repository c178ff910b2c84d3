#include <gmock/gmock.h>

#include "tests/server/desync_fixture.hpp"

namespace cycloid::server {
namespace {

/// Where a bit flips in a client, and how the report has to call that.
struct Flip {
  const char* scene;
  const char* kind;   ///< "body", "joint", "contact" or "register".
  std::size_t slot;   ///< kBusiest: the first whose number is not 0.
  const char* field;  ///< As the report names it.
  int bit;
};

constexpr std::size_t kBusiest = 1000;

/// The number that a flip is of, in a state of either dimension.
template <class State>
std::pair<std::size_t, std::uint32_t> flip_in(State& state, const Flip& flip) {
  const std::string kind = flip.kind;
  const std::string field = flip.field;
  std::size_t slot = flip.slot;
  const auto busiest = [&](const auto& array, const auto& number) {
    if (slot != kBusiest) return;
    for (slot = 0; slot + 1 < array.size() && number(array[slot]) == 0.0f;) ++slot;
  };
  const auto flip_float = [&](float& value) {
    flip_bit(value, flip.bit);
    return std::bit_cast<std::uint32_t>(value);
  };
  if (kind == "joint") {
    busiest(state.joints, [](const auto& joint) { return joint.impulse[0]; });
    return {slot, flip_float(state.joints.moved(slot).impulse[0])};
  }
  if (kind == "contact") {
    busiest(state.contacts,
            [](const auto& contact) { return contact.points[0].tangent_impulse[0]; });
    return {slot, flip_float(state.contacts.at(slot).points[0].tangent_impulse[0])};
  }
  if (kind == "register") {
    flip_bit(state.registers.at(slot), flip.bit);
    return {slot, state.registers.at(slot)};
  }
  return state.bodies.edit_one(slot, [&](auto& body) -> std::pair<std::size_t, std::uint32_t> {
    if (field == "position[0]") return {slot, flip_float(body.position[0])};
    if (field == "velocity[1]") return {slot, flip_float(body.velocity[1])};
    if (field == "gravity_scale") return {slot, flip_float(body.gravity_scale)};
    ADD_FAILURE() << field;
    return {slot, 0};
  });
}

class DesyncFlip : public DesyncTest, public testing::WithParamInterface<Flip> {};

TEST_P(DesyncFlip, OfOneBitIsNamedExactlyAndTheClientGoesOn) {
  const Flip& flip = GetParam();
  constexpr std::uint64_t kTick = 57;
  open(flip.scene, 2);
  run_to(kTick);
  ASSERT_EQ(guests_[1].replica->simulation().tick(), kTick)
      << guests_[1].replica->progress().reason;
  std::size_t slot = 0;
  std::uint32_t flipped = 0;
  change_state(guests_[1].replica->simulation(),
               [&](auto& state) { std::tie(slot, flipped) = flip_in(state, flip); });
  run_to(200);
  ASSERT_EQ(findings_.size(), 1u);
  const DesyncReport report = investigate(findings_[0]);

  EXPECT_EQ(report.tick, kTick);
  EXPECT_TRUE(report.is_first);
  EXPECT_EQ(report.noticed_tick, 60u);
  ASSERT_EQ(report.values.size(), 1u);
  EXPECT_EQ(report.differences, 1u);
  EXPECT_EQ(report.objects, 1u);
  const ReportedValue& value = report.values[0];
  EXPECT_EQ(value.object, std::string(flip.kind) + " " + std::to_string(slot));
  EXPECT_EQ(value.field, flip.field);
  EXPECT_EQ(value.bits, 1);
  char hex[16];
  (void)std::snprintf(hex, sizeof hex, "(0x%08x)", flipped);
  EXPECT_THAT(value.client, testing::HasSubstr(hex));
  (void)std::snprintf(hex, sizeof hex, "(0x%08x)", flipped ^ (1u << flip.bit));
  EXPECT_THAT(value.server, testing::HasSubstr(hex));
  EXPECT_EQ(report.phase, "state");
  EXPECT_FALSE(report.server_suspect);
  EXPECT_EQ(report.remade_digest, report.server_digest);
  EXPECT_THAT(report.notes, testing::IsEmpty());
  EXPECT_EQ(report.inputs.size(), 17u);
  EXPECT_EQ(report.client.build, "client build");
  EXPECT_EQ(report.room.build, "server build");
  EXPECT_EQ(report.votes.replicas, 2u);
  EXPECT_EQ(report.votes.with_server, 1u);

  run_to(400);
  expect_in_sync(guests_[0], 0);
  expect_in_sync(guests_[1], 1);
  EXPECT_EQ(findings_.size(), 1u);
  EXPECT_THAT(notices_, testing::ElementsAre(report_line(report)));
  EXPECT_EQ(inquiry_->desk().held_bytes(), 0u);
}

INSTANTIATE_TEST_SUITE_P(
    OneField, DesyncFlip,
    testing::Values(Flip{"half-pipe", "body", 1, "position[0]", 0},
                    Flip{"ragdolls-3d", "body", 9, "position[0]", 3},
                    Flip{"ragdolls", "body", 4, "velocity[1]", 22},
                    Flip{"ragdolls", "joint", kBusiest, "impulse[0]", 20},
                    Flip{"ragdolls-3d", "joint", kBusiest, "impulse[0]", 20},
                    Flip{"pyramid-20", "contact", kBusiest, "points[0].tangent_impulse", 22},
                    Flip{"pyramid-3d", "contact", kBusiest, "points[0].tangent_impulse[0]", 22},
                    Flip{"character-course", "register", 1, "position[0]", 12},
                    Flip{"character-course-3d", "register", 2, "position[0]", 12},
                    Flip{"vehicle-3d", "body", 1, "gravity_scale", 10}),
    [](const auto& tested) {
      std::string name =
          std::string(tested.param.scene) + "_" + tested.param.kind + "_" + tested.param.field;
      std::erase_if(name, [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) == 0 && c != '_';
      });
      return name;
    });

class DesyncBreaks : public DesyncTest {
 protected:
  /// A client whose state differs from tick 57 on, shortly after both have said their digests.
  void diverge() {
    open("half-pipe", 2);
    run_to(57);
    change_state(guests_[1].replica->simulation(),
                 [](auto& state) { flip_bit(state.bodies.moved(1).position[0], 0); });
    run_to(65);
    ASSERT_EQ(inquiry_->desk().open(), 1u);
    ASSERT_TRUE(findings_.empty()) << "it waits for the others' votes";
  }
};

TEST_F(DesyncBreaks, TheEndOfTheMatchLosesNoFinding) {
  diverge();
  room_->drain("over");
  ASSERT_EQ(findings_.size(), 1u);
  const DesyncReport report = investigate(findings_[0]);
  EXPECT_EQ(report.tick, 57u);
  EXPECT_EQ(report.differences, 1u);
  EXPECT_EQ(report.votes.replicas, 2u);
  EXPECT_EQ(report.inputs.size(), 17u) << "8 ticks before, and 8 after";
  EXPECT_EQ(inquiry_->desk().open(), 0u);
}

TEST_F(DesyncBreaks, ARewindEndsTheFindingWithWhatWasOfItsBranch) {
  diverge();
  ASSERT_TRUE(room_->rewind(50));
  ASSERT_EQ(findings_.size(), 1u);
  run_to(200);
  EXPECT_EQ(findings_.size(), 1u);
  const DesyncReport report = investigate(findings_[0]);
  EXPECT_EQ(report.tick, 57u);
  EXPECT_EQ(report.differences, 1u);
  EXPECT_FALSE(report.server_suspect);
  EXPECT_EQ(report.votes.with_server, 1u);
  EXPECT_EQ(report.remade_digest, report.server_digest);
  EXPECT_EQ(findings_[0].ticks.back().frame.tick, 65u) << "nothing of the branch that goes on";
  EXPECT_EQ(notices_.size(), 1u) << "its client is told";
}

}  // namespace
}  // namespace cycloid::server
