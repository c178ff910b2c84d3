#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "protocol/messages.hpp"

namespace cycloid::client {

/// The state after a tick as a snapshot client holds it: exact, or as poses alone.
struct DecodedState {
  std::uint64_t tick = 0;
  std::vector<std::byte> exact;      ///< World::encode; empty where the profile is quantised.
  std::vector<scenes::Pose> poses;   ///< Where the profile is quantised.
  std::vector<std::byte> quantised;  ///< What a decoder needs of it as a baseline, in its own form.
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

/// Understands exact states that are sent whole: no baseline, the bytes are World::encode.
class ExactDecoder final : public StateDecoder {
 public:
  std::string decode(const protocol::StateDelta& delta, const DecodedState* baseline,
                     DecodedState& into) override;
};

}  // namespace cycloid::client
