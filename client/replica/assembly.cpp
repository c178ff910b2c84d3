#include "client/replica/assembly.hpp"

#include <utility>

namespace cycloid::client {

std::string SnapshotAssembly::mistake(const protocol::SnapshotPart& part) const {
  const std::size_t size = part.bytes.size();
  if (part.total_bytes == 0 || part.total_bytes > total_bytes_max_) {
    return "announces a state of " + std::to_string(part.total_bytes) + " bytes, of 1 to " +
           std::to_string(total_bytes_max_);
  }
  if (size == 0 || size > protocol::kSnapshotPartBytesMax) {
    return "holds " + std::to_string(size) + " bytes, of 1 to " +
           std::to_string(protocol::kSnapshotPartBytesMax);
  }
  if (part.offset > part.total_bytes || size > part.total_bytes - part.offset) {
    return "ends behind the " + std::to_string(part.total_bytes) + " bytes of its state";
  }
  if (part.offset == 0) return "";
  if (!under_way()) return "continues a state that has not begun";
  if (part.tick != snapshot_.tick || part.digest != snapshot_.digest ||
      part.total_bytes != total_bytes_) {
    return "is of another state than the part before it, of tick " + std::to_string(snapshot_.tick);
  }
  if (part.offset != snapshot_.state.size()) {
    return "begins at byte " + std::to_string(part.offset) + " instead of " +
           std::to_string(snapshot_.state.size());
  }
  return "";
}

std::string SnapshotAssembly::take(const protocol::SnapshotPart& part) {
  if (const std::string wrong = mistake(part); !wrong.empty()) {
    clear();
    return wrong;
  }
  if (part.offset == 0) {
    clear();
    snapshot_.tick = part.tick;
    snapshot_.digest = part.digest;
    total_bytes_ = part.total_bytes;
  }
  snapshot_.state.insert(snapshot_.state.end(), part.bytes.begin(), part.bytes.end());
  return "";
}

std::optional<protocol::Snapshot> SnapshotAssembly::finish() {
  if (!under_way() || snapshot_.state.size() != total_bytes_) return std::nullopt;
  protocol::Snapshot whole = std::move(snapshot_);
  clear();
  return whole;
}

void SnapshotAssembly::clear() {
  snapshot_ = {};
  total_bytes_ = 0;
}

}  // namespace cycloid::client
