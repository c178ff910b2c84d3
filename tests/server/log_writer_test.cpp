#include "server/log/log_writer.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <system_error>
#include <vector>

#include "tests/server/host_fixture.hpp"

namespace cycloid::server {
namespace {

class LogWriterTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = testing::TempDir() + "cycloid-" + std::to_string(::getpid()) + test->name();
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directory(folder_);
    options_.path = folder_ + "/a.cylog";
    options_.disk = disk_;
    header_.salt = 7;
    header_.scene_name = "none";
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  protocol::Log read(const std::string& path) const {
    std::ifstream stream(path, std::ios::binary);
    const std::vector<char> text{std::istreambuf_iterator<char>(stream), {}};
    return protocol::read_log(std::as_bytes(std::span(text)));
  }
  protocol::Log read() const { return read(options_.path); }
  /// Names in the folder, temporary ones included.
  std::size_t files() const {
    return static_cast<std::size_t>(
        std::distance(std::filesystem::directory_iterator(folder_), {}));
  }

  std::string folder_;
  std::shared_ptr<ScriptedDisk> disk_ = std::make_shared<ScriptedDisk>();
  LogWriterOptions options_;
  protocol::LogHeader header_;
};

void write_ticks(LogWriter& writer, std::uint64_t first, std::uint64_t last) {
  for (std::uint64_t tick = first; tick <= last; ++tick) {
    writer.tick(numbered_tick(tick));
    if (writer.wants_keyframe(tick))
      writer.keyframe(tick, numbered_tick(tick).digest, numbered_state(tick));
  }
}

protocol::LogFooter footer_of(std::uint64_t tick) {
  return {tick, numbered_tick(tick).digest, {}};
}

TEST_F(LogWriterTest, AClosedLogIsComplete) {
  for (const LogSync sync : {LogSync::kInterval, LogSync::kEveryTick, LogSync::kNone}) {
    std::filesystem::remove(options_.path);
    options_.sync = sync;
    LogWriter writer(options_, header_);
    const std::uint64_t ticks = sync == LogSync::kEveryTick ? 50 : 1000;
    write_ticks(writer, 1, ticks);
    writer.close(footer_of(ticks));
    EXPECT_TRUE(writer.durable());
    const protocol::Log log = read();
    EXPECT_EQ(log.state, protocol::LogState::kComplete) << log.reason;
    EXPECT_EQ(log.ticks.size(), ticks);
    EXPECT_EQ(wrong_in(log), "");
    EXPECT_EQ(files(), 1u);
  }
}

TEST_F(LogWriterTest, EveryModeHasItsName) {
  EXPECT_EQ(log_sync_of("interval"), LogSync::kInterval);
  EXPECT_EQ(log_sync_of("tick"), LogSync::kEveryTick);
  EXPECT_EQ(log_sync_of("none"), LogSync::kNone);
}

TEST_F(LogWriterTest, TheHeaderIsThereBeforeAnyTick) {
  const LogWriter writer(options_, header_);
  EXPECT_EQ(read().state, protocol::LogState::kOpen);
}

TEST_F(LogWriterTest, WithoutACloseTheLogSaysThatItIsOpen) {
  {
    LogWriter writer(options_, header_);
    writer.tick(numbered_tick(1));
  }
  const protocol::Log log = read();
  EXPECT_EQ(log.state, protocol::LogState::kOpen);
  EXPECT_EQ(log.ticks.size(), 1u);
}

TEST_F(LogWriterTest, AnExistingFileIsLeftAlone) {
  std::ofstream(options_.path) << "mine";
  EXPECT_THROW(LogWriter(options_, header_), std::system_error);
  EXPECT_EQ(std::filesystem::file_size(options_.path), 4u);
  EXPECT_EQ(files(), 1u);
}

TEST_F(LogWriterTest, EveryTickSyncsBeforeTheCallReturns) {
  auto syncs = std::make_shared<std::atomic<int>>(0);
  options_.sync = LogSync::kEveryTick;
  disk_->on_sync = [syncs](int) {
    ++*syncs;
    return 0;
  };
  LogWriter writer(options_, header_);
  for (int tick = 1; tick <= 20; ++tick) {
    const int before = *syncs;
    writer.tick(numbered_tick(static_cast<std::uint64_t>(tick)));
    EXPECT_GT(*syncs, before);
    EXPECT_EQ(read().ticks.size(), static_cast<std::size_t>(tick));
  }
}

/// A keyframe comes behind the sync of its tick and waits for the next: no longer than any record.
TEST_F(LogWriterTest, AKeyframeIsSyncedInTimeWithoutATickBehindIt) {
  auto syncs = std::make_shared<std::atomic<int>>(0);
  options_.sync = LogSync::kEveryTick;
  options_.interval = std::chrono::milliseconds(10);
  disk_->on_sync = [syncs](int) {
    ++*syncs;
    return 0;
  };
  LogWriter writer(options_, header_);
  writer.tick(numbered_tick(1));
  const int before = *syncs;
  writer.keyframe(1, numbered_tick(1).digest, numbered_state(1));
  EXPECT_TRUE(eventually([&] { return *syncs == before + 1; }));
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_EQ(*syncs, before + 1) << "once there is nothing more to sync";
}

TEST_F(LogWriterTest, WithoutSyncsThereIsNoneButAtBothEnds) {
  auto syncs = std::make_shared<std::atomic<int>>(0);
  options_.sync = LogSync::kNone;
  options_.interval = std::chrono::milliseconds(1);
  disk_->on_sync = [syncs](int) {
    ++*syncs;
    return 0;
  };
  LogWriter writer(options_, header_);
  write_ticks(writer, 1, 300);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_EQ(*syncs, 1);
  writer.close(footer_of(300));
  EXPECT_EQ(*syncs, 2);
}

TEST_F(LogWriterTest, AFailedSyncIsNotTriedAgain) {
  auto syncs = std::make_shared<std::atomic<int>>(0);
  disk_->on_sync = [syncs](int) { return ++*syncs == 1 ? 0 : EIO; };  // The first is the header's.
  LogWriter writer(options_, header_);
  writer.tick(numbered_tick(1));
  writer.close(footer_of(1));
  EXPECT_FALSE(writer.durable());
  EXPECT_NE(writer.error().find(options_.path + ": sync: "), std::string::npos) << writer.error();
  EXPECT_EQ(*syncs, 2);
}

TEST_F(LogWriterTest, AHeaderThatCannotBeWrittenIsNoLog) {
  disk_->on_sync = [](int) { return EIO; };
  EXPECT_THROW(LogWriter(options_, header_), std::system_error);
  EXPECT_EQ(files(), 0u);
}

/// A disk that stands still: the match must not wait for it without bound.
TEST_F(LogWriterTest, AFullQueueEndsTheLogInsteadOfTheMatch) {
  struct Gate {
    std::mutex mutex;
    std::condition_variable opened;
    bool open = true;
  };
  auto gate = std::make_shared<Gate>();
  options_.queue_bytes_max = 1000;
  disk_->on_write = [gate](int file, std::span<const std::byte> bytes, std::size_t& written) {
    std::unique_lock lock(gate->mutex);
    gate->opened.wait(lock, [&] { return gate->open; });
    return system_disk()->write(file, bytes, written);
  };
  LogWriter writer(options_, header_);
  {
    const std::scoped_lock lock(gate->mutex);
    gate->open = false;
  }
  protocol::Bytes accepted;
  protocol::LogEncoder encoder(header_, accepted);
  accepted.clear();
  std::size_t accepted_bytes = 0;
  for (std::uint64_t tick = 1; tick <= 200 && writer.durable(); ++tick) {
    accepted_bytes = accepted.size();
    encoder.tick(numbered_tick(tick), accepted);
    writer.tick(numbered_tick(tick));
  }
  EXPECT_FALSE(writer.durable());
  EXPECT_NE(writer.error().find("does not keep up"), std::string::npos) << writer.error();
  EXPECT_GT(accepted_bytes, 900u);
  EXPECT_LE(accepted_bytes, 1000u);
  {
    const std::scoped_lock lock(gate->mutex);
    gate->open = true;
  }
  gate->opened.notify_all();
}

TEST_F(LogWriterTest, KeyframesKeepTheirIntervalAndTheirBudget) {
  options_.keyframes = {50, 4};
  LogWriter writer(options_, header_);
  std::vector<std::uint64_t> ticks;
  std::uint64_t bytes = 0;
  for (std::uint64_t tick = 1; tick <= 5000; ++tick) {
    writer.tick(numbered_tick(tick));
    if (!writer.wants_keyframe(tick)) continue;
    const std::vector<std::byte> state(tick < 2000 ? 100 : 1000, std::byte{1});
    writer.keyframe(tick, numbered_tick(tick).digest, state);
    ticks.push_back(tick);
    bytes += state.size();
    EXPECT_LE(bytes, 4 * tick + state.size());
  }
  writer.close(footer_of(5000));
  ASSERT_GT(ticks.size(), 40u);
  EXPECT_EQ(ticks[0], 50u);
  EXPECT_EQ(ticks[1], 100u);
  EXPECT_EQ(ticks.back() - ticks[ticks.size() - 2], 250u);
  const protocol::Log log = read();
  ASSERT_EQ(log.keyframes.size(), ticks.size());
  for (std::size_t i = 0; i < ticks.size(); ++i) EXPECT_EQ(log.keyframes[i].tick, ticks[i]);
}

TEST_F(LogWriterTest, WithoutABudgetThereAreNoKeyframes) {
  options_.keyframes.bytes_per_tick = 0;
  LogWriter writer(options_, header_);
  writer.tick(numbered_tick(1));
  EXPECT_FALSE(writer.wants_keyframe(1));
  EXPECT_FALSE(writer.wants_keyframe(1000000));
}

/// Two files, each whole by itself; the second names the first.
TEST_F(LogWriterTest, ARotatedLogGoesOnInAnother) {
  header_.log_id = 0x1234;
  options_.keyframes.bytes_per_tick = 0;  // A rotation has one all the same.
  const std::string second = folder_ + "/b.cylog";
  LogWriter writer(options_, header_);
  write_ticks(writer, 1, 120);
  EXPECT_FALSE(writer.rotate(second));
  EXPECT_EQ(writer.rotate(folder_ + "/c.cylog"), std::errc::device_or_resource_busy);
  write_ticks(writer, 121, 300);
  writer.close(footer_of(300));
  EXPECT_EQ(files(), 2u);
  const protocol::Log a = read();
  EXPECT_EQ(a.state, protocol::LogState::kComplete) << a.reason;
  EXPECT_EQ(a.last_tick, 121u);
  EXPECT_EQ(wrong_in(a), "");
  const protocol::Log b = read(second);
  EXPECT_EQ(b.state, protocol::LogState::kComplete) << b.reason;
  EXPECT_EQ(b.header.branch_tick, 121u);
  EXPECT_EQ(b.header.parent_log_id, 0x1234u);
  EXPECT_NE(b.header.log_id, 0x1234u);
  EXPECT_NE(b.header.salt, a.header.salt);
  EXPECT_GT(b.header.start_unix_ns, 0);
  EXPECT_EQ(b.last_tick, 300u);
  EXPECT_EQ(wrong_in(b), "");
}

TEST_F(LogWriterTest, ARotationToWhereNothingCanBeLeavesTheLogAsItIs) {
  LogWriter writer(options_, header_);
  EXPECT_EQ(writer.rotate(options_.path), std::errc::file_exists);
  EXPECT_EQ(writer.rotate(folder_ + "/nowhere/b.cylog"), std::errc::no_such_file_or_directory);
  EXPECT_FALSE(writer.rotate(folder_ + "/b.cylog"));  // And then the match ends.
  writer.tick(numbered_tick(1));
  writer.close(footer_of(1));
  EXPECT_EQ(read().state, protocol::LogState::kComplete);
  EXPECT_EQ(files(), 1u);
}

/// As after a rewind: the first record is the state that it goes on from.
TEST_F(LogWriterTest, ABranchBeginsWithItsState) {
  header_.parent_log_id = 9;
  header_.branch_tick = 40;
  const protocol::LogKeyframe first{40, numbered_tick(40).digest, numbered_tick(40).frame.seats,
                                    numbered_state(40)};
  LogWriter writer(options_, header_, &first);
  write_ticks(writer, 41, 60);
  writer.close(footer_of(60));
  const protocol::Log log = read();
  EXPECT_EQ(log.state, protocol::LogState::kComplete) << log.reason;
  EXPECT_EQ(log.tick_count(), 20u);
  EXPECT_EQ(wrong_in(log), "");
}

}  // namespace
}  // namespace cycloid::server
