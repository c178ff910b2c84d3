#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <span>

#include "client/join.hpp"
#include "protocol/log_format.hpp"
#include "tests/client/served.hpp"
#include "tests/determinism/rollback.hpp"

namespace cycloid::client {
namespace {

/// One match three ways: through a server with clients over loopback, headless by its log, and by a
/// client in rollback.
class SameMatch : public history::SceneTest {};

/// Something else every few ticks, the same for everybody who asks.
scenes::SeatInput wild_input(int seat, std::uint64_t tick) {
  std::mt19937 random(
      static_cast<std::uint32_t>(tick / 16 * 16 + static_cast<std::uint64_t>(seat)));
  scenes::SeatInput input;
  for (std::int16_t& axis : input.axes) axis = static_cast<std::int16_t>(random());
  input.buttons = static_cast<std::uint16_t>(random());
  return input;
}

protocol::Log read_back(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string text((std::istreambuf_iterator<char>(stream)),
                         std::istreambuf_iterator<char>());
  return protocol::read_log(std::as_bytes(std::span<const char>(text.data(), text.size())));
}

TEST_P(SameMatch, ServerClientsHeadlessReplayAndRollbackAgreeTickForTick) {
  constexpr std::uint64_t kTicks = 100;
  const scenes::Scene scene = this->scene();
  const std::string log = (std::filesystem::temp_directory_path() /
                           ("match-" + GetParam() + "-" + std::to_string(getpid()) + ".cylog"))
                              .string();
  server::ServeOptions serving;
  serving.scene = scene;
  serving.ticks = kTicks;
  serving.tick_rate_millihertz = 500000;
  serving.log = log;
  serving.limits.digest_ticks = 1;
  Served served(std::move(serving));
  JoinOptions options;
  options.port = served.port();
  options.scene = scene;
  options.input = wild_input;
  options.ticks = ~std::uint64_t{0};  // Never so many, however they are counted.
  std::vector<std::future<JoinReport>> clients;
  for (std::size_t i = 0; i < std::min<std::size_t>(2, scene.seats.size()); ++i)
    clients.push_back(std::async(std::launch::async, [options] { return join(options); }));
  const server::ServeReport report = served.report();
  EXPECT_EQ(report.end, server::End::kTicks) << report.reason;
  EXPECT_EQ(report.desyncs, 0u);
  for (auto& client : clients) {
    const JoinReport mine = client.get();
    EXPECT_EQ(mine.end, End::kBye) << mine.reason;
    EXPECT_EQ(mine.final_digest, report.final_digest);
    EXPECT_EQ(mine.progress.mismatches, 0u);
    EXPECT_GT(mine.progress.digests_compared, 0u);
  }

  const protocol::Log read = read_back(log);
  std::filesystem::remove(log);
  ASSERT_EQ(read.state, protocol::LogState::kComplete) << read.reason;
  ASSERT_EQ(read.ticks.size(), kTicks);
  history::Match match;
  std::vector<std::uint64_t> digests = {history::begin(scene).digest()};
  for (const protocol::LogTick& tick : read.ticks) {
    std::vector<scenes::SeatInput>& inputs = match.emplace_back();
    for (const protocol::SeatFrame& seat : tick.frame.seats) inputs.push_back(seat.input);
    digests.push_back(tick.digest);
  }
  EXPECT_EQ(digests.back(), report.final_digest);
  EXPECT_EQ(history::digests_of(scene, match), digests) << "headless";
  history::RollbackClient rollback(scene);
  history::expect_equal_in_rollback(match, digests, 8, rollback);
}

INSTANTIATE_TEST_SUITE_P(Scenes, SameMatch, testing::ValuesIn(history::scene_names()),
                         history::scene_test_name);

}  // namespace
}  // namespace cycloid::client
