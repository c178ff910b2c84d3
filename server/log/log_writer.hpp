#pragma once

#include <sys/types.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "protocol/log_format.hpp"
#include "server/room/log_sink.hpp"

namespace cycloid::server {

/// When a tick counts as written.
enum class LogSync : std::uint8_t {
  kInterval,   ///< Synced every 100 ms: a power cut loses at most that; a killed process, less.
  kEveryTick,  ///< Synced before its frame leaves; the tick waits for the disk.
};

/// The system calls of the writer, so that a test can make them fail. Must be callable from its
/// thread.
struct LogCalls {
  std::function<ssize_t(int, const void*, std::size_t)> write;
  std::function<int(int)> sync;
};
LogCalls system_log_calls();

struct LogWriterOptions {
  std::string path;
  LogSync sync = LogSync::kInterval;
  std::chrono::milliseconds interval{100};
  std::size_t queue_bytes_max = std::size_t{16} << 20;
  LogCalls calls = system_log_calls();
};

/// Appends a match to a file, in order, from its own thread.
///
/// A record handed over is in memory; it is in the kernel (safe from a kill of the process) within
/// moments and on the disk after the next sync. The first error ends the log where it is, which
/// leaves a good prefix: nothing is retried, because after a failed sync nobody knows what is on
/// the disk. A queue that is full is such an error: the disk does not keep up.
class LogWriter final : public LogSink {
 public:
  /// Creates the file, which must not exist, and has its header on the disk on return.
  /// @throws std::system_error
  LogWriter(LogWriterOptions options, const protocol::LogHeader& header);
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;
  /// Without `close` the file ends without a footer: it says itself that it is not complete.
  ~LogWriter() override;

  void tick(const protocol::LogTick& tick) override;
  /// Writes the footer, syncs, and waits for both.
  void close(const protocol::LogFooter& footer) override;
  bool durable() const override { return !failed_; }
  std::string error() const override;

 private:
  void hand_over(bool wait);  ///< `record_`; waits until it is on the disk.
  void run();
  void stop();
  bool write_all(const protocol::Bytes& bytes);
  bool sync();
  /// The lock shows that the caller holds `mutex_`.
  void fail(const std::unique_lock<std::mutex>& lock, const std::string& what);

  LogWriterOptions options_;
  int file_ = -1;
  std::optional<protocol::LogEncoder> encoder_;
  protocol::Bytes record_;  ///< Of the calling thread.

  mutable std::mutex mutex_;
  std::condition_variable work_;
  std::condition_variable written_;
  protocol::Bytes queue_;
  std::string error_;
  std::uint64_t handed_over_ = 0;  ///< Calls of `hand_over`.
  std::uint64_t synced_ = 0;       ///< How many of them are on the disk.
  std::uint64_t wanted_ = 0;       ///< How many of them somebody waits for.
  bool stop_ = false;
  std::atomic<bool> failed_{false};
  std::thread thread_;
};

}  // namespace cycloid::server
