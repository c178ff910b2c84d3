#include <set>

#include "tests/client/reconnect_fixture.hpp"

namespace cycloid::client {
namespace {

TEST_F(Reconnect, ComesBackToItsSeatWithTheTokenOfTheLastWelcome) {
  const JoinReport report = play({
      [this](Peer& peer, const auto&) {
        welcome(peer, 1, 10);
        std::this_thread::sleep_for(milliseconds(100));
        peer.reset();
      },
      [this](Peer& peer, const auto&) { welcome(peer, 2, 5); },  // And hangs up.
      [this](Peer& peer, const auto&) {
        for (int i = 0; i < 20; ++i) authority_.frame();  // Meanwhile the match went on.
        welcome(peer, 3, 5);
        peer.tell(protocol::Bye{"over"});
        peer.drain();
      },
  });
  EXPECT_EQ(report.end, End::kBye) << report.reason;
  EXPECT_EQ(report.reconnects, 2u);
  EXPECT_EQ(report.tries, 2u);
  EXPECT_EQ(report.fresh_joins, 0u);
  EXPECT_EQ(report.progress.seat, 1);
  EXPECT_EQ(report.progress.first_tick, 0u);
  EXPECT_EQ(report.progress.last_tick, 40u);
  EXPECT_EQ(report.progress.snapshots, 3u);
  EXPECT_EQ(report.final_digest, authority_.simulation().digest());
  EXPECT_EQ(welcomes_, 3);
  ASSERT_EQ(hellos_.size(), 3u);
  EXPECT_TRUE(hellos_[0].resume.empty());
  EXPECT_EQ(hellos_[0].token.size(), 1u);
  EXPECT_EQ(hellos_[1].resume, resume_token(1));
  EXPECT_TRUE(hellos_[1].token.empty()) << "it is good once";
  EXPECT_EQ(hellos_[1].room, "hall");
  EXPECT_EQ(hellos_[2].resume, resume_token(2));
}

TEST_F(Reconnect, TokenThatTheServerHasForgottenIsAFreshJoinOnlyWhereAllowed) {
  const std::vector<Script> scripts = {
      [this](Peer& peer, const auto&) { welcome(peer, 1, 3); },
      refuse(protocol::Refusal::kResumeUnknown),
  };
  std::vector<Script> with_third = scripts;
  with_third.push_back([this](Peer& peer, const auto&) {
    welcome(peer, 9, 3);
    peer.tell(protocol::Bye{"over"});
    peer.drain();
  });
  const JoinReport report = play(with_third);
  EXPECT_EQ(report.end, End::kBye) << report.reason;
  EXPECT_EQ(report.fresh_joins, 1u);
  ASSERT_EQ(hellos_.size(), 3u);
  EXPECT_EQ(hellos_[1].resume, resume_token(1));
  EXPECT_TRUE(hellos_[2].resume.empty());
  EXPECT_EQ(hellos_[2].token.size(), 1u);
}

TEST_F(Reconnect, WithoutFreshJoinAForgottenTokenIsTheEnd) {
  options_.reconnect.fresh_join = false;
  const JoinReport report = play({
      [this](Peer& peer, const auto&) { welcome(peer, 1, 3); },
      refuse(protocol::Refusal::kResumeUnknown),
  });
  EXPECT_EQ(report.end, End::kRefused);
  EXPECT_EQ(report.refused()->code, protocol::Refusal::kResumeUnknown);
}

TEST_F(Reconnect, WhoWasReplacedOrKickedStaysAway) {
  for (const auto code : {protocol::Refusal::kReplaced, protocol::Refusal::kKicked}) {
    acceptor_ = tcp::acceptor(io_, {asio::ip::address_v4::loopback(), 0});
    options_.port = acceptor_.local_endpoint().port();
    const JoinReport report = play({[this, code](Peer& peer, const auto&) {
      welcome(peer, 1, 3);
      peer.tell(protocol::Refused{code, "gone"});
      peer.drain();
    }});
    EXPECT_EQ(report.end, End::kRefused) << report.reason;
    EXPECT_EQ(report.refused()->code, code);
    EXPECT_EQ(report.tries, 0u);
  }
}

TEST_F(Reconnect, ASeatThatItsDeadConnectionStillHoldsIsAskedForAgain) {
  const JoinReport report = play({
      [this](Peer& peer, const auto&) { welcome(peer, 1, 3); },
      refuse(protocol::Refusal::kSeatTaken),
      refuse(protocol::Refusal::kTooSlow),
      [this](Peer& peer, const auto&) {
        welcome(peer, 2, 3);
        peer.tell(protocol::Bye{"over"});
        peer.drain();
      },
  });
  EXPECT_EQ(report.end, End::kBye) << report.reason;
  EXPECT_EQ(report.tries, 3u);
  EXPECT_EQ(report.reconnects, 1u);
  ASSERT_EQ(hellos_.size(), 4u);
  EXPECT_EQ(hellos_[3].resume, resume_token(1));
}

TEST_F(Reconnect, GivesUpByItsDeadline) {
  options_.reconnect.deadline = milliseconds(2000);
  const auto begin = std::chrono::steady_clock::now();
  const JoinReport report = play({[this](Peer& peer, const auto&) {
    welcome(peer, 1, 3);
    peer.hang_up();
  }});
  EXPECT_EQ(report.end, End::kDisconnected);
  EXPECT_GE(report.tries, 3u);
  EXPECT_EQ(report.progress.last_tick, 3u);
  EXPECT_EQ(report.final_digest, authority_.simulation().digest());
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(10));
}

TEST_F(Reconnect, WaitsGrowWhereEachConnectionBreaksAfterItsFirstState) {
  using Clock = std::chrono::steady_clock;
  options_.reconnect.first = milliseconds(20);
  options_.reconnect.longest = milliseconds(5000);
  std::vector<Clock::time_point> begins;
  std::vector<Clock::time_point> ends;
  const Script break_down = [&](Peer& peer, const auto&) {
    begins.push_back(Clock::now());
    welcome(peer, 1, 0);
    ends.push_back(Clock::now());
  };
  std::vector<Script> scripts(6, break_down);
  scripts.push_back([&](Peer& peer, const auto&) {
    begins.push_back(Clock::now());
    welcome(peer, 1, 0);
    peer.tell(protocol::Bye{"over"});
    peer.drain();
  });
  const JoinReport report = play(scripts);
  EXPECT_EQ(report.end, End::kBye) << report.reason;
  ASSERT_EQ(begins.size(), 7u);
  milliseconds least(10);  // Half of the first wait.
  for (std::size_t i = 0; i < ends.size(); ++i, least *= 2)
    EXPECT_GE(begins[i + 1] - ends[i], least) << "before connection " << i + 2;
}

TEST_F(Reconnect, WhereTheServerGivesNoResumeTokensNoneWasForgotten) {
  const auto let_in = [this](Peer& peer) {
    peer.tell(authority_.welcome(1));
    peer.tell(authority_.snapshot());
  };
  const JoinReport report = play({
      [&](Peer& peer, const auto&) { let_in(peer); },
      [&](Peer& peer, const auto&) {
        let_in(peer);
        peer.tell(protocol::Bye{"over"});
        peer.drain();
      },
  });
  EXPECT_EQ(report.end, End::kBye) << report.reason;
  EXPECT_EQ(report.reconnects, 1u);
  EXPECT_EQ(report.fresh_joins, 0u);
}

TEST_F(Reconnect, OnlyWhoWasLetInOnceComesBack) {
  EXPECT_EQ(play({refuse(protocol::Refusal::kRoomFull)}).end, End::kRefused);
  EXPECT_EQ(hellos_.size(), 1u);
}

TEST(BackoffWaits, DoubleUpToTheLongestAndAreCutByUpToAHalf) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Backoff backoff(milliseconds(100), milliseconds(5000), seed);
    std::int64_t whole = 100;
    for (int i = 0; i < 20; ++i) {
      const std::int64_t wait = backoff.next().count();
      EXPECT_LE(wait, whole);
      EXPECT_GE(wait, whole / 2);
      whole = std::min<std::int64_t>(2 * whole, 5000);
    }
    backoff.reset();
    EXPECT_LE(backoff.next().count(), 100);
  }
}

TEST(BackoffWaits, DifferBySeedAndRepeatByIt) {
  std::set<std::int64_t> first;
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    Backoff backoff(milliseconds(1000), milliseconds(5000), seed);
    Backoff again(milliseconds(1000), milliseconds(5000), seed);
    const std::int64_t wait = backoff.next().count();
    EXPECT_EQ(again.next().count(), wait);
    first.insert(wait);
  }
  EXPECT_GT(first.size(), 60u) << "they would come at once";
}

}  // namespace
}  // namespace cycloid::client
