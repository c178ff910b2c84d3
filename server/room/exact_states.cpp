#include "server/room/exact_states.hpp"

#include <algorithm>
#include <utility>

namespace cycloid::server {

std::size_t ExactState::parts() const {
  return (bytes_.size() + protocol::kSnapshotPartBytesMax - 1) / protocol::kSnapshotPartBytesMax;
}

Shared ExactState::part(std::size_t i) const {
  parts_.resize(parts());
  if (!parts_[i]) {
    const std::size_t begin = i * protocol::kSnapshotPartBytesMax;
    const std::size_t end = std::min(begin + protocol::kSnapshotPartBytesMax, bytes_.size());
    protocol::SnapshotPart part;
    part.tick = tick_;
    part.digest = digest_;
    part.total_bytes = static_cast<std::uint32_t>(bytes_.size());
    part.offset = static_cast<std::uint32_t>(begin);
    part.bytes.assign(bytes_.begin() + static_cast<std::ptrdiff_t>(begin),
                      bytes_.begin() + static_cast<std::ptrdiff_t>(end));
    parts_[i] = std::make_shared<const protocol::Bytes>(
        protocol::encode(protocol::ServerMessage(std::move(part))));
  }
  return parts_[i];
}

std::shared_ptr<const ExactState> ExactStates::of(const scenes::Simulation& simulation,
                                                  std::uint64_t digest) {
  if (last_ && last_->tick() == simulation.tick()) return last_;
  protocol::Bytes bytes;
  simulation.encode(bytes);
  ++encodes_;
  last_ = std::make_shared<const ExactState>(simulation.tick(), digest, std::move(bytes));
  return last_;
}

}  // namespace cycloid::server
