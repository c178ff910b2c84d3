#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "cli/sim/ledger.hpp"
#include "cli/sim/log_disk.hpp"
#include "cli/sim/plant.hpp"
#include "protocol/log_format.hpp"
#include "server/log/log_writer.hpp"

namespace cycloid::sim {

/// The log of a room on the simulated disk: server::LogWriter without its thread, and what it has
/// promised so far.
class SimLog final : public server::LogSink {
 public:
  struct Options {
    server::LogSync sync = server::LogSync::kInterval;
    std::int64_t interval_ns = 100 * kMillisecond;
    std::size_t queue_bytes_max = std::size_t{1} << 20;
    std::uint64_t keyframe_ticks = 100;
    Plant plant = Plant::kNone;
  };
  /// @param first_file  The number on the disk of its first file, and then of those behind it.
  SimLog(SimDisk& disk, std::uint64_t first_file, const protocol::LogHeader& header,
         const Options& options, Chronicle& chronicle);

  void tick(const protocol::LogTick& tick) override;
  bool wants_keyframe(std::uint64_t tick) const override { return writer_->wants_keyframe(tick); }
  void keyframe(std::uint64_t tick, std::uint64_t digest,
                std::span<const std::byte> state) override;
  void close(const protocol::LogFooter& footer) override;
  /// As server::RoomLog does: closes the file and goes on in one that names it as its parent.
  void branch(const protocol::LogTick& from, std::span<const std::byte> state) override;
  bool durable() const override { return writer_->durable(); }
  std::string error() const override { return writer_->error(); }

  /// A turn of the writer's thread.
  void turn();
  /// Goes on in another file, from the next keyframe on.
  void rotate();
  /// The process is gone, and the writer with it.
  void die() { disk_->cut_off(); }

  /// By their numbers on the disk, the oldest first.
  const std::vector<std::uint64_t>& files() const { return disk_->files(); }
  /// A file that begins another timeline of the ledger.
  struct Branch {
    std::size_t file = 0;  ///< Its place among `files`.
    std::uint64_t tick = 0;
  };
  const std::vector<Branch>& branches() const { return branches_; }
  bool closed() const { return closed_; }
  /// Ticks that are on the disk for good.
  std::uint64_t synced_ticks() const { return synced_ticks_; }
  /// Ticks whose whole record the kernel has.
  std::uint64_t written_ticks() const { return written_ticks_; }

 private:
  void open(const std::string& path, const protocol::LogKeyframe* first);
  void hand_over(const protocol::LogTick& tick);
  /// What a call of the writer has done, where the process still lives.
  void take_note(std::uint64_t syncs_before);

  SimDisk* machine_;
  Options options_;
  Chronicle* chronicle_;
  std::shared_ptr<LogDisk> disk_;
  protocol::LogHeader header_;
  protocol::LogFooter last_;
  std::vector<Branch> branches_;
  std::unique_ptr<server::LogWriter> writer_;
  std::optional<protocol::LogTick> kept_;  ///< Of the plant that swaps two.
  std::uint64_t ticks_ = 0;                ///< Handed over.
  std::uint64_t written_ticks_ = 0;
  std::uint64_t synced_ticks_ = 0;
  std::uint64_t rotations_ = 0;
  std::int64_t unsynced_since_ns_ = 0;  ///< When the first tick behind `synced_ticks_` came.
  bool closed_ = false;
};

/// What is wrong with the log that a death has left, or with that of a living server; nothing
/// where it is as it should be.
struct LogFound {
  const SimLog* log = nullptr;
  const Ledger* ledger = nullptr;
  std::optional<Death> death;  ///< None: the server lives.
};
std::optional<std::string> log_mistake(const LogFound& found, const SimDisk& disk);
/// The same of a read that got one bit wrong: it may only be seen, and shorten what is good.
std::optional<std::string> flip_mistake(const Ledger& ledger, const protocol::Bytes& bytes);
/// What is wrong with the last keyframe: a replay that begins with it, as `replay --to` does, has
/// to make the digests behind it.
/// @param fresh  Of the scene.
std::optional<std::string> seek_mistake(const protocol::Bytes& bytes, scenes::Simulation fresh);

}  // namespace cycloid::sim
