#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "protocol/messages.hpp"

namespace cycloid::client {

/// Puts an exact state together from its parts. Holds at most what was sent, whatever a part says
/// is still to come.
class SnapshotAssembly {
 public:
  /// @param total_bytes_max  A part that announces more is refused before anything is kept of it.
  explicit SnapshotAssembly(std::uint32_t total_bytes_max) : total_bytes_max_(total_bytes_max) {}

  /// Takes the next part. One that begins at 0 replaces what came before.
  /// @returns why it does not fit, or "". After a part that does not fit nothing is held.
  std::string take(const protocol::SnapshotPart& part);

  /// The whole state once its last part has come, and then nothing is held any more.
  std::optional<protocol::Snapshot> finish();

  /// Whether a state has begun and is not whole yet.
  bool under_way() const { return total_bytes_ != 0; }
  /// Of the state that is under way.
  std::uint64_t tick() const { return snapshot_.tick; }
  void clear();

 private:
  std::string mistake(const protocol::SnapshotPart& part) const;

  std::uint32_t total_bytes_max_;
  std::uint32_t total_bytes_ = 0;  ///< 0: nothing is under way.
  protocol::Snapshot snapshot_;
};

}  // namespace cycloid::client
