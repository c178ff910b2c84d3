#include <gmock/gmock.h>

#include <bit>
#include <random>

#include "server/desync/inquiry.hpp"
#include "server/desync/report.hpp"
#include "solver/encoding.hpp"
#include "tests/server/kept_evidence.hpp"
#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

using testing::HasSubstr;

/// A server's world with its desk, and an honest replica beside it whose bits a test may flip.
class DesyncDeskTest : public testing::Test {
 protected:
  static constexpr std::int64_t kSecondNs = 1'000'000'000;

  void open(DesyncDeskOptions options = {}, std::uint64_t state_ticks = 60) {
    auto identity = std::make_shared<RoomIdentity>();
    identity->room = "arena";
    identity->scene = std::make_shared<const scenes::Scene>(two_seat_scene());
    identity->scene_digest = scenes::scene_digest(*identity->scene);
    identity_ = identity;
    server_.emplace(simulation_of(*identity_->scene));
    client_.emplace(simulation_of(*identity_->scene));
    desk_.emplace(options, identity_);
    evidence_.emplace(state_ticks, *server_);
  }

  void step() {
    protocol::InputFrame frame;
    frame.tick = server_->tick() + 1;
    frame.seats = {{protocol::Origin::kGiven, push(9000)}, {protocol::Origin::kAbsent, {}}};
    const std::vector<scenes::SeatInput> inputs = {frame.seats[0].input, frame.seats[1].input};
    ASSERT_TRUE(server_->step(inputs).ok());
    ASSERT_TRUE(client_->step(inputs).ok());
    client_digests_.push_back(client_->digest());
    evidence_->add(std::move(frame), *server_);
    now_ += kSecondNs / 60;
  }
  void step_to(std::uint64_t tick) {
    while (server_->tick() < tick) step();
  }

  /// One bit of the x of ball `body`, between two ticks.
  static void flip(scenes::Simulation& simulation, std::size_t body, int bit) {
    auto state = simulation.planar()->state();
    float& x = state.bodies.moved(body).position[0];
    x = std::bit_cast<float>(std::bit_cast<std::uint32_t>(x) ^ (1u << bit));
    simulation.planar()->restore(state);
  }

  bool mismatch(PeerId peer) {
    const protocol::Digest said{server_->tick(), client_->digest()};
    desk_->on_digest(peer, said.tick, said.digest);
    return desk_->on_mismatch({peer, "guest", "their build", 0}, said, now_, *evidence_);
  }
  /// Of all ticks so far, as the client has them.
  protocol::TickDigests digests() const { return {1, client_digests_}; }

  void send_state(PeerId peer, std::uint64_t tick, const std::vector<std::byte>& state) {
    for (std::size_t at = 0; at < state.size(); at += protocol::kStatePartBytesMax) {
      const std::size_t size = std::min(protocol::kStatePartBytesMax, state.size() - at);
      desk_->on_state_part(peer,
                           {tick,
                            static_cast<std::uint32_t>(state.size()),
                            static_cast<std::uint32_t>(at),
                            {state.begin() + at, state.begin() + at + size}},
                           *evidence_);
    }
  }
  static std::vector<std::byte> encoded(const scenes::Simulation& simulation) {
    std::vector<std::byte> state;
    simulation.encode(state);
    return state;
  }

  /// A client whose state differs from tick 20 on; the tick that it is asked for.
  std::uint64_t diverge(PeerId peer = 1) {
    step_to(19);
    step();
    flip(*client_, 1, 0);
    client_digests_.back() = client_->digest();
    state_ = encoded(*client_);
    step_to(30);
    EXPECT_TRUE(mismatch(peer));
    const auto wanted = desk_->on_tick_digests(peer, digests(), *evidence_);
    return wanted ? wanted->tick : 0;
  }
  /// The one finding that there is once all waits are over.
  Finding only_finding() {
    auto findings = desk_->take_findings(now_ + 20 * kSecondNs, *evidence_);
    EXPECT_EQ(findings.size(), 1u);
    EXPECT_EQ(desk_->open(), 0u);
    EXPECT_EQ(desk_->held_bytes(), 0u);
    return findings.empty() ? Finding{} : std::move(findings[0]);
  }

  std::shared_ptr<const RoomIdentity> identity_;
  std::optional<scenes::Simulation> server_;
  std::optional<scenes::Simulation> client_;
  std::optional<DesyncDesk> desk_;
  std::optional<KeptEvidence> evidence_;
  std::vector<std::uint64_t> client_digests_;
  std::vector<std::byte> state_;  ///< Of the client's first tick that differs.
  std::int64_t now_ = kSecondNs;
};

TEST_F(DesyncDeskTest, AsksForTheFirstTickThatDiffersAndFindsTheBit) {
  open();
  const std::uint64_t tick = diverge();
  ASSERT_EQ(tick, 20u);
  send_state(1, tick, state_);
  const DesyncReport report = investigate(only_finding());
  EXPECT_EQ(report.tick, 20u);
  EXPECT_TRUE(report.is_first);
  ASSERT_EQ(report.values.size(), 1u);
  EXPECT_EQ(report.values[0].object, "body 1");
  EXPECT_EQ(report.values[0].name, "left");
  EXPECT_EQ(report.values[0].field, "position[0]");
  EXPECT_THAT(report.notes, testing::IsEmpty());
}

TEST_F(DesyncDeskTest, NamesAValueThatNoWorldWouldTake) {
  open();
  step_to(20);
  flip(*client_, 1, 30);  // Of about 1, the exponent's highest bit: far out of every range.
  client_digests_.back() = client_->digest();
  const auto state = encoded(*client_);
  const protocol::Digest said{20, client_->digest()};
  ASSERT_TRUE(desk_->on_mismatch({1, "guest", "", 0}, said, now_, *evidence_));
  ASSERT_TRUE(desk_->on_tick_digests(1, digests(), *evidence_));
  send_state(1, 20, state);
  const DesyncReport report = investigate(only_finding());
  ASSERT_EQ(report.differences, 1u);
  EXPECT_EQ(report.values[0].field, "position[0]");
  EXPECT_EQ(report.values[0].bits, 1);
  EXPECT_THAT(report.notes, testing::ElementsAre(HasSubstr("no world can come into")));
}

TEST_F(DesyncDeskTest, GarbageOfTheRightSizeIsNoState) {
  open();
  const std::uint64_t tick = diverge();
  desk_->on_state_part(1, {tick, 1, 0, std::vector<std::byte>(1)}, *evidence_);
  const Finding known = only_finding();
  open();
  client_digests_.clear();
  ASSERT_EQ(diverge(), tick);
  std::mt19937 random(7);
  for (int round = 0; round < 3; ++round) {
    // All of it; all behind the head of an encoding; a few bytes.
    std::vector<std::byte> garbage = state_;
    const std::size_t from = round == 0 ? 0 : 8;
    for (std::size_t i = from; i < garbage.size(); i += round == 2 ? 97 : 1)
      garbage[i] = static_cast<std::byte>(random());
    Finding finding;
    finding.room = identity_;
    finding.tick = finding.noticed_tick = tick;
    finding.start = known.start;
    finding.ticks = known.ticks;
    finding.client_state = garbage;
    const DesyncReport report = investigate(finding);
    EXPECT_FALSE(report.notes.empty());
    EXPECT_LE(report.values.size(), kReportedValuesMax);
  }
  std::vector<std::byte> garbage(state_.size(), std::byte{0xff});
  send_state(1, tick, garbage);
  const DesyncReport report = investigate(only_finding());
  EXPECT_THAT(report.notes, testing::Contains(HasSubstr("the client's state is none")));
}

TEST_F(DesyncDeskTest, ALieAboutTheDigestIsSeen) {
  open();
  const std::uint64_t tick = diverge();
  send_state(1, tick, encoded(*server_));  // Of another tick than it says.
  const DesyncReport report = investigate(only_finding());
  EXPECT_THAT(report.notes, testing::Contains(HasSubstr("it lies, or its memory changes")));
}

TEST_F(DesyncDeskTest, AWrongSizeIsRefusedBeforeAnythingIsHeld) {
  open();
  const std::uint64_t tick = diverge();
  desk_->on_state_part(1, {tick, 0xffffffffu, 0, std::vector<std::byte>(100)}, *evidence_);
  EXPECT_EQ(desk_->held_bytes(), 0u);
  EXPECT_THAT(only_finding().missing, HasSubstr("its state has 4294967295 bytes, of 1 to"));
  EXPECT_EQ(desk_->counts().without, 1u);
}

TEST_F(DesyncDeskTest, PartsOutOfOrderAndOfAnotherTickEndTheInquiry) {
  for (const bool other_tick : {false, true}) {
    open();
    client_digests_.clear();
    const std::uint64_t tick = diverge();
    desk_->on_state_part(1, {tick, 5000, 0, std::vector<std::byte>(3000)}, *evidence_);
    EXPECT_EQ(desk_->held_bytes(), 3000u);
    if (other_tick)
      desk_->on_state_part(1, {tick + 1, 5000, 3000, std::vector<std::byte>(2000)}, *evidence_);
    else
      desk_->on_state_part(1, {tick, 5000, 0, std::vector<std::byte>(3000)}, *evidence_);
    EXPECT_EQ(desk_->held_bytes(), 0u);
    EXPECT_THAT(only_finding().missing, HasSubstr(other_tick ? "tick 21" : "out of order"));
  }
}

TEST_F(DesyncDeskTest, AStateThatChangesItsSizeOnTheWayEndsTheInquiry) {
  for (const std::uint32_t total_bytes : {100u, 5000u, 6000u}) {
    open();
    client_digests_.clear();
    const std::uint64_t tick = diverge();
    desk_->on_state_part(1, {tick, 5000, 0, std::vector<std::byte>(3000)}, *evidence_);
    desk_->on_state_part(1, {tick, total_bytes, 3000, std::vector<std::byte>(3000)}, *evidence_);
    EXPECT_EQ(desk_->held_bytes(), 0u);
    EXPECT_THAT(only_finding().missing, HasSubstr("out of order"));
  }
}

TEST_F(DesyncDeskTest, WhatIsSaidTwiceOrUnaskedIsCountedOnly) {
  open();
  const std::uint64_t tick = diverge();
  send_state(1, tick, state_);
  send_state(1, tick, state_);
  EXPECT_FALSE(desk_->on_tick_digests(1, digests(), *evidence_));
  EXPECT_FALSE(desk_->on_tick_digests(99, digests(), *evidence_));
  EXPECT_GE(desk_->counts().unasked, 3u);
  EXPECT_FALSE(mismatch(1));  // Its inquiry is open.
  EXPECT_EQ(investigate(only_finding()).differences, 1u);
}

TEST_F(DesyncDeskTest, OneThatSaysNothingEndsAtTheDeadline) {
  open();
  step_to(20);
  flip(*client_, 1, 0);
  ASSERT_TRUE(mismatch(1));
  EXPECT_TRUE(desk_->take_findings(now_ + 9 * kSecondNs, *evidence_).empty());
  const auto findings = desk_->take_findings(now_ + 10 * kSecondNs, *evidence_);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].missing, "it did not say which ticks differ");
  const DesyncReport report = investigate(findings[0]);
  EXPECT_EQ(report.tick, 20u);
  EXPECT_FALSE(report.is_first);
  EXPECT_EQ(report.remade_digest, report.server_digest);
}

TEST_F(DesyncDeskTest, DigestsThatFitNothingEndTheInquiry) {
  const std::pair<protocol::TickDigests, const char*> cases[] = {
      {{1, {}}, "that it was not asked for"},
      {{31, {1}}, "that it was not asked for"},
      {{30, {1, 2}}, "that it was not asked for"},
      {{0xffffffffffffffffu, {1, 2}}, "that it was not asked for"},
  };
  for (const auto& [said, why] : cases) {
    open();
    step_to(30);
    flip(*client_, 1, 0);
    ASSERT_TRUE(mismatch(1));
    EXPECT_FALSE(desk_->on_tick_digests(1, said, *evidence_));
    EXPECT_THAT(only_finding().missing, HasSubstr(why));
  }
  open();
  client_digests_.clear();
  step_to(30);
  const protocol::TickDigests equal = digests();
  flip(*client_, 1, 0);
  ASSERT_TRUE(mismatch(1));
  EXPECT_FALSE(desk_->on_tick_digests(1, equal, *evidence_));
  EXPECT_EQ(only_finding().missing, "none of the digests that it sent differs");
}

TEST_F(DesyncDeskTest, OneInquiryAPeerTwoARoomAndSoManyAnHour) {
  DesyncDeskOptions options;
  options.findings_per_hour = 3;
  open(options);
  step_to(20);
  flip(*client_, 1, 0);
  EXPECT_TRUE(mismatch(1));
  EXPECT_FALSE(mismatch(1));
  EXPECT_TRUE(mismatch(2));
  EXPECT_FALSE(mismatch(3));
  desk_->on_leave(1);
  desk_->on_leave(2);
  EXPECT_EQ(desk_->take_findings(now_ + 2 * kSecondNs, *evidence_).size(), 2u);
  EXPECT_TRUE(mismatch(3));
  EXPECT_FALSE(mismatch(4));
  desk_->on_leave(3);
  EXPECT_EQ(desk_->take_findings(now_ + 2 * kSecondNs, *evidence_).size(), 1u);
  EXPECT_FALSE(mismatch(5));
  now_ += 3600 * kSecondNs;
  EXPECT_TRUE(mismatch(6));
  EXPECT_EQ(desk_->counts().skipped, 3u);
}

// Votes come with every digest of a match that goes on for days.
TEST_F(DesyncDeskTest, KeepsTheVotesOf4096PeersAndOfTheLastEightTicks) {
  open();
  step_to(30);
  for (std::uint64_t tick = 1; tick <= 9; ++tick)
    for (PeerId peer = 2; peer <= 4100; ++peer)
      desk_->on_digest(peer, tick, client_digests_[tick - 1]);
  for (const std::uint64_t tick : {1, 2}) {
    const protocol::Digest said{tick, ~client_digests_[tick - 1]};
    ASSERT_TRUE(desk_->on_mismatch({1, "guest", "their build", 0}, said, now_, *evidence_));
    EXPECT_EQ(only_finding().votes.replicas, tick == 1 ? 0u : 4096u);
  }
}

TEST_F(DesyncDeskTest, SuspectsTheServerWhereItsOwnBitFlipped) {
  for (const std::uint64_t state_ticks : {1u, 20u}) {
    open({}, state_ticks);
    client_digests_.clear();
    step_to(22);
    flip(*server_, 2, 1);
    std::vector<std::byte> state;
    step();
    state = encoded(*client_);
    step_to(40);
    for (const PeerId peer : {1u, 2u, 3u}) mismatch(peer);
    const auto wanted = desk_->on_tick_digests(1, digests(), *evidence_);
    ASSERT_TRUE(wanted);
    EXPECT_EQ(wanted->tick, 23u);  // Made by the flipped state; its own digest was taken before.
    send_state(1, 23, state);
    desk_->on_leave(2);
    const auto findings = desk_->take_findings(now_ + 20 * kSecondNs, *evidence_);
    ASSERT_EQ(findings.size(), 2u);
    const DesyncReport report = investigate(findings[0]);
    EXPECT_TRUE(report.server_suspect);
    EXPECT_EQ(report.votes.replicas, 3u);
    EXPECT_EQ(report.votes.largest_other, 3u);
    EXPECT_EQ(report.votes.with_server, 0u);
    EXPECT_EQ(report.verdict, "the server: made again, the tick is as the client has it");
    ASSERT_FALSE(report.values.empty());
    EXPECT_THAT(report.values[0].object, testing::AnyOf("body 2", "contact 1"));
    EXPECT_EQ(report.values_tick, state_ticks == 1 ? 23u : 40u);
    EXPECT_THAT(report_line(report), HasSubstr("the server is suspect"));
  }
}

TEST_F(DesyncDeskTest, TheMajorityAloneMakesTheServerSuspect) {
  ReplicaVotes votes;
  votes.with_server = 1;
  votes.largest_other = 1;
  EXPECT_FALSE(votes.against_server());
  votes.largest_other = 2;
  EXPECT_TRUE(votes.against_server());
  votes.with_server = 2;
  EXPECT_FALSE(votes.against_server());
  votes = {0, 1, 7, 1};  // One replica alone proves nothing.
  EXPECT_FALSE(votes.against_server());
}

TEST_F(DesyncDeskTest, ARewindEndsWhatIsOpenAndMixesNoBranches) {
  open();
  const std::uint64_t tick = diverge();
  const auto findings = desk_->close("the match was taken back meanwhile", *evidence_);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].missing, "the match was taken back meanwhile");
  EXPECT_EQ(findings[0].tick, tick);
  EXPECT_EQ(findings[0].ticks.back().frame.tick, 30u);
  EXPECT_EQ(findings[0].votes.replicas, 1u);
  EXPECT_EQ(desk_->counts().without, 1u);
  EXPECT_EQ(desk_->open(), 0u);

  evidence_->drop_after(10);
  send_state(1, tick, state_);
  EXPECT_FALSE(desk_->on_tick_digests(1, digests(), *evidence_)) << "nobody is asked any more";
  server_.emplace(simulation_of(*identity_->scene));
  evidence_.emplace(60, *server_);
  client_.emplace(simulation_of(*identity_->scene));
  client_digests_.clear();
  step_to(40);
  EXPECT_TRUE(desk_->take_findings(now_ + 20 * kSecondNs, *evidence_).empty());
  flip(*client_, 1, 0);
  EXPECT_TRUE(mismatch(1)) << "and a new desync is looked into";
  EXPECT_EQ(only_finding().votes.replicas, 1u) << "without the votes of before";
}

TEST_F(DesyncDeskTest, WhatIsWholeWhenTheMatchEndsIsFoundWhole) {
  open();
  const std::uint64_t tick = diverge();
  send_state(1, tick, state_);
  step_to(34);
  const auto findings = desk_->close("the match ended", *evidence_);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].missing, "");
  EXPECT_EQ(findings[0].ticks.back().frame.tick, 34u) << "with what was made since";
  EXPECT_EQ(investigate(findings[0]).differences, 1u);
  EXPECT_EQ(desk_->counts().complete, 1u);
}

}  // namespace
}  // namespace cycloid::server
