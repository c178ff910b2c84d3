#include "cli/sim/disk.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "cli/sim/log.hpp"

namespace cycloid::sim {
namespace {

protocol::Bytes filled(std::size_t bytes, unsigned value) {
  return protocol::Bytes(bytes, static_cast<std::byte>(value));
}

class SimDiskTest : public testing::Test {
 protected:
  SimDisk disk(const DiskFaults& faults) {
    SimDisk one(faults, Random(1), chronicle_);
    one.create(1, filled(4, 9));
    return one;
  }
  Chronicle chronicle_;
};

TEST_F(SimDiskTest, KeepsWhatWasSyncedThroughAPowerCut) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SimDisk one({}, Random(seed), chronicle_);
    one.create(1, filled(4, 9));
    (void)one.write(1, filled(3000, 1));
    EXPECT_EQ(one.sync(1), DiskError::kNone);
    (void)one.write(1, filled(3000, 2));
    one.restart(Death::kPower);
    const protocol::Bytes& left = one.content(1);
    ASSERT_GE(left.size(), 3004u);
    EXPECT_EQ(std::count(left.begin(), left.begin() + 3004, std::byte{1}), 3000);
  }
}

TEST_F(SimDiskTest, LosesSectorsOutOfOrderAtAPowerCut) {
  int holes = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    SimDisk one({}, Random(seed), chronicle_);
    one.create(1, filled(4, 9));
    (void)one.write(1, filled(20'000, 2));
    one.restart(Death::kPower);
    const protocol::Bytes& left = one.content(1);
    const auto hole = std::find(left.begin(), left.end(), std::byte{0});
    holes += std::find(hole, left.end(), std::byte{2}) != left.end() ? 1 : 0;
  }
  EXPECT_GT(holes, 10);
}

TEST_F(SimDiskTest, KeepsWhatWasWrittenThroughAKill) {
  SimDisk one = disk({});
  (void)one.write(1, filled(100, 1));
  one.kill();
  (void)one.write(1, filled(100, 2));
  one.restart(Death::kProcess);
  EXPECT_EQ(one.content(1).size(), 104u);
}

TEST_F(SimDiskTest, KeepsNothingThatAFailedSyncHeld) {
  DiskFaults faults;
  faults.sync_error_per_million = kMillion;
  SimDisk one = disk(faults);
  (void)one.write(1, filled(100, 1));
  EXPECT_EQ(one.sync(1), DiskError::kInputOutput);
  one.calm();
  EXPECT_EQ(one.sync(1), DiskError::kNone);
  EXPECT_EQ(one.synced_bytes(1), 4u);
}

TEST_F(SimDiskTest, IsFullAtItsCapacity) {
  DiskFaults faults;
  faults.capacity_bytes = 50;
  SimDisk one = disk(faults);
  EXPECT_EQ(one.write(1, filled(100, 1)).bytes, 50u);
  EXPECT_EQ(one.write(1, filled(1, 1)).error, DiskError::kNoSpace);
  one.enlarge();
  EXPECT_EQ(one.write(1, filled(1, 1)).error, DiskError::kNone);
}

TEST_F(SimDiskTest, WritesLessAndIsInterrupted) {
  DiskFaults faults;
  faults.short_write_per_million = kMillion;
  faults.interrupted_per_million = 300'000;
  SimDisk one = disk(faults);
  std::size_t done = 0;
  while (done < 1000) done += one.write(1, filled(1000 - done, 1)).bytes;
  EXPECT_EQ(one.content(1).size(), 1004u);
  EXPECT_GT(chronicle_.counted(Event::kShortWrite), 0u);
  EXPECT_GT(chronicle_.counted(Event::kInterrupted), 0u);
}

/// A log of some ticks on a disk, and the ledger of them.
class SimLogTest : public testing::Test {
 protected:
  void write(const DiskFaults& faults, server::LogSync sync, std::uint64_t seed,
             std::uint64_t ticks) {
    log_.reset();  // It writes to the disk to its end.
    ledger_.emplace(1, chronicle_);
    disk_.emplace(faults, Random(seed), chronicle_);
    SimLog::Options options;
    options.sync = sync;
    log_.emplace(*disk_, 1, protocol::LogHeader{}, options, chronicle_);
    for (std::uint64_t tick = 1; tick <= ticks; ++tick) {
      protocol::LogTick made;
      made.frame.tick = tick;
      made.digest = scramble(tick);
      ledger_->add(made);
      log_->tick(made);
      chronicle_.now_ns += 16 * kMillisecond;
      log_->turn();
    }
  }
  std::string mistake(std::optional<Death> death) {
    return log_mistake({&*log_, &*ledger_, death}, *disk_).value_or("");
  }

  Chronicle chronicle_;
  std::optional<Ledger> ledger_;
  std::optional<SimDisk> disk_;
  std::optional<SimLog> log_;
};

TEST_F(SimLogTest, IsAPrefixAfterEveryDeath) {
  DiskFaults faults;
  faults.short_write_per_million = 300'000;
  faults.interrupted_per_million = 100'000;
  faults.kill_per_million = 20'000;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const server::LogSync sync =
        seed % 2 == 0 ? server::LogSync::kInterval : server::LogSync::kEveryTick;
    write(faults, sync, seed, 60);
    const Death death = seed % 3 == 0 ? Death::kProcess : Death::kPower;
    disk_->restart(death);
    EXPECT_EQ(mistake(death), "") << seed;
  }
}

TEST_F(SimLogTest, LosesNothingOfASyncedTick) {
  write({}, server::LogSync::kEveryTick, 1, 40);
  EXPECT_EQ(log_->synced_ticks(), 40u);
  disk_->restart(Death::kPower);
  EXPECT_EQ(protocol::read_log(disk_->content(1)).ticks.size(), 40u);
}

TEST_F(SimLogTest, EndsAtTheFirstError) {
  DiskFaults faults;
  faults.capacity_bytes = 600;
  write(faults, server::LogSync::kInterval, 1, 60);
  EXPECT_FALSE(log_->durable());
  EXPECT_THAT(log_->error(), testing::HasSubstr(": write: "));
  EXPECT_EQ(mistake({}), "");
}

TEST_F(SimLogTest, WithALostRecordIsSeen) {
  write({}, server::LogSync::kEveryTick, 1, 40);
  protocol::LogTick extra;
  extra.frame.tick = 41;
  ledger_->add(extra);
  extra.digest = 1;
  log_->tick(extra);
  EXPECT_EQ(mistake({}), "the log: tick 41 is not the one that was confirmed");
}

TEST_F(SimLogTest, ClosesWithItsFooter) {
  write({}, server::LogSync::kInterval, 1, 10);
  log_->close({10, scramble(10)});
  EXPECT_EQ(mistake({}), "");
  EXPECT_EQ(protocol::read_log(disk_->content(1)).state, protocol::LogState::kComplete);
}

}  // namespace
}  // namespace cycloid::sim
