#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "protocol/messages.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::client {

struct EvidenceOptions {
  /// Of the states that are kept. Two intervals of 60 ticks between digests and a second of round
  /// trip are 180 ticks: 9 MB of a state of 50 kB.
  std::size_t bytes_max = std::size_t{12} << 20;
  std::size_t ticks_max = 256;  ///< However small they are.
  /// Parts that are sent per tick, 3 KiB each: they share the connection with the inputs.
  std::size_t parts_per_tick = 4;
};

/// The last states of a lockstep replica as they were in its memory, so that after a mismatch the
/// server can be told which tick went wrong, and shown that tick's state.
///
/// A state is kept by copying its arrays: 5 us for 50 kB, where encoding takes 28 us and a digest
/// 18 us. Both are made only once somebody asks. What is shown was never computed again, so that a
/// flipped bit is seen.
class Evidence {
 public:
  explicit Evidence(EvidenceOptions options = {}) : options_(options) {}

  /// Keeps the confirmed state. Call it right before the step that leaves it, and before its digest
  /// is compared: what befell it in between is then in it. Of one tick the last one counts; states
  /// of later ticks, which a rewind has undone, are forgotten.
  void record(const scenes::Simulation& confirmed);
  /// My digest of this tick was the server's.
  void agreed(std::uint64_t tick) { agreed_tick_ = tick; }
  /// The server's exact state of this tick is in place of mine. Older ones are still shown where
  /// they are asked for, but no mismatch to come began there.
  void replaced(std::uint64_t tick);
  /// My digest of this tick was not: appends TickDigests of the ticks that are kept, from the one
  /// last agreed on to this one, and lets one StateWanted be answered.
  /// @param simulation  Any of the scene's; it is only asked to read what was kept.
  void diverged(std::uint64_t tick, const scenes::Simulation& simulation,
                std::vector<protocol::ClientMessage>& out);
  /// The server asks for the state after a tick. Says nothing where it is not kept, or where no
  /// mismatch is open: an honest server asks once for each.
  void wanted(std::uint64_t tick, const scenes::Simulation& simulation);
  /// Appends the next StateParts of what was asked for. Call it once per tick.
  void send_parts(std::vector<protocol::ClientMessage>& out);

  std::size_t ticks() const { return ring_.size(); }
  std::size_t bytes() const { return bytes_; }

 private:
  struct Kept {
    std::uint64_t tick = 0;
    std::size_t bytes = 0;
    scenes::Simulation::Saved state;
  };
  void forget(Kept&& kept);
  void forget_from(std::uint64_t tick);
  const Kept* find(std::uint64_t tick) const;

  EvidenceOptions options_;
  std::deque<Kept> ring_;    ///< Ticks ascending.
  std::vector<Kept> spare_;  ///< At most one, whose memory the next state takes.
  std::size_t bytes_ = 0;    ///< Of the ring.
  std::uint64_t agreed_tick_ = 0;
  bool open_ = false;  ///< A mismatch for which no state was asked yet.

  std::uint64_t sending_tick_ = 0;
  std::vector<std::byte> sending_;  ///< Its encoding; empty: nothing is being sent.
  std::size_t sent_bytes_ = 0;
};

}  // namespace cycloid::client
