#include "client/replica/replica.hpp"

#include <gtest/gtest.h>

#include "client/replica/thin.hpp"
#include "solver/version.hpp"
#include "tests/client/fed.hpp"

namespace cycloid::client {
namespace {

using ReplicaTest = Fed<Replica>;
using ThinTest = Fed<Thin>;

TEST_F(ReplicaTest, GreetsWithWhatMustBeShared) {
  follower_.greet(outbox_);
  const auto hellos = all_of<protocol::Hello>(outbox_);
  ASSERT_EQ(hellos.size(), 1u);
  EXPECT_EQ(hellos[0].protocol_version, protocol::kProtocolVersion);
  EXPECT_EQ(hellos[0].solver_version, solver::kSolverVersion);
  EXPECT_EQ(hellos[0].scene_digest, scenes::scene_digest(scene_));
  EXPECT_EQ(hellos[0].mode, protocol::Mode::kLockstep);
}

TEST_F(ReplicaTest, FramesInOrderGiveTheAuthoritysDigestEveryTick) {
  start();
  for (int i = 0; i < 120; ++i) {
    feed(authority_.frame());
    feed(authority_.digest());
    ASSERT_EQ(follower_.simulation().digest(), authority_.simulation().digest());
  }
  EXPECT_EQ(follower_.progress().frames, 120u);
  EXPECT_EQ(follower_.progress().digests_compared, 120u);
  EXPECT_EQ(follower_.progress().mismatches, 0u);
  EXPECT_EQ(follower_.progress().inputs_replaced, 0u);
}

TEST_F(ReplicaTest, JoinsLateByTheSnapshotOfTheWelcomesTick) {
  for (int i = 0; i < 50; ++i) authority_.frame();
  start();
  EXPECT_EQ(follower_.progress().first_tick, 50u);
  feed(authority_.frame());
  EXPECT_EQ(follower_.simulation().digest(), authority_.simulation().digest());
}

TEST_F(ReplicaTest, SendsEachTicksInputOnceWithTheDelayAsLead) {
  start();
  for (int i = 0; i < 5; ++i) feed(authority_.frame());
  const auto inputs = all_of<protocol::Input>(outbox_);
  ASSERT_EQ(inputs.size(), 6u);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    EXPECT_EQ(inputs[i].tick, i + 2);
    EXPECT_EQ(inputs[i].input, scenes::scripted_input(scene_, 0, i + 2));
  }
}

TEST_F(ReplicaTest, SpectatorSendsNoInput) {
  start(protocol::kSpectator);
  for (int i = 0; i < 5; ++i) feed(authority_.frame());
  EXPECT_TRUE(all_of<protocol::Input>(outbox_).empty());
}

TEST_F(ReplicaTest, GapBetweenFramesEndsTheSession) {
  start();
  feed(authority_.frame());
  authority_.frame();
  feed(authority_.frame());
  expect_failed("a gap: the frame of tick 3 instead of 2");
  EXPECT_EQ(follower_.simulation().tick(), 1u);
}

TEST_F(ReplicaTest, RepeatedFrameEndsTheSession) {
  start();
  const protocol::InputFrame frame = authority_.frame();
  feed(frame);
  feed(frame);
  expect_failed("a gap");
}

TEST_F(ReplicaTest, AnswersADigestOnlyOnceItsTickIsMade) {
  start();
  const protocol::InputFrame frame = authority_.frame();
  feed(authority_.digest());
  EXPECT_TRUE(all_of<protocol::Digest>(outbox_).empty());
  feed(frame);
  const auto digests = all_of<protocol::Digest>(outbox_);
  ASSERT_EQ(digests.size(), 1u);
  EXPECT_EQ(digests[0].tick, 1u);
  EXPECT_EQ(digests[0].digest, authority_.simulation().digest());
}

TEST_F(ReplicaTest, NeverComparesATickThatIsGone) {
  start();
  feed(authority_.frame());
  const protocol::Digest late = authority_.digest();
  feed(authority_.frame());
  feed(late);
  EXPECT_EQ(follower_.progress().digests_compared, 0u);
  EXPECT_EQ(follower_.progress().phase, Phase::kRunning);
}

TEST_F(ReplicaTest, MismatchIsReportedAndASnapshotRecovers) {
  start();
  for (int i = 0; i < 10; ++i) feed(authority_.frame());
  disturb(follower_.simulation());
  feed(authority_.frame());
  feed(authority_.digest());
  EXPECT_TRUE(follower_.diverged());
  EXPECT_EQ(follower_.progress().mismatches, 1u);
  const auto digests = all_of<protocol::Digest>(outbox_);
  ASSERT_EQ(digests.size(), 1u);
  EXPECT_NE(digests[0].digest, authority_.simulation().digest());

  feed(authority_.frame());
  feed(authority_.snapshot());
  EXPECT_FALSE(follower_.diverged());
  EXPECT_EQ(follower_.progress().resyncs, 1u);
  for (int i = 0; i < 30; ++i) {
    feed(authority_.frame());
    feed(authority_.digest());
  }
  EXPECT_EQ(follower_.progress().mismatches, 1u);
  EXPECT_EQ(follower_.simulation().digest(), authority_.simulation().digest());
}

TEST_F(ReplicaTest, CountsFramesInWhichMyInputWasReplaced) {
  start();
  feed(authority_.frame());
  for (int i = 0; i < 2; ++i) {
    protocol::InputFrame frame = authority_.frame();
    frame.seats[0].origin = protocol::Origin::kRepeated;
    feed(frame);
  }
  EXPECT_EQ(follower_.progress().inputs_replaced, 2u);
}

TEST_F(ReplicaTest, HostileMessagesEndTheSessionWithAReason) {
  struct Case {
    const char* words;
    protocol::ServerMessage message;
    bool started;
  };
  protocol::Welcome no_such_seat = authority_.welcome(200);
  protocol::Welcome other_seats = authority_.welcome(0);
  other_seats.seats += 1;
  protocol::Welcome long_delay = authority_.welcome(0);
  long_delay.input_delay_ticks = 1u << 30;
  protocol::Snapshot torn = authority_.snapshot();
  torn.state.resize(torn.state.size() / 2);
  protocol::Snapshot lying = authority_.snapshot();
  lying.digest ^= 1;
  protocol::Snapshot empty;
  protocol::InputFrame far;
  far.tick = std::uint64_t(-1);
  far.seats.resize(other_seats.seats - 1);
  const Case cases[] = {
      {"before the welcome", protocol::InputFrame{}, false},
      {"before the welcome", authority_.snapshot(), false},
      {"before the welcome", protocol::Digest{}, false},
      {"gave out seat", no_such_seat, false},
      {"seats, the scene here", other_seats, false},
      {"an input delay", long_delay, false},
      {"not asked for", protocol::Pong{7, 0}, false},
      {"a second welcome", authority_.welcome(0), true},
      {"is corrupt", torn, true},
      {"is corrupt", empty, true},
      {"the digest that it says", lying, true},
      {"instead of", protocol::InputFrame{1, {}, {}, {}}, true},
      {"a gap", far, true},
  };
  for (const Case& wrong : cases) {
    Replica follower(make(), options());
    Outbox out;
    if (wrong.started) {
      follower.receive(authority_.welcome(0), out);
      follower.receive(authority_.snapshot(), out);
    }
    follower.receive(wrong.message, out);
    EXPECT_EQ(follower.progress().phase, Phase::kFailed) << wrong.words;
    EXPECT_NE(follower.progress().reason.find(wrong.words), std::string::npos)
        << follower.progress().reason;
  }
}

TEST_F(ReplicaTest, EventOfAnAbsentSeatEndsTheSession) {
  start();
  protocol::InputFrame frame = authority_.frame();
  frame.events.push_back({protocol::EventKind::kJoin, 255});
  feed(frame);
  expect_failed("an event of seat 255");
}

TEST_F(ReplicaTest, DigestsOfTicksToComeAreBounded) {
  start();
  for (std::uint64_t tick = 1; tick <= Replica::kDigestsWaitingMax; ++tick) {
    feed(protocol::Digest{tick + 1000, 0});
  }
  EXPECT_EQ(follower_.progress().phase, Phase::kRunning);
  feed(protocol::Digest{5000, 0});
  expect_failed("too many digests");
}

TEST_F(ReplicaTest, SnapshotFromBeforeTheFramesThatAreKeptEndsTheSession) {
  const protocol::Snapshot old = authority_.snapshot();
  feed(authority_.welcome(0));
  for (std::uint64_t i = 0; i < 2; ++i) authority_.frame();
  Replica follower(make(), options());
  follower.receive(authority_.welcome(0), outbox_);
  follower.receive(authority_.snapshot(), outbox_);
  follower.receive(old, outbox_);
  EXPECT_EQ(follower.progress().phase, Phase::kFailed);
  EXPECT_NE(follower.progress().reason.find("older than the frames that are kept"),
            std::string::npos);
}

TEST_F(ReplicaTest, IsOverAfterByeAndAfterRefusal) {
  start();
  feed(protocol::Bye{"the end"});
  EXPECT_EQ(follower_.progress().phase, Phase::kEnded);
  feed(authority_.frame());
  EXPECT_EQ(follower_.simulation().tick(), 0u);

  Replica refused(make(), options());
  refused.receive(protocol::Refused{protocol::Refusal::kRoomFull, "full"}, outbox_);
  EXPECT_EQ(refused.progress().phase, Phase::kRefused);
  EXPECT_EQ(refused.progress().refused->code, protocol::Refusal::kRoomFull);
}

TEST_F(ThinTest, HoldsTheLatestStateExactly) {
  start();
  for (int i = 0; i < 10; ++i) {
    for (int tick = 0; tick < 3; ++tick) authority_.frame();
    feed(authority_.snapshot());
    ASSERT_EQ(follower_.simulation().digest(), authority_.simulation().digest());
    ASSERT_EQ(follower_.simulation().poses().size(), authority_.simulation().poses().size());
  }
  EXPECT_EQ(follower_.progress().snapshots, 11u);
  EXPECT_EQ(follower_.progress().last_tick, 30u);
}

TEST_F(ThinTest, SendsAnInputForEveryTickBetweenSnapshots) {
  start();
  for (int i = 0; i < 10; ++i) {
    for (int tick = 0; tick < 3; ++tick) authority_.frame();
    feed(authority_.snapshot());
  }
  const auto inputs = all_of<protocol::Input>(outbox_);
  ASSERT_GT(inputs.size(), 20u);
  for (std::size_t i = 3; i < inputs.size(); ++i) {
    EXPECT_EQ(inputs[i].tick, inputs[i - 1].tick + 1);
  }
}

TEST_F(ThinTest, CorruptSnapshotEndsTheSession) {
  start();
  protocol::Snapshot snapshot = authority_.snapshot();
  snapshot.state[snapshot.state.size() / 2] ^= std::byte{0x10};
  feed(snapshot);
  EXPECT_EQ(follower_.progress().phase, Phase::kFailed);
}

}  // namespace
}  // namespace cycloid::client
