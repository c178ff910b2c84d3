#include <gtest/gtest.h>

#include <functional>

#include "protocol/text.hpp"
#include "solver/version.hpp"
#include "tests/server/room_fixture.hpp"

namespace cycloid::server {
namespace {

using protocol::Refusal;

class RoomRefusals : public RoomTest {
 protected:
  void SetUp() override { open(); }

  /// Refuses a newcomer, then shows that the room is as if it had never come: the next frame and
  /// the digest are those of a room that heard nothing.
  void expect_refused(Refusal code, const std::string& reason,
                      const std::function<void(PeerId)>& talk) {
    const PeerId id = room_->connect();
    talk(id);
    const protocol::Refused refused = refusal(id);
    EXPECT_EQ(refused.code, code) << protocol::refusal_name(refused.code);
    EXPECT_EQ(refused.reason, reason);
    room_->disconnect(id);
    EXPECT_EQ(count(Notice::Kind::kRefusal), 1);
    run(1);
    ASSERT_EQ(log_.ticks.size(), 1u);
    EXPECT_TRUE(log_.ticks[0].frame.events.empty());
    scenes::Simulation untouched = simulation_of(scene_);
    ASSERT_TRUE(untouched.step(std::vector<scenes::SeatInput>(2)).ok());
    EXPECT_EQ(room_->digest(), untouched.digest());
    EXPECT_EQ(room_->statistics().clients, 0u);
  }
};

TEST_F(RoomRefusals, ProtocolVersion) {
  expect_refused(Refusal::kProtocolVersion, "protocol version 9, here 2", [&](PeerId id) {
    protocol::Hello greeting = hello();
    greeting.protocol_version = 9;
    say(id, greeting);
  });
}

TEST_F(RoomRefusals, SolverVersion) {
  const std::string ours = std::to_string(solver::kSolverVersion);
  expect_refused(Refusal::kSolverVersion, "solver version 99, here " + ours, [&](PeerId id) {
    protocol::Hello greeting = hello();
    greeting.solver_version = 99;
    say(id, greeting);
  });
}

TEST_F(RoomRefusals, SceneDigest) {
  char ours[32];
  (void)std::snprintf(ours, sizeof ours, "0x%016llx",
                      static_cast<unsigned long long>(scenes::scene_digest(scene_)));
  expect_refused(Refusal::kSceneDigest,
                 std::string("scene digest 0x00000000000000ff, here ") + ours, [&](PeerId id) {
                   protocol::Hello greeting = hello();
                   greeting.scene_digest = 0xff;
                   say(id, greeting);
                 });
}

TEST_F(RoomRefusals, NoSuchSeat) {
  expect_refused(Refusal::kNoSuchSeat, "seat 2, here are 2 seats from 0",
                 [&](PeerId id) { say(id, hello(2)); });
}

TEST_F(RoomRefusals, TheFirstMessageIsAHello) {
  expect_refused(Refusal::kBadMessage, "the first message is not a hello",
                 [&](PeerId id) { say(id, protocol::Ping{1}); });
}

TEST_F(RoomRefusals, BytesThatAreNoMessage) {
  expect_refused(Refusal::kBadMessage, "not a message: the file identifier is not CYCM",
                 [&](PeerId id) {
                   protocol::Bytes bytes(4 + 20, std::byte{0});
                   bytes[0] = std::byte{20};
                   room_->receive(id, bytes);
                 });
}

TEST_F(RoomRefusals, AnEmptyMessage) {
  expect_refused(Refusal::kBadMessage, "a message of 0 bytes, of 1 to 1024",
                 [&](PeerId id) { room_->receive(id, protocol::Bytes(4, std::byte{0})); });
}

TEST_F(RoomRefusals, AHelloThatIsTooLargeBeforeItCame) {
  expect_refused(Refusal::kTooLarge, "a message of 1025 bytes, of 1 to 1024", [&](PeerId id) {
    room_->receive(id, protocol::Bytes{std::byte{1}, std::byte{4}, std::byte{0}, std::byte{0}});
  });
}

TEST_F(RoomRefusals, NothingIsHeardAfterARefusal) {
  expect_refused(Refusal::kBadMessage, "the first message is not a hello", [&](PeerId id) {
    say(id, protocol::Ping{1});
    say(id, hello(0));
  });
}

TEST_F(RoomRefusals, ASeatThatIsTaken) {
  const PeerId holder = join(1);
  const PeerId other = join(1);
  const protocol::Refused refused = refusal(other);
  EXPECT_EQ(refused.code, Refusal::kSeatTaken);
  EXPECT_EQ(refused.reason, "seat 1 is held by client " + std::to_string(holder));
  EXPECT_FALSE(room_->wants_close(holder));
}

TEST_F(RoomRefusals, AnySeatOfAFullRoom) {
  (void)join();
  (void)join();
  const protocol::Refused refused = refusal(join());
  EXPECT_EQ(refused.code, Refusal::kRoomFull);
  EXPECT_EQ(refused.reason, "2 seats taken, of 2");
  EXPECT_FALSE(room_->wants_close(join(protocol::kSpectator)));
}

TEST_F(RoomRefusals, ConnectionsOverTheLimit) {
  Limits limits;
  limits.connections_max = 2;
  open(limits);
  (void)join();
  const PeerId silent = room_->connect();
  const protocol::Refused refused = refusal(room_->connect());
  EXPECT_EQ(refused.code, Refusal::kRoomFull);
  EXPECT_EQ(refused.reason, "2 connections, of at most 2");
  room_->disconnect(silent);
  EXPECT_FALSE(room_->wants_close(room_->connect()));
}

TEST_F(RoomRefusals, ASecondHello) {
  const PeerId id = join(0);
  say(id, hello(1));
  EXPECT_EQ(refusal(id).reason, "a second hello");
}

TEST_F(RoomRefusals, AnInputOfASpectator) {
  const PeerId id = join(protocol::kSpectator);
  say(id, protocol::Input{1, push(1)});
  const protocol::Refused refused = refusal(id);
  EXPECT_EQ(refused.code, Refusal::kBadMessage);
  EXPECT_EQ(refused.reason, "an input of a spectator");
}

TEST_F(RoomRefusals, ADigestOfTheFuture) {
  const PeerId id = join(0);
  run(3);
  say(id, protocol::Digest{4, 0});
  EXPECT_EQ(refusal(id).reason, "a digest of tick 4, the last made is 3");
}

TEST_F(RoomRefusals, TheHandshakeDeadlineIsNotExtendedByBytes) {
  const PeerId id = room_->connect();
  const protocol::Bytes greeting = protocol::encode(protocol::ClientMessage(hello()));
  const std::int64_t begin = now_;
  for (std::size_t i = 0; i + 1 < greeting.size() && !room_->wants_close(id); ++i) {
    room_->receive(id, std::span<const std::byte>(greeting).subspan(i, 1));
    run(6);  // A byte every 100 ms.
  }
  const protocol::Refused refused = refusal(id);
  EXPECT_EQ(refused.code, Refusal::kTooSlow);
  EXPECT_NEAR(static_cast<double>(now_ - begin), 5e9, 0.2e9);
  EXPECT_NE(refused.reason.find("of at most 5000 ms"), std::string::npos) << refused.reason;
}

TEST_F(RoomRefusals, WhoIsSilentIsSentAwayAndWhoPingsIsNot) {
  const PeerId silent = join(0);
  const PeerId lively = join(1);
  for (int second = 0; second < 31; ++second) {
    say(lively, protocol::Ping{1});
    run(60);
    (void)hear(lively);
    if (second < 29) (void)hear(silent);
  }
  const protocol::Refused refused = refusal(silent);
  EXPECT_EQ(refused.code, Refusal::kTooSlow);
  EXPECT_EQ(refused.reason.substr(0, 15), "no message for ");
  EXPECT_FALSE(room_->wants_close(lively));
}

TEST_F(RoomRefusals, NamesCannotForgeLinesOfTheLog) {
  const PeerId id = room_->connect();
  protocol::Hello greeting = hello();
  greeting.name = "x\n[error] all is lost";
  greeting.protocol_version = 9;
  say(id, greeting);
  ASSERT_EQ(notices_.size(), 1u);
  EXPECT_EQ(notices_[0].text.find('\n'), std::string::npos);
  EXPECT_NE(notices_[0].text.find("x?[error]"), std::string::npos);
}

}  // namespace
}  // namespace cycloid::server
