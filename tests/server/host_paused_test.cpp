#include "tests/server/host_fixture.hpp"

namespace cycloid::server {
namespace {

/// So many balls that a state travels in more parts than one tick has.
RoomSettings crowded_settings() {
  RoomSettings settings = two_seat_settings();
  for (int i = 0; i < 3000; ++i) {
    scenes::SceneBody ball = settings.scene.bodies.back();
    ball.name = "ball-" + std::to_string(i);
    ball.position = {5.0f + 2.0f * static_cast<float>(i), 0.6f, 0.0f};
    settings.scene.bodies.push_back(ball);
  }
  settings.scene.name = settings.scene_name = "crowd";
  return settings;
}

/// A host with a room "arena" of that scene, which is paused.
class PausedHost : public testing::Test {
 protected:
  void SetUp() override {
    HostOptions options = quiet_host(lines_);
    const RoomSettings settings = crowded_settings();
    scene_digest_ = scenes::scene_digest(settings.scene);
    options.templates["crowd"] = {settings, false};
    running_.emplace(std::move(options));
    ASSERT_TRUE(running_->make("arena", "crowd").ok());
    ASSERT_TRUE(running_->act("arena", LifeAct::kPause).ok());
  }
  protocol::Hello hello() const {
    protocol::Hello hello;
    hello.scene_digest = scene_digest_;
    hello.room = "arena";
    return hello;
  }

  HostLines lines_;
  std::uint64_t scene_digest_ = 0;
  std::optional<RunningHost> running_;
};

TEST_F(PausedHost, GivesALargeStateToWhoComesIn) {
  HostPeer peer(running_->port());
  peer.send(hello());
  ASSERT_TRUE(peer.wait_for<protocol::Welcome>());
  std::size_t bytes = 0;
  std::size_t total = 1;
  while (bytes < total) {
    const auto part = peer.wait_for<protocol::SnapshotPart>();
    ASSERT_TRUE(part) << bytes << " bytes came, of " << total;
    ASSERT_EQ(part->offset, bytes);
    bytes += part->bytes.size();
    total = part->total_bytes;
  }
  EXPECT_GT(total, 16 * Limits().state_parts_per_tick_max * 1024) << "or it proves nothing";
}

TEST_F(PausedHost, HearsManyMessagesAndAHangUp) {
  HostPeer peer(running_->port());
  peer.send(hello());
  ASSERT_TRUE(peer.wait_for<protocol::Welcome>());
  constexpr std::uint64_t kPings = 200;
  for (std::uint64_t i = 0; i < kPings; ++i) peer.send(protocol::Ping{i});
  for (std::uint64_t i = 0; i < kPings; ++i) {
    const auto pong = peer.wait_for<protocol::Pong>();
    ASSERT_TRUE(pong) << "after " << i;
    ASSERT_EQ(pong->token, i);
  }
  const auto room = running_->host().find("arena");
  EXPECT_TRUE(eventually([&] { return room->meters().clients.get() == 1; }));
  peer.hang_up();
  EXPECT_TRUE(eventually([&] { return room->meters().clients.get() == 0; }));
  EXPECT_EQ(room->stage(), LifeStage::kPaused);
}

TEST(PausedRoom, GoesOnWhereItStood) {
  HostLines lines;
  RunningHost running(quiet_host(lines));
  ASSERT_TRUE(running.make("arena", "hall").ok());
  const auto room = running.host().find("arena");
  ASSERT_TRUE(eventually([&] { return room->meters().tick.get() > 0; })) << "its clock has begun";
  ASSERT_TRUE(running.act("arena", LifeAct::kPause).ok());
  const std::uint64_t tick = room->meters().tick.get();
  const std::uint64_t slowed_ns = room->meters().slowed_ns.get();
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(room->meters().tick.get(), tick);
  ASSERT_TRUE(running.act("arena", LifeAct::kResume).ok());
  EXPECT_TRUE(eventually([&] { return room->meters().tick.get() >= tick + 3; }));
  // Ticks made up for would be missing here: 8 of them are 133 ms.
  EXPECT_GE(room->meters().slowed_ns.get() - slowed_ns, 300'000'000u)
      << "what it stood still for is told, and is not caught up";
}

}  // namespace
}  // namespace cycloid::server
