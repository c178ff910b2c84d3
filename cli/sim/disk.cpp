#include "cli/sim/disk.hpp"

#include <algorithm>

namespace cycloid::sim {

DiskWrite SimDisk::write(std::uint64_t file, std::span<const std::byte> bytes) {
  if (killed_) return {bytes.size(), DiskError::kNone};
  if (random_.chance(faults_.interrupted_per_million)) {
    chronicle_->count(Event::kInterrupted);
    return {0, DiskError::kInterrupted};
  }
  if (random_.chance(faults_.write_error_per_million)) {
    chronicle_->count(Event::kWriteError);
    return {0, DiskError::kInputOutput};
  }
  std::size_t taken = bytes.size();
  if (faults_.capacity_bytes != 0) {
    const std::uint64_t room =
        faults_.capacity_bytes - std::min(faults_.capacity_bytes, used_bytes_);
    if (room == 0) {
      chronicle_->count(Event::kNoSpace);
      return {0, DiskError::kNoSpace};
    }
    taken = std::min<std::size_t>(taken, room);
  }
  if (taken > 1 && random_.chance(faults_.short_write_per_million)) {
    taken = 1 + random_.below(taken - 1);
    chronicle_->count(Event::kShortWrite);
  }
  if (random_.chance(faults_.kill_per_million)) {
    taken = random_.below(taken + 1);
    killed_ = true;
  }
  File& into = files_.at(file);
  into.bytes.insert(into.bytes.end(), bytes.begin(),
                    bytes.begin() + static_cast<std::ptrdiff_t>(taken));
  used_bytes_ += taken;
  return {killed_ ? bytes.size() : taken, DiskError::kNone};
}

DiskError SimDisk::sync(std::uint64_t file) {
  if (killed_) return DiskError::kNone;
  File& synced = files_.at(file);
  if (random_.chance(faults_.interrupted_per_million)) {
    chronicle_->count(Event::kInterrupted);
    return DiskError::kInterrupted;
  }
  if (random_.chance(faults_.sync_error_per_million)) {
    chronicle_->count(Event::kSyncError);
    synced.lost = true;
    return DiskError::kInputOutput;
  }
  if (!synced.lost) synced.synced = synced.bytes.size();
  return DiskError::kNone;
}

bool SimDisk::stalled() {
  if (chronicle_->now_ns < stalled_until_ns_) return true;
  if (!random_.chance(faults_.stall_per_million)) return false;
  stalled_until_ns_ = chronicle_->now_ns + faults_.stall_ns;
  chronicle_->count(Event::kDiskStall);
  return true;
}

void SimDisk::restart(Death death) {
  if (death == Death::kPower) {
    for (auto& [name, file] : files_) lose_unsynced(file);
  }
  killed_ = false;
  stalled_until_ns_ = 0;
}

void SimDisk::lose_unsynced(File& file) {
  const std::size_t dirty = file.bytes.size() - file.synced;
  if (dirty == 0) return;
  file.bytes.resize(file.synced + random_.below(dirty + 1));
  // Half of the time in the order of writing, else each sector by itself; the one that synced
  // bytes share with others was written as a whole.
  if (random_.one_in(2)) return;
  const std::size_t first = (file.synced + kSectorBytes - 1) / kSectorBytes * kSectorBytes;
  for (std::size_t at = first; at < file.bytes.size(); at += kSectorBytes) {
    if (random_.one_in(2)) continue;
    const std::size_t end = std::min(at + kSectorBytes, file.bytes.size());
    std::fill(file.bytes.begin() + static_cast<std::ptrdiff_t>(at),
              file.bytes.begin() + static_cast<std::ptrdiff_t>(end), std::byte{0});
  }
}

protocol::Bytes SimDisk::flipped(std::uint64_t file) {
  protocol::Bytes bytes = files_.at(file).bytes;
  const std::size_t byte = random_.below(bytes.size());
  bytes[byte] ^= static_cast<std::byte>(1u << random_.below(8));
  chronicle_->count(Event::kReadFlip);
  return bytes;
}

}  // namespace cycloid::sim
