#include <gtest/gtest.h>

#include <asio.hpp>
#include <functional>
#include <future>
#include <set>
#include <thread>

#include "client/join.hpp"
#include "protocol/codec.hpp"
#include "tests/client/authority.hpp"

namespace cycloid::client {
namespace {

using asio::ip::tcp;
using std::chrono::milliseconds;

/// A connection as a server sees it, blocking.
class Peer {
 public:
  explicit Peer(tcp::socket socket) : socket_(std::move(socket)) {}

  void tell(const protocol::ServerMessage& message) {
    asio::error_code ignored;
    asio::write(socket_, asio::buffer(protocol::encode(message)), ignored);
  }
  protocol::Hello hear_hello() {
    for (;;) {
      if (const auto payload = framer_.next()) {
        const auto decoded = protocol::decode_client(*payload);
        return std::get<protocol::Hello>(*decoded.message);
      }
      std::array<std::byte, 4096> bytes{};
      asio::error_code error;
      const std::size_t size = socket_.read_some(asio::buffer(bytes), error);
      if (error) return {};
      (void)framer_.feed(std::span<const std::byte>(bytes).first(size));
    }
  }
  /// Until the client has closed its side, so that nothing it was told is lost in a reset.
  void drain() {
    asio::error_code error;
    std::array<std::byte, 4096> bytes{};
    while (!error) (void)socket_.read_some(asio::buffer(bytes), error);
  }
  /// Nothing more will be said; what was said is heard.
  void hang_up() {
    asio::error_code ignored;
    socket_.shutdown(tcp::socket::shutdown_send, ignored);
    drain();
  }
  void reset() {
    asio::error_code ignored;
    socket_.set_option(tcp::socket::linger(true, 0), ignored);
    socket_.close(ignored);
  }

 private:
  tcp::socket socket_;
  protocol::Framer framer_{4096};
};

std::vector<std::byte> resume_token(int number) {
  return std::vector<std::byte>(protocol::kResumeBytes, std::byte(number));
}

/// A server that does something else with every connection, as a test says.
class Reconnect : public testing::Test {
 protected:
  using Script = std::function<void(Peer&, const protocol::Hello&)>;

  Reconnect() : scene_(Authority::scene()), authority_(scene_) {
    options_.port = acceptor_.local_endpoint().port();
    options_.scene = scene_;
    options_.room = "hall";
    options_.token = {std::byte{7}};
    options_.reconnect.on = true;
    options_.reconnect.first = milliseconds(10);
    options_.reconnect.longest = milliseconds(40);
    options_.reconnect.deadline = milliseconds(10000);
    options_.on_welcome = [this](const protocol::Welcome&) { ++welcomes_; };
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(30);
    options_.should_stop = [deadline] { return std::chrono::steady_clock::now() > deadline; };
  }

  JoinReport play(const std::vector<Script>& scripts) {
    auto server = std::async(std::launch::async, [&] {
      for (const Script& script : scripts) {
        Peer peer(acceptor_.accept());
        const protocol::Hello hello = peer.hear_hello();
        hellos_.push_back(hello);
        script(peer, hello);
      }
      acceptor_.close();
    });
    const JoinReport report = join(options_);
    server.wait();
    return report;
  }

  /// Lets the client in, and shows it some ticks.
  void welcome(Peer& peer, int token, int ticks) {
    protocol::Welcome welcome = authority_.welcome(1);
    welcome.resume = resume_token(token);
    welcome.room = "hall";
    peer.tell(welcome);
    peer.tell(authority_.snapshot());
    for (int i = 0; i < ticks; ++i) peer.tell(authority_.frame());
  }
  static Script refuse(protocol::Refusal code) {
    return [code](Peer& peer, const protocol::Hello&) {
      peer.tell(protocol::Refused{code, "no"});
      peer.drain();
    };
  }

  scenes::Scene scene_;
  Authority authority_;
  asio::io_context io_;
  tcp::acceptor acceptor_{io_, {asio::ip::address_v4::loopback(), 0}};
  JoinOptions options_;
  std::vector<protocol::Hello> hellos_;
  int welcomes_ = 0;
};

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
