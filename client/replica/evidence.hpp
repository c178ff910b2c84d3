#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "client/replica/witness.hpp"
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
class Evidence final : public Witness {
 public:
  explicit Evidence(EvidenceOptions options = {}) : options_(options) {}

  /// Keeps the state: of one tick the last one counts, and states of later ticks, which a rewind
  /// has undone, are forgotten. Appends the next StateParts of what was asked for.
  void leaving(const scenes::Simulation& confirmed, Outbox& out) override;
  void agreed(std::uint64_t tick) override { agreed_tick_ = tick; }
  /// Older states are still shown where they are asked for, but no mismatch to come began there.
  void replaced(const scenes::Simulation& simulation) override;
  /// Appends TickDigests of the ticks that are kept, from the one last agreed on to this one, and
  /// lets one StateWanted be answered.
  void diverged(std::uint64_t tick, Outbox& out) override;
  /// Says nothing where the state is not kept, or where no mismatch is open: an honest server asks
  /// once for each. The parts are sent a few per tick, beside the inputs.
  void wanted(const protocol::StateWanted& wanted, Outbox& out) override;

  std::size_t ticks() const { return ring_.size(); }
  std::size_t bytes() const { return bytes_; }

 private:
  struct Kept {
    std::uint64_t tick = 0;
    std::size_t bytes = 0;
    scenes::Simulation::Saved state;
  };
  void keep(const scenes::Simulation& confirmed);
  void send_parts(Outbox& out);
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
