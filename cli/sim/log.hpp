#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/sim/disk.hpp"
#include "cli/sim/ledger.hpp"
#include "cli/sim/plant.hpp"
#include "protocol/log_format.hpp"
#include "server/room/log_sink.hpp"

namespace cycloid::sim {

enum class LogMode : std::uint8_t { kInterval, kEveryTick };

/// The log of a room on the simulated disk: what server::LogWriter does, without its thread. The
/// first error ends it; nothing is tried again.
class SimLog final : public server::LogSink {
 public:
  struct Options {
    LogMode mode = LogMode::kInterval;
    std::int64_t interval_ns = 100 * kMillisecond;
    std::size_t queue_bytes_max = std::size_t{1} << 20;
    Plant plant = Plant::kNone;
  };
  /// Its header is on the disk at once, whatever the disk's faults.
  SimLog(SimDisk& disk, std::uint64_t file, const protocol::LogHeader& header,
         const Options& options, Chronicle& chronicle);

  void tick(const protocol::LogTick& tick) override;
  void close(const protocol::LogFooter& footer) override;
  bool durable() const override { return error_.empty(); }
  std::string error() const override { return error_; }

  /// A turn of the writer: writes what waits, syncs when that is due.
  void work();

  std::uint64_t file() const { return file_; }
  bool closed() const { return closed_; }
  /// Ticks that are on the disk for good.
  std::uint64_t synced_ticks() const { return synced_ticks_; }
  /// Ticks whose whole record the kernel has.
  std::uint64_t written_ticks() const { return written_ticks_; }

 private:
  void hand_over(const protocol::LogTick& tick);
  void write();
  void sync();
  void fail(const std::string& what);

  SimDisk* disk_;
  std::uint64_t file_;
  Options options_;
  Chronicle* chronicle_;
  std::optional<protocol::LogEncoder> encoder_;
  protocol::Bytes queue_;
  std::optional<protocol::LogTick> kept_;  ///< Of the plant that swaps two.
  std::uint64_t ticks_ = 0;                ///< Handed over.
  std::uint64_t written_ticks_ = 0;
  std::uint64_t synced_ticks_ = 0;
  std::int64_t next_sync_ns_ = 0;
  bool closed_ = false;
  std::string error_;
};

/// What is wrong with the log that a death has left, or with that of a living server; nothing
/// where it is as it should be.
struct LogFound {
  const SimLog* log = nullptr;
  const Ledger* ledger = nullptr;
  std::optional<Death> death;  ///< None: the server lives.
};
std::optional<std::string> log_mistake(const LogFound& found, const protocol::Bytes& bytes);
/// The same of a read that got one bit wrong: it may only be seen, and shorten what is good.
std::optional<std::string> flip_mistake(const Ledger& ledger, const protocol::Bytes& bytes);

}  // namespace cycloid::sim
