#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>

#include "tests/server/host_fixture.hpp"

namespace cycloid::server {
namespace {

using namespace std::chrono_literals;

constexpr std::uint64_t kHourMs = 3'600'000;

/// A host with a room and somebody in it.
class HostDrain : public testing::Test {
 protected:
  /// @param rate_millihertz  Of its ticks; 0: the scene's.
  void open(std::uint32_t rate_millihertz = 0) {
    options_.rooms.push_back({"arena", two_seat_settings()});
    options_.rooms[0].settings.tick_rate_millihertz = rate_millihertz;
    server_.emplace(std::move(options_));
    peer_.emplace(server_->port());
    peer_->greet("arena");
    ASSERT_TRUE(peer_->wait_for<protocol::Welcome>());
  }
  Host& host() { return server_->host(); }
  /// How long the match still lasts, as its client is told next; 0: it is not told. Other notices,
  /// such as that a busy machine slows the match, are passed over.
  std::uint64_t told_ms() {
    while (const auto notice = peer_->wait_for<protocol::RoomNotice>())
      if (notice->kind == protocol::NoticeKind::kDraining) return notice->value;
    return 0;
  }
  std::string farewell() {
    const auto bye = peer_->wait_for<protocol::Bye>();
    peer_->hang_up();
    return bye ? bye->reason : "none";
  }

  HostLines lines_;
  HostOptions options_ = quiet_host(lines_);
  std::optional<RunningHost> server_;
  std::optional<HostPeer> peer_;
};

TEST_F(HostDrain, OfTheProcessEndsARoomSoonerThatDrainsAlready) {
  open();
  ASSERT_TRUE(server_->act("arena", LifeAct::kDrain, 1h).ok());
  EXPECT_EQ(told_ms(), kHourMs);
  host().drain("maintenance", 200ms);
  EXPECT_EQ(told_ms(), 200u);
  EXPECT_EQ(farewell(), "maintenance");
  EXPECT_TRUE(server_->report().good);
}

TEST_F(HostDrain, OfTheProcessLeavesARoomThatEndsSoonerAsItIs) {
  open();
  ASSERT_TRUE(server_->act("arena", LifeAct::kDrain, 200ms).ok());
  EXPECT_EQ(told_ms(), 200u);
  host().drain("maintenance", 1h);
  EXPECT_EQ(farewell(), "by the test");
  EXPECT_TRUE(server_->report().good);
}

TEST_F(HostDrain, KeepsItsDeadlineWhereTicksAreRare) {
  open(50);  // One in 20 s.
  const auto begin = std::chrono::steady_clock::now();
  host().drain("maintenance", 200ms);
  EXPECT_EQ(farewell(), "maintenance");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 10s);
  EXPECT_TRUE(server_->report().good);
}

TEST_F(HostDrain, AskedForAgainEndsAtTheNearestDeadline) {
  open();
  host().drain("first", 1h);
  EXPECT_EQ(told_ms(), kHourMs);
  host().drain("second", 200ms);
  EXPECT_EQ(told_ms(), 200u);
  host().drain("third", 1h);
  EXPECT_EQ(farewell(), "second");
  EXPECT_TRUE(server_->report().good);
}

TEST_F(HostDrain, OfAnAdminIsOnlyHastenedByTheFirstSignal) {
  options_.catch_signals = true;
  options_.drain = 1h;
  open();
  host().drain("an admin", 2h);
  EXPECT_EQ(told_ms(), 2 * kHourMs);
  ASSERT_EQ(::kill(::getpid(), SIGTERM), 0);
  EXPECT_EQ(told_ms(), kHourMs);
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(peer_->wait_for<protocol::InputFrame>());
  ASSERT_EQ(::kill(::getpid(), SIGTERM), 0);
  EXPECT_TRUE(server_->report().good);  // Though the peer has not hung up.
}

}  // namespace
}  // namespace cycloid::server
