#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <string>

#include "protocol/messages.hpp"
#include "protocol/state/quantised.hpp"
#include "protocol/state/state_feed.hpp"

namespace cycloid::protocol {

struct ReceivedLimits {
  /// Held as baselines: all that a server may still name, and the one that it builds on.
  std::size_t states_max = SentStates::kSentMax + 1;
  std::size_t held_bytes_max = 32u << 20;   ///< Of all of them together.
  std::size_t exact_bytes_max = 16u << 20;  ///< Of one exact state.
  std::size_t bodies_max = 1u << 16;        ///< Of one quantised one, in each list.
};

/// The client's side of StateFeed: the states that the server may name as a baseline, and the
/// newest.
///
/// A client acknowledges (Ack) each tick that `take` or `hold` has accepted. The server then never
/// names an older baseline again than the newest that it has named, so the ones before are let go.
/// Where the limits bind, the oldest go but that one: the server builds on it until a later state
/// is acknowledged.
class ReceivedStates {
 public:
  explicit ReceivedStates(Profile profile, const ReceivedLimits& limits = {})
      : profile_(profile), limits_(limits) {}

  /// A delta in the order in which they came; one of the newest tick, which a server may say twice,
  /// takes its place. Exact: damage is refused but for one in 2^32, and the
  /// caller compares message.digest with the digest of a simulation that has decoded `exact()`.
  /// Quantised: the digest is compared here.
  /// @returns why it was refused, and nothing has changed; or "".
  std::string take(const StateDelta& message);

  /// A state that came otherwise, as SnapshotParts; the server may name it as a baseline once it is
  /// acknowledged. Of the profile that was chosen; the other one's argument is not looked at.
  void hold(std::uint64_t tick, std::vector<std::byte> exact, QuantisedState quantised);
  /// After a rewind: what is held is no longer a baseline of anything.
  void forget_all() { held_.clear(); }

  /// Whether a delta may name this tick as its baseline.
  bool holds(std::uint64_t tick) const { return find(tick) != nullptr; }
  bool empty() const { return held_.empty(); }
  std::uint64_t tick() const { return held_.empty() ? 0 : held_.back().tick; }
  /// The newest. @pre !empty(), and that profile was chosen.
  const std::vector<std::byte>& exact() const { return held_.back().exact; }
  const QuantisedState& quantised() const { return held_.back().quantised; }
  std::size_t states() const { return held_.size(); }
  std::size_t bytes() const;

 private:
  struct Held {
    std::uint64_t tick = 0;
    std::vector<std::byte> exact;
    QuantisedState quantised;
  };
  const Held* find(std::uint64_t tick) const;
  static std::size_t bytes_of(const Held& held);
  void forget_from(std::uint64_t tick);
  void put(Held held);

  Profile profile_;
  ReceivedLimits limits_;
  std::deque<Held> held_;  ///< By rising tick.
};

}  // namespace cycloid::protocol
