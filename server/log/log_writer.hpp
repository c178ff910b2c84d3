#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <system_error>
#include <thread>

#include "protocol/log/encoder.hpp"
#include "server/log/disk.hpp"
#include "server/log/log_file.hpp"
#include "server/room/log_sink.hpp"

namespace cycloid::server {

/// When a tick counts as written.
enum class LogSync : std::uint8_t {
  kInterval,   ///< Synced every 100 ms: a power cut loses that and what one sync takes.
  kEveryTick,  ///< Synced before its frame leaves; the tick waits for the disk.
  kNone,       ///< Left to the system, and synced at the end: a power cut loses what it may.
};

/// In the order of the modes.
inline constexpr std::array<const char*, 3> kLogSyncNames = {"interval", "tick", "none"};
/// @pre the word is one of kLogSyncNames
LogSync log_sync_of(const std::string& word);

/// How often the exact state goes into the log.
struct KeyframePolicy {
  std::uint64_t ticks_min = 600;  ///< Between two.
  /// What keyframes may take in the long run: a large state comes as rarely as its size demands.
  /// 0: none at all.
  std::uint64_t bytes_per_tick = 16;
};

struct LogWriterOptions {
  std::string path;
  LogSync sync = LogSync::kInterval;
  std::chrono::milliseconds interval{100};
  /// What may wait for the disk, and beside it one record that alone is larger.
  std::size_t queue_bytes_max = std::size_t{16} << 20;
  KeyframePolicy keyframes;
  std::shared_ptr<Disk> disk = system_disk();
  /// False: who made the writer calls `turn`, as a simulation in one thread does.
  bool threaded = true;
  std::function<std::int64_t()> now_ns;       ///< Steady; empty: the system's.
  std::function<std::int64_t()> unix_now_ns;  ///< For the header of a rotated log; empty: system.
  std::function<std::uint64_t()> random;      ///< For salts and ids; empty: the system's.
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
  /// @param first  The state that a log with a branch_tick goes on from, else null.
  /// @throws std::system_error
  LogWriter(LogWriterOptions options, const protocol::LogHeader& header,
            const protocol::LogKeyframe* first = nullptr);
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;
  /// Without `close` the file ends without a footer: it says itself that it is not complete.
  ~LogWriter() override;

  void tick(const protocol::LogTick& tick) override;
  bool wants_keyframe(std::uint64_t tick) const override;
  void keyframe(std::uint64_t tick, std::uint64_t digest,
                std::span<const std::byte> state) override;
  /// Writes the footer, syncs, and waits for both.
  void close(const protocol::LogFooter& footer) override;
  bool durable() const override { return !failed_; }
  std::string error() const override;

  /// Closes the log with a footer and goes on in a new file, which names this one as its parent and
  /// begins with the state of the next keyframe: that is wanted at once. From the room's thread.
  /// @returns why not, and nothing has changed: `path` cannot be made, a rotation is under way
  /// (device_or_resource_busy), or the log has ended (io_error).
  [[nodiscard]] std::error_code rotate(const std::string& path);

  /// Without a thread: does what it would do now, for what waits. Calls that have to wait for the
  /// disk do it themselves. @pre not options.threaded
  void turn();

  /// Of the file that the next tick goes into. From the room's thread.
  std::uint64_t log_id() const { return header_.log_id; }

 private:
  /// What comes after the current file.
  struct Next {
    std::unique_ptr<LogFile> file;
    protocol::Bytes queue;
  };

  std::unique_ptr<LogFile> new_file(const std::string& path) const;
  void turn_over(std::uint64_t tick, std::uint64_t digest, std::span<const std::byte> state);
  void hand_over(bool wait);  ///< `record_`; waits until it is on the disk.
  void run();
  void stop();
  void work(std::unique_lock<std::mutex>& lock);
  bool write_out(const protocol::Bytes& batch, bool sync_now);
  /// The lock shows that the caller holds `mutex_`.
  void fail(const std::unique_lock<std::mutex>& lock, const std::string& what);

  // Of the room's thread.
  LogWriterOptions options_;
  protocol::LogHeader header_;  ///< Of the current file.
  std::optional<protocol::LogEncoder> encoder_;
  protocol::Bytes record_;
  std::uint64_t next_keyframe_ = 0;
  std::unique_ptr<LogFile> rotating_;  ///< Waits for its first keyframe.

  // Of the writer's thread, or of the room's where there is none.
  std::unique_ptr<LogFile> file_;
  std::int64_t next_sync_ns_ = 0;

  mutable std::mutex mutex_;
  std::condition_variable work_;
  std::condition_variable written_;
  protocol::Bytes queue_;
  std::optional<Next> next_;
  std::string error_;
  std::size_t waiting_bytes_ = 0;  ///< Handed over and not yet written.
  std::size_t largest_bytes_ = 0;  ///< Of the records that are larger than the queue may be.
  std::uint64_t handed_over_ = 0;  ///< Records.
  std::uint64_t in_kernel_ = 0;    ///< How many of them are written.
  std::uint64_t synced_ = 0;       ///< How many of them are on the disk.
  std::uint64_t wanted_ = 0;       ///< How many of them somebody waits for.
  bool stop_ = false;
  bool stopped_ = false;
  std::atomic<bool> failed_{false};
  std::thread thread_;
};

}  // namespace cycloid::server
