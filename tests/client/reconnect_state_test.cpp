#include <algorithm>

#include "tests/client/reconnect_fixture.hpp"

namespace cycloid::client {
namespace {

using ReconnectState = Reconnect;

TEST_F(ReconnectState, GoesOnFromTheStateThatItStillHolds) {
  std::optional<protocol::Ack> ack;
  std::vector<protocol::ClientMessage> said_before_pong;
  std::optional<protocol::Input> first_input;
  const JoinReport report = play({
      hang_up_after(10),
      [&](Peer& peer, const auto&) {
        std::vector<protocol::ClientMessage> none;
        ack = peer.hear_until<protocol::Ack>(none);
        protocol::Welcome welcome = authority_.welcome(1);
        welcome.resume = resume_token(2);
        peer.tell(welcome);
        for (int i = 0; i < 30; ++i) peer.tell(authority_.frame());
        const auto ping = peer.hear_until<protocol::Ping>(said_before_pong);
        peer.tell(protocol::Pong{ping->token, 40});
        for (int i = 0; i < 5; ++i) peer.tell(authority_.frame());
        peer.tell(authority_.digest());
        std::vector<protocol::ClientMessage> others;
        first_input = peer.hear_until<protocol::Input>(others);
        peer.tell(protocol::Bye{"over"});
        peer.drain();
      },
  });
  EXPECT_EQ(report.end, End::kBye) << report.reason;
  ASSERT_TRUE(ack);
  EXPECT_EQ(ack->tick, 10u);
  EXPECT_EQ(report.reconnects, 1u);
  EXPECT_EQ(report.progress.states_kept, 1u);
  EXPECT_EQ(report.progress.snapshots, 1u) << "of the first connection";
  EXPECT_EQ(report.progress.first_tick, 0u);
  EXPECT_EQ(report.progress.last_tick, 45u);
  EXPECT_EQ(report.progress.frames, 45u);
  EXPECT_EQ(report.progress.mismatches, 0u);
  EXPECT_EQ(report.progress.digests_compared, 1u);
  EXPECT_EQ(report.final_digest, authority_.simulation().digest());
  EXPECT_TRUE(std::ranges::none_of(said_before_pong, [](const auto& message) {
    return std::holds_alternative<protocol::Input>(message);
  })) << "for ticks that were made long ago";
  ASSERT_TRUE(first_input);
  EXPECT_GT(first_input->tick, 40u);
}

TEST_F(ReconnectState, TakesAStateWhereTheServerDoesNotGoOnFromItsOwn) {
  for (const bool same_tick : {true, false}) {
    acceptor_ = tcp::acceptor(io_, {asio::ip::address_v4::loopback(), 0});
    options_.port = acceptor_.local_endpoint().port();
    const JoinReport report = play({
        hang_up_after(10),
        [&](Peer& peer, const auto&) {
          if (!same_tick) authority_.frame();
          welcome(peer, 2, 5);
          peer.tell(authority_.digest());
          peer.tell(protocol::Bye{"over"});
          peer.drain();
        },
    });
    EXPECT_EQ(report.end, End::kBye) << report.reason;
    EXPECT_EQ(report.progress.snapshots, 2u);
    EXPECT_EQ(report.progress.states_kept, same_tick ? 1u : 0u);
    EXPECT_EQ(report.progress.mismatches, 0u);
    EXPECT_EQ(report.final_digest, authority_.simulation().digest());
  }
}

/// On the first connection, on one that is refused, and on one whose state is not the one kept.
TEST_F(ReconnectState, ShowsAStateOnlyOnceThereIsOne) {
  std::uint64_t newest = 0;
  options_.on_progress = [&](Follower& follower) {
    EXPECT_TRUE(follower.progress().begun());
    EXPECT_GE(follower.simulation().tick(), newest);
    newest = follower.simulation().tick();
  };
  const auto load = [this](Peer& peer) {
    for (int i = 0; i < 40; ++i) authority_.frame();
    welcome_in_parts(peer, [&peer] {  // An answered welcome was taken in, and a ping follows it.
      std::vector<protocol::ClientMessage> before;
      ASSERT_TRUE(peer.hear_until<protocol::Ping>(before));
    });
  };
  const JoinReport report = play({
      [&](Peer& peer, const auto&) {
        load(peer);
        peer.hang_up();
      },
      refuse(protocol::Refusal::kSeatTaken),
      [&](Peer& peer, const auto&) {
        load(peer);
        peer.tell(protocol::Bye{"over"});
        peer.drain();
      },
  });
  EXPECT_EQ(report.end, End::kBye) << report.reason;
  EXPECT_EQ(report.progress.snapshots, 2u);
  EXPECT_EQ(newest, 80u);
}

TEST_F(ReconnectState, KeepsNoStateThatTheServerHasContradicted) {
  const JoinReport report = play({
      [this](Peer& peer, const auto&) {
        welcome(peer, 1, 10);
        peer.tell(protocol::Digest{10, authority_.digest().digest + 1});
        peer.hang_up();
      },
      [&](Peer& peer, const auto&) {
        welcome(peer, 2, 5);
        peer.tell(protocol::Bye{"over"});
        peer.drain();
      },
  });
  EXPECT_EQ(report.end, End::kBye) << report.reason;
  EXPECT_EQ(report.progress.states_kept, 0u);
  EXPECT_EQ(report.final_digest, authority_.simulation().digest());
}

}  // namespace
}  // namespace cycloid::client
