#include "server/host/room_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>

#include "tests/server/host_fixture.hpp"

namespace cycloid::server {
namespace {

using testing::MatchesRegex;

class RoomLogTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = testing::TempDir() + "cycloid-" + std::to_string(::getpid()) + test->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directory(folder_);
    place_.room = "arena:7";
    place_.disk = system_disk();
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static void write_ticks(RoomLog& log, std::uint64_t first, std::uint64_t last) {
    for (std::uint64_t tick = first; tick <= last; ++tick) {
      log.tick(numbered_tick(tick));
      if (log.wants_keyframe(tick))
        log.keyframe(tick, numbered_tick(tick).digest, numbered_state(tick));
    }
  }
  static void rewind(RoomLog& log, std::uint64_t tick) {
    log.branch(numbered_tick(tick), numbered_state(tick));
  }
  static void close(RoomLog& log, std::uint64_t tick) {
    log.close({tick, numbered_tick(tick).digest, {}});
    EXPECT_TRUE(eventually([&] { return log.settled(); }));
    EXPECT_TRUE(log.durable()) << log.error();
  }

  /// All files of the folder by their names.
  std::map<std::string, protocol::Log> logs() const {
    std::map<std::string, protocol::Log> logs;
    for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
      std::ifstream stream(entry.path(), std::ios::binary);
      const std::vector<char> text{std::istreambuf_iterator<char>(stream), {}};
      logs[entry.path().filename().string()] = protocol::read_log(std::as_bytes(std::span(text)));
    }
    return logs;
  }
  /// That goes on from after this tick.
  static const protocol::Log& from(const std::map<std::string, protocol::Log>& logs,
                                   std::uint64_t tick) {
    for (const auto& [name, log] : logs)
      if (log.header.branch_tick == tick) return log;
    ADD_FAILURE() << "no log goes on from tick " << tick;
    return logs.begin()->second;
  }

  std::string folder_;
  RoomLogPlace place_;
  asio::thread_pool slow_{1};
};

TEST_F(RoomLogTest, RewindsWithoutATickBetweenLeaveWholeLogs) {
  place_.path = folder_ + "/match.cylog";
  RoomLog log(place_, {}, slow_);
  write_ticks(log, 1, 20);
  rewind(log, 10);
  rewind(log, 5);
  write_ticks(log, 6, 8);
  close(log, 8);
  const auto files = logs();
  ASSERT_EQ(files.size(), 3u);
  for (const auto& [name, file] : files) {
    EXPECT_EQ(file.state, protocol::LogState::kComplete) << name << ": " << file.reason;
    EXPECT_EQ(wrong_in(file), "") << name;
  }
  EXPECT_EQ(from(files, 0).last_tick, 20u);
  EXPECT_EQ(from(files, 10).last_tick, 10u);
  EXPECT_EQ(from(files, 5).last_tick, 8u);
  EXPECT_EQ(from(files, 10).header.parent_log_id, from(files, 0).header.log_id);
  EXPECT_EQ(from(files, 5).header.parent_log_id, from(files, 10).header.log_id);
}

TEST_F(RoomLogTest, ARewindBehindARotationNamesTheRotatedLog) {
  place_.directory = folder_;
  RoomLog log(place_, {}, slow_);
  write_ticks(log, 1, 5);
  EXPECT_TRUE(log.rotate().ok());
  write_ticks(log, 6, 12);
  rewind(log, 3);
  close(log, 3);
  const auto files = logs();
  ASSERT_EQ(files.size(), 3u);
  EXPECT_EQ(from(files, 6).header.parent_log_id, from(files, 0).header.log_id);
  EXPECT_EQ(from(files, 3).header.parent_log_id, from(files, 6).header.log_id);
}

TEST_F(RoomLogTest, ARewindDoesNotBringBackALogThatHasEnded) {
  place_.path = folder_ + "/match.cylog";
  const auto disk = std::make_shared<ScriptedDisk>();
  place_.disk = disk;
  std::atomic<bool> broken{false};
  disk->on_write = [&](int file, std::span<const std::byte> bytes, std::size_t& written) {
    return broken ? EIO : system_disk()->write(file, bytes, written);
  };
  RoomLog log(place_, {}, slow_);
  write_ticks(log, 1, 5);
  broken = true;
  write_ticks(log, 6, 20);
  ASSERT_TRUE(eventually([&] { return !log.durable(); }));
  broken = false;
  rewind(log, 3);
  write_ticks(log, 4, 8);
  EXPECT_FALSE(log.durable());
  EXPECT_NE(log.error(), "");
  log.close({8, numbered_tick(8).digest, {}});
  EXPECT_TRUE(eventually([&] { return log.settled(); }));
  EXPECT_FALSE(log.durable());
  EXPECT_EQ(logs().size(), 1u);
}

TEST_F(RoomLogTest, AnErrorInTheLastSyncOfABranchedFileIsSeen) {
  place_.path = folder_ + "/match.cylog";
  place_.sync = LogSync::kNone;  // Nothing but the close of a file syncs it.
  const auto disk = std::make_shared<ScriptedDisk>();
  place_.disk = disk;
  std::atomic<int> first{-1};
  std::atomic<bool> broken{false};
  disk->on_sync = [&](int file) {
    int none = -1;
    first.compare_exchange_strong(none, file);
    return broken && file == first ? EIO : system_disk()->sync(file);
  };
  RoomLog log(place_, {}, slow_);
  write_ticks(log, 1, 20);
  EXPECT_TRUE(log.durable());
  broken = true;
  rewind(log, 10);
  EXPECT_TRUE(eventually([&] { return log.settled(); }));
  EXPECT_FALSE(log.durable());
  EXPECT_NE(log.error(), "");
  EXPECT_EQ(logs().size(), 2u);
}

// `cycloid verify FOLDER` takes the *.cylog.
TEST_F(RoomLogTest, EveryFileIsNamedAsALog) {
  place_.directory = folder_;
  {
    RoomLog log(place_, {}, slow_);
    write_ticks(log, 1, 3);
    rewind(log, 2);
    close(log, 2);
  }
  for (const auto& [name, log] : logs())
    EXPECT_THAT(name, MatchesRegex("arena-7-[0-9]+-[0-9]+\\.cylog"));
  std::filesystem::remove_all(folder_);
  std::filesystem::create_directory(folder_);
  place_ = {"arena", folder_ + "/match.cylog", "", LogSync::kInterval, system_disk()};
  RoomLog log(place_, {}, slow_);
  write_ticks(log, 1, 3);
  rewind(log, 2);
  close(log, 2);
  const auto files = logs();
  ASSERT_EQ(files.size(), 2u);
  EXPECT_THAT(files.begin()->first, MatchesRegex("match-from-2-[0-9]+\\.cylog"));
}

}  // namespace
}  // namespace cycloid::server
