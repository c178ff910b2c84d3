#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <vector>

#include "protocol/log_format.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::server {

struct HistoryOptions {
  std::uint64_t state_ticks = 60;  ///< Ticks between two kept states.
  std::size_t ticks_max = 256;     ///< Frames and digests.
  /// Of the states. The newest is kept whatever its size.
  std::size_t bytes_max = std::size_t{16} << 20;
};

/// The exact state of the server after a tick, as it was in its memory.
struct KeptState {
  std::uint64_t tick = 0;
  std::uint64_t digest = 0;
  std::shared_ptr<const std::vector<std::byte>> state;  ///< Simulation::encode; never empty.
};

/// What a room remembers of its last ticks, so that a tick can be made again: frames, digests and
/// now and then a state. Bounded by its options.
class History {
 public:
  explicit History(HistoryOptions options = {}) : options_(options) {}

  /// Forgets everything; the match goes on from this state (its start, or where it was taken back).
  void start(const scenes::Simulation& simulation);
  /// The tick that the frame has made. @pre ticks come without a gap since `start`.
  void add(const protocol::InputFrame& frame, std::uint64_t digest,
           const scenes::Simulation& simulation);

  std::uint64_t last_tick() const { return last_tick_; }
  std::optional<std::uint64_t> digest(std::uint64_t tick) const;
  /// The newest kept state of a tick before this one, from which it can be made again.
  std::optional<KeptState> before(std::uint64_t tick) const;
  /// The oldest kept state of this tick or a later one.
  std::optional<KeptState> from(std::uint64_t tick) const;
  /// Of the ticks first, ..., last, as far as they are kept.
  std::vector<protocol::LogTick> ticks(std::uint64_t first, std::uint64_t last) const;

  std::size_t state_bytes() const { return bytes_; }
  /// Bytes of the newest kept state.
  std::size_t newest_bytes() const { return states_.empty() ? 0 : states_.back().state->size(); }

 private:
  void keep(const scenes::Simulation& simulation, std::uint64_t digest);

  HistoryOptions options_;
  std::deque<protocol::LogTick> ticks_;  ///< Ascending, without a gap.
  std::deque<KeptState> states_;         ///< Ascending.
  std::size_t bytes_ = 0;
  std::uint64_t last_tick_ = 0;
};

}  // namespace cycloid::server
