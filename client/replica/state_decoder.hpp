#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/messages.hpp"
#include "protocol/state/quantised.hpp"

namespace cycloid::client {

/// The state after a tick as a snapshot client holds it: exact, or as poses alone.
struct DecodedState {
  std::uint64_t tick = 0;
  std::vector<std::byte> exact;        ///< World::encode; empty where the profile is quantised.
  protocol::QuantisedState quantised;  ///< Where the profile is quantised.
};

/// Makes states of StateDeltas. Reads what a server sent: bounds everything, throws nothing.
class StateDecoder {
 public:
  virtual ~StateDecoder() = default;

  /// @param baseline  The state of delta.baseline_tick; null where that is 0.
  /// @returns why there is no such state, or "" and then `into` is the state of delta.tick.
  virtual std::string decode(const protocol::StateDelta& delta, const DecodedState* baseline,
                             DecodedState& into) = 0;
};

/// Both profiles, as protocol/state/ writes them, on a baseline or on none.
class DeltaDecoder final : public StateDecoder {
 public:
  /// @param exact_bytes_max  Of one exact state; a delta that says more is refused.
  explicit DeltaDecoder(std::size_t exact_bytes_max = std::size_t{64} << 20)
      : exact_bytes_max_(exact_bytes_max) {}
  std::string decode(const protocol::StateDelta& delta, const DecodedState* baseline,
                     DecodedState& into) override;

 private:
  std::string decode_exact(const protocol::StateDelta& delta, const DecodedState* baseline,
                           DecodedState& into) const;
  static std::string decode_quantised(const protocol::StateDelta& delta,
                                      const DecodedState* baseline, DecodedState& into);

  std::size_t exact_bytes_max_;
};

}  // namespace cycloid::client
