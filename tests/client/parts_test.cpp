#include <gtest/gtest.h>

#include "client/replica/replica.hpp"
#include "client/replica/thin.hpp"
#include "protocol/state/exact_delta.hpp"
#include "protocol/state/quantised_delta.hpp"
#include "tests/client/fed.hpp"

namespace cycloid::client {
namespace {

/// The state as the server sends it: in parts of at most `bytes_max` bytes.
std::vector<protocol::SnapshotPart> parts_of(const protocol::Snapshot& state,
                                             std::size_t bytes_max = 16384) {
  std::vector<protocol::SnapshotPart> parts;
  for (std::size_t at = 0; at < state.state.size(); at += bytes_max) {
    protocol::SnapshotPart& part = parts.emplace_back();
    part.tick = state.tick;
    part.digest = state.digest;
    part.total_bytes = static_cast<std::uint32_t>(state.state.size());
    part.offset = static_cast<std::uint32_t>(at);
    const std::size_t end = std::min(at + bytes_max, state.state.size());
    part.bytes.assign(state.state.begin() + static_cast<std::ptrdiff_t>(at),
                      state.state.begin() + static_cast<std::ptrdiff_t>(end));
  }
  return parts;
}

protocol::RoomNotice rewound_to(std::uint64_t tick) {
  protocol::RoomNotice notice;
  notice.kind = protocol::NoticeKind::kRewound;
  notice.value = tick;
  return notice;
}

using ReplicaParts = Fed<Replica>;
using ThinStates = Fed<Thin>;

TEST_F(ReplicaParts, FramesBetweenThePartsAreCaughtUpWithWhenTheStateIsWhole) {
  for (int i = 0; i < 40; ++i) authority_.frame();
  feed(authority_.welcome(0));
  const auto parts = parts_of(authority_.snapshot(), 1000);
  ASSERT_GT(parts.size(), 20u);
  for (const protocol::SnapshotPart& part : parts) {
    EXPECT_EQ(follower_.progress().phase, Phase::kLoading);
    feed(part);
    if (&part != &parts.back()) feed(authority_.frame());
  }
  EXPECT_EQ(follower_.progress().phase, Phase::kRunning) << follower_.progress().reason;
  EXPECT_EQ(follower_.progress().first_tick, 40u);
  EXPECT_EQ(follower_.progress().last_tick, 40 + parts.size() - 1);
  EXPECT_EQ(follower_.progress().frames, parts.size() - 1);
  EXPECT_EQ(follower_.simulation().digest(), authority_.simulation().digest());
  feed(authority_.frame());
  feed(authority_.digest());
  EXPECT_EQ(follower_.progress().digests_compared, 1u);
  EXPECT_EQ(follower_.progress().mismatches, 0u);
}

TEST_F(ReplicaParts, DigestsBetweenThePartsAreComparedAtTheirTicks) {
  feed(authority_.welcome(0));
  for (const protocol::SnapshotPart& part : parts_of(authority_.snapshot(), 4000)) {
    feed(authority_.frame());
    feed(authority_.digest());
    feed(part);
  }
  EXPECT_GT(follower_.progress().digests_compared, 5u);
  EXPECT_EQ(follower_.progress().digests_compared, follower_.progress().frames);
  EXPECT_EQ(follower_.progress().mismatches, 0u);
}

TEST_F(ReplicaParts, AStateThatBeginsAgainReplacesTheOneBefore) {
  feed(authority_.welcome(0));
  const auto first = parts_of(authority_.snapshot(), 4000);
  feed(first[0]);
  feed(first[1]);
  for (int i = 0; i < 5; ++i) feed(authority_.frame());
  for (const protocol::SnapshotPart& part : parts_of(authority_.snapshot(), 4000)) feed(part);
  EXPECT_EQ(follower_.progress().first_tick, 5u);
  EXPECT_EQ(follower_.simulation().digest(), authority_.simulation().digest());
}

TEST_F(ReplicaParts, DivergedReplicaIsMendedWhileFramesGoOn) {
  start();
  for (int i = 0; i < 10; ++i) feed(authority_.frame());
  disturb(follower_.simulation());
  feed(authority_.frame());
  feed(authority_.digest());
  ASSERT_TRUE(follower_.diverged());
  for (const protocol::SnapshotPart& part : parts_of(authority_.snapshot(), 4000)) {
    feed(authority_.frame());
    feed(part);
  }
  EXPECT_FALSE(follower_.diverged());
  EXPECT_EQ(follower_.progress().resyncs, 1u);
  EXPECT_EQ(follower_.progress().frames, authority_.simulation().tick());
  EXPECT_EQ(follower_.progress().last_tick, authority_.simulation().tick());
  EXPECT_EQ(follower_.simulation().digest(), authority_.simulation().digest());
}

TEST_F(ReplicaParts, WrongPartsEndTheSessionAndHoldNothing) {
  const auto parts = parts_of(authority_.snapshot(), 4000);
  const auto changed = [&](std::size_t at, auto change) {
    protocol::SnapshotPart part = parts[at];
    change(part);
    return part;
  };
  struct Case {
    const char* words;
    std::size_t before;  ///< Good parts ahead of the wrong one.
    protocol::SnapshotPart part;
  };
  const Case cases[] = {
      {"of 1 to 67108864", 0, changed(0, [](auto& part) { part.total_bytes = 0xffffffff; })},
      {"of 1 to 67108864", 0, changed(0, [](auto& part) { part.total_bytes = 0; })},
      {"holds 0 bytes", 0, changed(0, [](auto& part) { part.bytes.clear(); })},
      {"holds 16385 bytes", 0, changed(0, [](auto& part) { part.bytes.resize(16385); })},
      {"has not begun", 0, parts[1]},
      {"begins at byte 8000 instead of 4000", 1, parts[2]},
      {"of another state", 1, changed(1, [](auto& part) { ++part.tick; })},
      {"of another state", 1, changed(1, [](auto& part) { ++part.digest; })},
      {"of another state", 1, changed(1, [](auto& part) { ++part.total_bytes; })},
      {"ends behind", 1, changed(1, [](auto& part) { part.offset = part.total_bytes - 1; })},
      {"ends behind", 1, changed(1, [](auto& part) { part.offset = 0xffffffff; })},
      {"corrupt", parts.size() - 1,
       changed(parts.size() - 1, [](auto& part) { part.bytes.back() ^= std::byte{0xff}; })},
  };
  for (const Case& wrong : cases) {
    Replica follower(make(), options());
    Outbox out;
    follower.receive(authority_.welcome(0), out);
    for (std::size_t i = 0; i < wrong.before; ++i) follower.receive(parts[i], out);
    ASSERT_EQ(follower.progress().phase, Phase::kLoading);
    follower.receive(wrong.part, out);
    EXPECT_EQ(follower.progress().phase, Phase::kFailed) << wrong.words;
    EXPECT_NE(follower.progress().reason.find(wrong.words), std::string::npos)
        << follower.progress().reason;
  }
}

TEST_F(ReplicaParts, TheLimitOfTheOptionsIsCheckedBeforeAnythingIsKept) {
  FollowerOptions few = options();
  few.snapshot_bytes_max = 10000;
  Replica follower(make(), few);
  follower.receive(authority_.welcome(0), outbox_);
  follower.receive(parts_of(authority_.snapshot()).front(), outbox_);
  EXPECT_EQ(follower.progress().phase, Phase::kFailed);
  EXPECT_NE(follower.progress().reason.find("of 1 to 10000"), std::string::npos);
}

TEST_F(ReplicaParts, FramesThatWaitForTheStateAreBounded) {
  FollowerOptions few = options();
  few.frames_waiting_max = 10;
  Replica follower(make(), few);
  follower.receive(authority_.welcome(0), outbox_);
  for (int i = 0; i < 10; ++i) follower.receive(authority_.frame(), outbox_);
  EXPECT_EQ(follower.progress().phase, Phase::kLoading);
  follower.receive(authority_.frame(), outbox_);
  EXPECT_EQ(follower.progress().phase, Phase::kFailed);
  EXPECT_NE(follower.progress().reason.find("more than 10 frames"), std::string::npos);
}

TEST_F(ReplicaParts, RewoundMatchGoesOnFromTheExactStateOfTheEarlierTick) {
  start();
  protocol::Snapshot earlier;
  for (int i = 0; i < 30; ++i) {
    feed(authority_.frame());
    if (i == 19) earlier = authority_.snapshot();
  }
  ASSERT_TRUE(authority_.simulation().decode(earlier.state).ok());
  feed(rewound_to(20));
  EXPECT_EQ(follower_.progress().phase, Phase::kLoading);
  EXPECT_EQ(follower_.progress().last_tick, 20u);
  outbox_.clear();
  for (const protocol::SnapshotPart& part : parts_of(earlier, 10000)) {
    protocol::InputFrame frame;  // Another history than the one before.
    frame.tick = authority_.simulation().tick() + 1;
    frame.seats.resize(static_cast<std::size_t>(authority_.simulation().seats()));
    for (protocol::SeatFrame& seat : frame.seats) seat.input.axes[0] = -20000;
    std::vector<scenes::SeatInput> inputs;
    for (const protocol::SeatFrame& seat : frame.seats) inputs.push_back(seat.input);
    ASSERT_TRUE(authority_.simulation().step(inputs).ok());
    feed(frame);
    feed(part);
  }
  ASSERT_EQ(follower_.progress().phase, Phase::kRunning) << follower_.progress().reason;
  EXPECT_EQ(follower_.progress().rewinds, 1u);
  EXPECT_EQ(follower_.progress().last_tick, authority_.simulation().tick());
  EXPECT_EQ(follower_.simulation().digest(), authority_.simulation().digest());
  const auto inputs = all_of<protocol::Input>(outbox_);
  ASSERT_FALSE(inputs.empty());
  EXPECT_EQ(inputs.front().tick, authority_.simulation().tick() + 2 - (inputs.size() - 1));
}

TEST_F(ReplicaParts, AnnouncedInputDelayHoldsFromItsFrameOn) {
  start();
  feed(authority_.frame());
  outbox_.clear();
  protocol::InputFrame frame = authority_.frame();
  frame.changes.push_back({protocol::ChangeKind::kInputDelay, 5});
  feed(frame);
  const auto inputs = all_of<protocol::Input>(outbox_);
  ASSERT_FALSE(inputs.empty());
  EXPECT_EQ(inputs.front().tick, 4u);
  EXPECT_EQ(inputs.back().tick, 7u);
  protocol::InputFrame wrong = authority_.frame();
  wrong.changes.push_back({protocol::ChangeKind::kInputDelay, 100000});
  feed(wrong);
  expect_failed("changes the input delay to 100000");
}

/// Notes what it was told.
struct Watching final : Witness {
  std::vector<std::uint64_t> ticks;
  std::vector<std::uint64_t> digests;
  std::uint64_t diverged_tick = 0;
  std::uint64_t wanted_tick = 0;
  int replacements = 0;
  void confirmed(const scenes::Simulation& simulation) override {
    ticks.push_back(simulation.tick());
    digests.push_back(simulation.digest());
  }
  void replaced(const scenes::Simulation&) override { ++replacements; }
  void diverged(std::uint64_t tick, Outbox& out) override {
    diverged_tick = tick;
    out.emplace_back(protocol::TickDigests{1, digests});
  }
  void wanted(const protocol::StateWanted& wanted, Outbox&) override { wanted_tick = wanted.tick; }
};

TEST_F(ReplicaParts, WitnessSeesConfirmedStatesOnlyWhateverIsPredicted) {
  FollowerOptions predicting = options();
  predicting.predict_ticks = 8;
  const auto witness = std::make_shared<Watching>();
  predicting.witness = witness;
  Replica follower(make(), predicting);
  protocol::Welcome welcome = authority_.welcome(0);
  welcome.input_delay_ticks = 6;
  follower.receive(welcome, outbox_);
  follower.receive(authority_.snapshot(), outbox_);
  std::vector<std::uint64_t> right;
  for (std::uint64_t tick = 1; tick <= 30; ++tick) {
    follower.receive(authority_.frame(), outbox_);
    right.push_back(authority_.simulation().digest());
    follower.settle();
    EXPECT_EQ(follower.simulation().tick(), tick + 6);
  }
  EXPECT_EQ(witness->digests, right);
  EXPECT_EQ(witness->ticks.back(), 30u);
  EXPECT_EQ(witness->replacements, 1);
  follower.receive(protocol::Digest{30, 7}, outbox_);
  EXPECT_EQ(witness->diverged_tick, 30u);
  EXPECT_EQ(all_of<protocol::TickDigests>(outbox_).size(), 1u);
  follower.receive(protocol::StateWanted{9}, outbox_);
  EXPECT_EQ(witness->wanted_tick, 9u);
}

/// A state as its tick alone, on a baseline or on none.
struct CountingDecoder final : StateDecoder {
  std::string decode(const protocol::StateDelta& delta, const DecodedState* baseline,
                     DecodedState& into) override {
    if (baseline != nullptr && baseline->tick != delta.baseline_tick) return "another baseline";
    if (delta.bytes.empty()) return "empty";
    into.quantised.bodies.resize(1);
    into.quantised.bodies[0].position[0] = static_cast<std::int32_t>(delta.tick * 512);
    return "";
  }
};

protocol::StateDelta quantised(std::uint64_t tick, std::uint64_t baseline) {
  return {tick, baseline, tick * 3, protocol::Profile::kQuantised, {std::byte{1}}};
}

TEST_F(ThinStates, ExactDeltasOnWhatWasAcknowledgedGiveTheStateToTheBit) {
  start();
  protocol::Snapshot before = authority_.snapshot();
  std::size_t bytes = 0;
  for (int i = 0; i < 20; ++i) {
    for (int tick = 0; tick < 3; ++tick) authority_.frame();
    const protocol::Snapshot now = authority_.snapshot();
    protocol::StateDelta delta{now.tick, before.tick, now.digest, protocol::Profile::kExact, {}};
    const bool from_nothing = before.tick == 0;
    ASSERT_TRUE(protocol::encode_exact_delta(
        from_nothing ? std::span<const std::byte>() : std::span<const std::byte>(before.state),
        now.state, delta.bytes));
    if (!from_nothing) bytes = std::max(bytes, delta.bytes.size());
    feed(delta);
    ASSERT_EQ(follower_.progress().phase, Phase::kRunning) << follower_.progress().reason;
    EXPECT_EQ(follower_.digest(), authority_.simulation().digest());
    before = now;
  }
  EXPECT_LT(bytes, before.state.size() / 2);
  const auto acks = all_of<protocol::Ack>(outbox_);
  ASSERT_EQ(acks.size(), 21u);
  EXPECT_EQ(acks.back().tick, 60u);
}

TEST_F(ThinStates, QuantisedDeltasGoOnFromTheExactStateAndStayWithinTheGrid) {
  FollowerOptions quantising = options();
  quantising.profile = protocol::Profile::kQuantised;
  Thin follower(make(), quantising);
  for (int i = 0; i < 5; ++i) authority_.frame();
  follower.receive(authority_.welcome(0), outbox_);
  for (const auto& part : parts_of(authority_.snapshot())) follower.receive(part, outbox_);
  protocol::HeldState held;
  held.state = protocol::capture(authority_.simulation());
  for (int i = 0; i < 20; ++i) {
    const std::uint64_t baseline = authority_.simulation().tick();
    authority_.frame();
    const auto now = protocol::capture(authority_.simulation());
    const auto delta = protocol::encode_quantised(&held, now, 1u << 20);
    held = delta.held;
    follower.receive(protocol::StateDelta{now.tick, baseline, protocol::digest_of(held.state),
                                          protocol::Profile::kQuantised, delta.bytes},
                     outbox_);
    ASSERT_EQ(follower.progress().phase, Phase::kRunning) << follower.progress().reason;
    const auto right = authority_.simulation().poses();
    const auto shown = follower.poses();
    ASSERT_EQ(shown.size(), right.size());
    for (std::size_t body = 0; body < right.size(); ++body) {
      EXPECT_EQ(shown[body].index, right[body].index);
      for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_NEAR(shown[body].position[axis], right[body].position[axis], 0.001);
    }
  }
  EXPECT_EQ(follower.progress().last_tick, 25u);
}

TEST_F(ThinStates, AreAlsoTakenInParts) {
  feed(authority_.welcome(0));
  for (const auto& part : parts_of(authority_.snapshot(), 5000)) feed(part);
  EXPECT_EQ(follower_.progress().phase, Phase::kRunning);
  EXPECT_EQ(all_of<protocol::Ack>(outbox_).size(), 1u);
}

TEST_F(ThinStates, DeltaOfABaselineThatIsNotHeldIsDroppedAndNotAcknowledged) {
  FollowerOptions decoding = options();
  decoding.decoder = std::make_shared<CountingDecoder>();
  Thin follower(make(), decoding);
  follower.receive(authority_.welcome(0), outbox_);
  follower.receive(quantised(1, 0), outbox_);
  follower.receive(quantised(4, 1), outbox_);
  follower.receive(quantised(7, 3), outbox_);
  EXPECT_EQ(follower.progress().deltas_dropped, 1u);
  EXPECT_EQ(follower.progress().last_tick, 4u);
  EXPECT_EQ(follower.digest(), 12u);
  EXPECT_EQ(follower.poses().at(0).position[0], 4.0f);
  EXPECT_EQ(all_of<protocol::Ack>(outbox_).size(), 2u);
  follower.receive(quantised(8, 4), outbox_);
  EXPECT_EQ(follower.baselines(), 2u) << "what is older than the server's baseline is let go";
  for (std::uint64_t tick = 9; tick < 300; ++tick) follower.receive(quantised(tick, 4), outbox_);
  EXPECT_EQ(follower.baselines(), Thin::kBaselinesMax);
  EXPECT_EQ(follower.progress().last_tick, 299u);
  follower.receive(quantised(200, 4), outbox_);
  EXPECT_EQ(follower.progress().phase, Phase::kFailed) << "older than what is held";
}

TEST_F(ThinStates, CorruptDeltasEndTheSession) {
  const protocol::Snapshot state = authority_.snapshot();
  protocol::StateDelta good{0, 0, state.digest, protocol::Profile::kExact, {}};
  ASSERT_TRUE(protocol::encode_exact_delta({}, state.state, good.bytes));
  protocol::StateDelta torn = good;
  torn.bytes.resize(torn.bytes.size() / 2);
  protocol::StateDelta other_tick = good;
  other_tick.tick = 1;
  protocol::StateDelta lying = quantised(1, 0);
  lying.bytes =
      protocol::encode_quantised(nullptr, protocol::capture(authority_.simulation()), 4096).bytes;
  for (const protocol::StateDelta& wrong : {torn, other_tick, lying, quantised(1, 0)}) {
    Thin follower(make(), options());
    follower.receive(authority_.welcome(0), outbox_);
    follower.receive(wrong, outbox_);
    EXPECT_EQ(follower.progress().phase, Phase::kFailed);
    EXPECT_NE(follower.progress().reason, "");
  }
}

}  // namespace
}  // namespace cycloid::client
