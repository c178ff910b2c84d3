#include <gtest/gtest.h>

#include "server/log/log_writer.hpp"
#include "tests/server/log_disks.hpp"

namespace cycloid::server {
namespace {

/// A writer without a thread on a disk in memory: all that it does is in the test's hands.
class LogFaults : public testing::Test {
 protected:
  LogWriterOptions options() {
    LogWriterOptions options;
    options.path = "log";
    options.disk = disk_;
    options.threaded = false;
    options.keyframes = {7, 1000};
    options.now_ns = [this] { return now_ns_; };
    options.random = [this] { return ++random_; };
    return options;
  }

  /// Writes so many ticks, a rotation in their middle, and the end.
  void write_all(LogWriter& writer, std::uint64_t ticks) {
    for (std::uint64_t tick = 1; tick <= ticks; ++tick) {
      if (tick == ticks / 2) (void)writer.rotate("second");
      writer.tick(numbered_tick(tick));
      if (writer.wants_keyframe(tick))
        writer.keyframe(tick, numbered_tick(tick).digest, std::vector<std::byte>(40));
      writer.turn();
    }
    writer.close({ticks, numbered_tick(ticks).digest, {}});
  }

  std::shared_ptr<MemoryDisk> disk_ = std::make_shared<MemoryDisk>();
  std::int64_t now_ns_ = 0;
  std::uint64_t random_ = 0;
};

TEST_F(LogFaults, ShortAndInterruptedWritesAreFinished) {
  disk_->write_bytes_max = 5;
  disk_->interrupts_every = 3;
  LogWriter writer(options(), {});
  write_all(writer, 50);
  EXPECT_TRUE(writer.durable());
  ASSERT_EQ(disk_->files.size(), 2u);
  for (const auto& [name, bytes] : disk_->files) {
    const protocol::Log log = protocol::read_log(bytes);
    EXPECT_EQ(log.state, protocol::LogState::kComplete) << name << ": " << log.reason;
    EXPECT_EQ(wrong_in(log), "");
  }
}

/// The disk is full after every possible number of bytes: what is there is always a good prefix,
/// the writer says so, and the room is not stopped.
TEST_F(LogFaults, AFullDiskAtEveryByteLeavesAGoodPrefix) {
  constexpr std::uint64_t kTicks = 40;
  LogWriter(options(), {});
  const std::size_t header_bytes = disk_->files.at("log").size();
  disk_ = std::make_shared<MemoryDisk>();
  {
    LogWriter writer(options(), {});
    write_all(writer, kTicks);
  }
  std::size_t total = 0;
  for (const auto& [name, bytes] : disk_->files) total += bytes.size();

  for (const int error : {ENOSPC, EIO}) {
    std::uint64_t most = 0;
    for (std::size_t room = 0; room < total; ++room) {
      disk_ = std::make_shared<MemoryDisk>();
      disk_->room_bytes = room;
      disk_->full_error = error;
      if (room < header_bytes) {
        EXPECT_THROW(LogWriter(options(), {}), std::system_error) << room;
        EXPECT_TRUE(disk_->files.empty()) << room;
        continue;
      }
      LogWriter writer(options(), {});
      write_all(writer, kTicks);
      EXPECT_FALSE(writer.durable()) << room;
      EXPECT_NE(writer.error().find(std::generic_category().message(error)), std::string::npos);
      std::uint64_t ticks = 0;
      for (const auto& [name, bytes] : disk_->files) {
        if (name != "log" && name != "second") continue;  // What never got its name.
        const protocol::Log log = protocol::read_log(bytes);
        EXPECT_EQ(wrong_in(log), "") << room << name;
        ticks += log.ticks.size();
      }
      EXPECT_GE(ticks, most) << room;
      most = ticks;
    }
    EXPECT_EQ(most, kTicks);
  }
}

/// With a sync that fails nothing more is written, at whichever sync it is.
TEST_F(LogFaults, AFailedSyncEndsTheLogWhereverItIs) {
  for (int sync = 1; sync < 8; ++sync) {
    disk_ = std::make_shared<MemoryDisk>();
    disk_->syncs_until_error = sync;
    LogWriterOptions every = options();
    every.sync = LogSync::kEveryTick;
    LogWriter writer(every, {});
    write_all(writer, 40);
    EXPECT_FALSE(writer.durable());
    EXPECT_EQ(disk_->syncs, sync + 1);
    EXPECT_EQ(wrong_in(protocol::read_log(disk_->files.at("log"))), "");
  }
}

/// Nobody syncs a file once it is closed, and the next one goes on from its end.
TEST_F(LogFaults, ALogIsSyncedToItsEndBeforeTheNextHasItsName) {
  for (const bool fails : {false, true}) {
    disk_ = std::make_shared<MemoryDisk>();
    LogWriter writer(options(), {});
    ASSERT_FALSE(writer.rotate("second"));
    writer.tick(numbered_tick(1));
    writer.keyframe(1, numbered_tick(1).digest, numbered_state(1));
    if (fails) disk_->syncs_until_error = disk_->syncs;
    writer.turn();
    EXPECT_EQ(writer.durable(), !fails);
    EXPECT_EQ(writer.error().starts_with("log: sync: "), fails) << writer.error();
    EXPECT_EQ(disk_->files.contains("second"), !fails);
    if (!fails) {
      EXPECT_EQ(disk_->synced_bytes.at("log"), disk_->files.at("log").size());
    }
  }
}

TEST_F(LogFaults, ALogWithoutACloseIsSyncedToItsLastTick) {
  {
    LogWriter writer(options(), {});
    writer.tick(numbered_tick(1));
    writer.turn();
    writer.tick(numbered_tick(2));
  }
  const std::vector<std::byte>& bytes = disk_->files.at("log");
  EXPECT_EQ(protocol::read_log(bytes).ticks.size(), 2u);
  EXPECT_EQ(disk_->synced_bytes.at("log"), bytes.size());
}

/// Interval mode without a thread: the clock says when.
TEST_F(LogFaults, WithoutAThreadTheIntervalIsThatOfTheClockGiven) {
  LogWriter writer(options(), {});
  const int before = disk_->syncs;
  for (std::uint64_t tick = 1; tick <= 60; ++tick) {
    now_ns_ += 16'666'667;
    writer.tick(numbered_tick(tick));
    writer.turn();
  }
  EXPECT_EQ(disk_->syncs - before, 10);  // One second of ticks, every 100 ms.
  EXPECT_EQ(protocol::read_log(disk_->files.at("log")).last_tick, 60u);
}

/// A state that can never fit beside others is no sign of a slow disk; several that wait are.
TEST_F(LogFaults, ARecordLargerThanTheQueueDoesNotEndTheLog) {
  LogWriterOptions small = options();
  small.queue_bytes_max = 100;
  LogWriter writer(small, {});
  const std::vector<std::byte> state(500);
  for (std::uint64_t tick = 1; tick <= 40; ++tick) {
    writer.tick(numbered_tick(tick));
    if (writer.wants_keyframe(tick)) writer.keyframe(tick, numbered_tick(tick).digest, state);
    writer.turn();
  }
  EXPECT_TRUE(writer.durable()) << writer.error();
  const protocol::LogSummary log = protocol::scan_log(disk_->files.at("log"));
  EXPECT_EQ(log.last_tick, 40u);
  EXPECT_EQ(log.keyframes.size(), 5u);
  writer.keyframe(40, numbered_tick(40).digest, state);
  writer.keyframe(40, numbered_tick(40).digest, state);
  EXPECT_FALSE(writer.durable());
}

TEST_F(LogFaults, TheSameCallsWriteTheSameBytes) {
  LogWriter first(options(), {});
  write_all(first, 100);
  const auto files = disk_->files;
  disk_ = std::make_shared<MemoryDisk>();
  random_ = 0;
  LogWriterOptions again = options();
  again.unix_now_ns = [] { return std::int64_t{0}; };
  LogWriter second(again, {});
  write_all(second, 100);
  EXPECT_EQ(disk_->files.at("log"), files.at("log"));
}

}  // namespace
}  // namespace cycloid::server
