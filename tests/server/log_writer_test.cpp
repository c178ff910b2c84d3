#include "server/log/log_writer.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <system_error>
#include <vector>

namespace cycloid::server {
namespace {

protocol::LogTick tick_of(std::uint64_t tick) {
  protocol::LogTick result;
  result.frame.tick = tick;
  result.frame.seats.resize(2);
  result.digest = 100 + tick;
  return result;
}

class LogWriterTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    options_.path = testing::TempDir() + "cycloid-" + std::to_string(::getpid()) + test->name();
    header_.salt = 7;
    header_.scene_name = "none";
    std::filesystem::remove(options_.path);
  }
  void TearDown() override { std::filesystem::remove(options_.path); }

  protocol::Log read() const {
    std::ifstream stream(options_.path, std::ios::binary);
    const std::vector<char> text{std::istreambuf_iterator<char>(stream), {}};
    return protocol::read_log(std::as_bytes(std::span(text)));
  }

  LogWriterOptions options_;
  protocol::LogHeader header_;
};

TEST_F(LogWriterTest, AClosedLogIsComplete) {
  LogWriter writer(options_, header_);
  for (std::uint64_t tick = 1; tick <= 1000; ++tick) writer.tick(tick_of(tick));
  writer.close({1000, 1100});
  EXPECT_TRUE(writer.durable());
  const protocol::Log log = read();
  EXPECT_EQ(log.state, protocol::LogState::kComplete) << log.reason;
  EXPECT_EQ(log.ticks.size(), 1000u);
}

TEST_F(LogWriterTest, TheHeaderIsThereBeforeAnyTick) {
  const LogWriter writer(options_, header_);
  EXPECT_EQ(read().state, protocol::LogState::kOpen);
}

TEST_F(LogWriterTest, WithoutACloseTheLogSaysThatItIsOpen) {
  {
    LogWriter writer(options_, header_);
    writer.tick(tick_of(1));
  }
  const protocol::Log log = read();
  EXPECT_EQ(log.state, protocol::LogState::kOpen);
  EXPECT_EQ(log.ticks.size(), 1u);
}

TEST_F(LogWriterTest, AnExistingFileIsLeftAlone) {
  std::ofstream(options_.path) << "mine";
  EXPECT_THROW(LogWriter(options_, header_), std::system_error);
  EXPECT_EQ(std::filesystem::file_size(options_.path), 4u);
}

TEST_F(LogWriterTest, EveryTickSyncsBeforeTheCallReturns) {
  auto syncs = std::make_shared<std::atomic<int>>(0);
  options_.sync = LogSync::kEveryTick;
  options_.calls.sync = [syncs](int) {
    ++*syncs;
    return 0;
  };
  LogWriter writer(options_, header_);
  for (int tick = 1; tick <= 20; ++tick) {
    const int before = *syncs;
    writer.tick(tick_of(static_cast<std::uint64_t>(tick)));
    EXPECT_GT(*syncs, before);
    EXPECT_EQ(read().ticks.size(), static_cast<std::size_t>(tick));
  }
}

TEST_F(LogWriterTest, ShortAndInterruptedWritesAreFinished) {
  auto calls = std::make_shared<std::atomic<int>>(0);
  options_.calls.write = [calls](int file, const void* bytes, std::size_t count) -> ssize_t {
    if (++*calls % 3 == 0) {
      errno = EINTR;
      return -1;
    }
    return ::write(file, bytes, std::min<std::size_t>(count, 5));
  };
  LogWriter writer(options_, header_);
  for (std::uint64_t tick = 1; tick <= 50; ++tick) writer.tick(tick_of(tick));
  writer.close({50, 150});
  EXPECT_EQ(read().state, protocol::LogState::kComplete);
}

/// The disk is full after so many bytes, for every such number up to a few records: always a good
/// prefix, never a hang, and the writer says so.
TEST_F(LogWriterTest, AFullDiskLeavesAGoodPrefix) {
  protocol::Bytes bytes;
  const protocol::LogEncoder header(header_, bytes);
  options_.calls.sync = [](int) { return 0; };
  for (std::size_t room = bytes.size(); room < bytes.size() + 120; ++room) {
    std::filesystem::remove(options_.path);
    auto left = std::make_shared<std::size_t>(room);
    options_.calls.write = [left](int file, const void* from, std::size_t count) -> ssize_t {
      const std::size_t taken = std::min(count, *left);
      *left -= taken;
      if (taken != 0) return ::write(file, from, taken);
      errno = ENOSPC;
      return -1;
    };
    LogWriter writer(options_, header_);
    for (std::uint64_t tick = 1; tick <= 10; ++tick) writer.tick(tick_of(tick));
    writer.close({10, 110});
    EXPECT_FALSE(writer.durable());
    EXPECT_NE(writer.error().find("No space left"), std::string::npos) << writer.error();
    const protocol::Log log = read();
    EXPECT_TRUE(log.state == protocol::LogState::kOpen || log.state == protocol::LogState::kTorn);
    EXPECT_EQ(log.ticks.size(), (room - bytes.size()) / 51);
  }
}

TEST_F(LogWriterTest, AFailedSyncIsNotTriedAgain) {
  auto syncs = std::make_shared<std::atomic<int>>(0);
  options_.calls.sync = [syncs](int) {
    if (++*syncs == 1) return 0;  // Of the header.
    errno = EIO;
    return -1;
  };
  LogWriter writer(options_, header_);
  writer.tick(tick_of(1));
  writer.close({1, 101});
  EXPECT_FALSE(writer.durable());
  EXPECT_EQ(*syncs, 2);
}

TEST_F(LogWriterTest, AHeaderThatCannotBeWrittenIsNoLog) {
  options_.calls.sync = [](int) {
    errno = EIO;
    return -1;
  };
  EXPECT_THROW(LogWriter(options_, header_), std::system_error);
  EXPECT_FALSE(std::filesystem::exists(options_.path));
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
  options_.calls.write = [gate](int file, const void* bytes, std::size_t count) {
    std::unique_lock lock(gate->mutex);
    gate->opened.wait(lock, [&] { return gate->open; });
    return ::write(file, bytes, count);
  };
  LogWriter writer(options_, header_);
  {
    const std::scoped_lock lock(gate->mutex);
    gate->open = false;
  }
  for (std::uint64_t tick = 1; tick <= 100 && writer.durable(); ++tick) writer.tick(tick_of(tick));
  EXPECT_FALSE(writer.durable());
  EXPECT_NE(writer.error().find("does not keep up"), std::string::npos) << writer.error();
  {
    const std::scoped_lock lock(gate->mutex);
    gate->open = true;
  }
  gate->opened.notify_all();
}

}  // namespace
}  // namespace cycloid::server
