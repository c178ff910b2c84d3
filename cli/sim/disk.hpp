#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>

#include "cli/sim/chronicle.hpp"
#include "cli/sim/pipe.hpp"
#include "cli/sim/random.hpp"
#include "protocol/codec.hpp"

namespace cycloid::sim {

/// Of a call, in millionths, where nothing else is said.
struct DiskFaults {
  std::uint32_t short_write_per_million = 0;
  std::uint32_t interrupted_per_million = 0;
  std::uint32_t write_error_per_million = 0;
  std::uint32_t sync_error_per_million = 0;
  std::uint32_t kill_per_million = 0;   ///< The process dies in this write, after part of it.
  std::uint32_t stall_per_million = 0;  ///< Of a turn of the writer: the disk does nothing.
  std::int64_t stall_ns = 0;
  std::uint64_t capacity_bytes = 0;  ///< Of all files; 0: as many as one likes.
};

enum class DiskError : std::uint8_t { kNone, kInterrupted, kInputOutput, kNoSpace };

struct DiskWrite {
  std::size_t bytes = 0;
  DiskError error = DiskError::kNone;
};

/// How a server comes to its end.
enum class Death : std::uint8_t {
  kProcess,  ///< kill -9: what was written is kept by the kernel.
  kPower,    ///< Of what was not synced any sector may be there, or not, in any order.
};

/// The disk of the server's machine: append-only files, with a cache that a power cut empties.
class SimDisk {
 public:
  SimDisk(const DiskFaults& faults, Random random, Chronicle& chronicle)
      : faults_(faults), random_(random), chronicle_(&chronicle) {}

  /// A new file with bytes that are on the disk for good: a server whose log cannot begin does not
  /// start, which is no matter of a run.
  void create(std::uint64_t file, const protocol::Bytes& bytes) {
    files_[file] = {bytes, bytes.size(), false};
  }
  DiskWrite write(std::uint64_t file, std::span<const std::byte> bytes);
  DiskError sync(std::uint64_t file);
  /// Whether the disk does nothing just now: a turn of the writer takes no effect.
  bool stalled();

  /// The process is dead: nothing that it still tries has any effect, until `restart`.
  bool killed() const { return killed_; }
  void kill() { killed_ = true; }
  /// What a machine finds when it comes up again: part of what was not synced may be gone.
  void restart(Death death);
  /// No new fault from now on, and room for all that comes.
  void calm() {
    faults_ = {};
    stalled_until_ns_ = 0;
  }
  /// Room is made, as an operator would.
  void enlarge() { faults_.capacity_bytes = 0; }

  const protocol::Bytes& content(std::uint64_t file) const { return files_.at(file).bytes; }
  std::size_t synced_bytes(std::uint64_t file) const { return files_.at(file).synced; }
  /// A read that gets one bit wrong. @pre the file is not empty.
  protocol::Bytes flipped(std::uint64_t file);
  /// The file is of no more interest.
  void forget(std::uint64_t file) { files_.erase(file); }

 private:
  static constexpr std::size_t kSectorBytes = 512;
  struct File {
    protocol::Bytes bytes;
    std::size_t synced = 0;
    bool lost = false;  ///< A sync failed: what was dirty then counts as clean, and is nowhere.
  };
  void lose_unsynced(File& file);

  DiskFaults faults_;
  Random random_;
  Chronicle* chronicle_;
  std::map<std::uint64_t, File> files_;
  std::uint64_t used_bytes_ = 0;
  std::int64_t stalled_until_ns_ = 0;
  bool killed_ = false;
};

}  // namespace cycloid::sim
