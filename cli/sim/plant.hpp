#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "protocol/codec.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::sim {

/// A bug that a run has on purpose, to see that it is found.
enum class Plant : std::uint8_t {
  kNone,
  kClientSkipsFrame,
  kClientAppliesLateInput,  ///< Its own word counts for it, whatever the frame says.
  kClientComparesUnconfirmed,
  kRoomRepeatsFrame,
  kRoomSwapsFrames,
  kRoomForgetsEventAtSnapshot,
  kRoomSharesSeat,
  kRoomOutboxUnbounded,
  kRoomExtendsDeadline,  ///< Every byte before the hello begins the wait anew.
  kSnapshotWithoutImpulses,
  kLogDropsRecord,
  kLogSwapsRecords,
  kLogForgetsSync,     ///< Of the disk: it says that it has, and has not.
  kLogSpoilsKeyframe,  ///< A bit of the state is the other one.
  kGateTrustsTokens,   ///< Without a look at them.
  kRoomGivesEqualSecrets,
  kRoomHidesRewind,
  kRoomForgetsDelay,  ///< Of those who are to see the match late.
  kCount
};
const char* plant_name(Plant plant);

/// Takes the impulses out of a state that warm-start its next tick.
void forget_impulses(scenes::Simulation& simulation);

/// What a room says to one peer, with the plant's bug in it.
class OutputTamper {
 public:
  explicit OutputTamper(Plant plant) : plant_(plant) {}

  /// The bytes to send instead of these, which are whole messages.
  protocol::Bytes tampered(const protocol::Bytes& bytes);

 private:
  void frame(protocol::InputFrame frame, protocol::Bytes& into);

  Plant plant_;
  std::uint64_t frames_ = 0;
  bool state_before_ = false;  ///< An exact state was said since the last frame.
  protocol::Bytes kept_;       ///< A frame that waits for its successor to overtake it.
};

}  // namespace cycloid::sim
