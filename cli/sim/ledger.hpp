#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cli/sim/chronicle.hpp"
#include "protocol/log_format.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::sim {

/// What an honest holder of a seat says for a tick: the same whoever it is, so that every given
/// input of a frame can be checked.
scenes::SeatInput honest_input(std::uint64_t seed, int seat, std::uint64_t tick);

/// What one room has confirmed, from its first tick to its end: what everybody is held to.
class Ledger {
 public:
  /// @param seed  Of the honest inputs.
  /// @param shown  Of the scene, before its first tick: to know what every tick looks like. None:
  /// nobody asks.
  Ledger(std::uint64_t seed, Chronicle& chronicle, std::optional<scenes::Simulation> shown = {})
      : seed_(seed), chronicle_(&chronicle), shown_(std::move(shown)) {}

  /// The next tick; checks that it can follow what there is.
  void add(const protocol::LogTick& tick);

  std::uint64_t ticks() const { return ticks_.size(); }
  std::uint64_t digest() const { return digest_; }  ///< Of all frames and digests.
  /// Null where it is not confirmed.
  const protocol::LogTick* at(std::uint64_t tick) const {
    return tick == 0 || tick > ticks_.size() ? nullptr : &ticks_[tick - 1];
  }
  /// Where all bodies were after a confirmed tick, or before the first one.
  /// @pre it was given a simulation, and 0 < ticks() >= tick.
  const std::vector<scenes::Pose>& poses(std::uint64_t tick) const { return poses_[tick]; }
  /// Somebody in this room says what honest clients would not: given inputs are not checked.
  void excuse_inputs() { inputs_excused_ = true; }

  /// Whether `ticks` are how this ledger goes on behind its first `before` ticks. Says where they
  /// are not.
  std::optional<std::string> not_a_prefix(std::span<const protocol::LogTick> ticks,
                                          std::uint64_t before = 0) const;
  /// Steps a world by the frames and compares every digest. Says where they differ.
  std::optional<std::string> not_replayable(scenes::Simulation fresh) const;

 private:
  void mix(const protocol::LogTick& tick);
  void show(const protocol::LogTick& tick);
  void check_seat(std::uint64_t tick, std::size_t seat, const protocol::SeatFrame& said);
  void check_event(std::uint64_t tick, const protocol::FrameEvent& event);

  std::uint64_t seed_;
  Chronicle* chronicle_;
  std::vector<protocol::LogTick> ticks_;
  std::vector<bool> held_;                     ///< By seat.
  std::vector<scenes::SeatInput> last_given_;  ///< By seat, of its holder.
  std::uint64_t digest_ = 0;
  std::optional<scenes::Simulation> shown_;
  std::vector<std::vector<scenes::Pose>> poses_;  ///< By tick, from 0 on.
  bool inputs_excused_ = false;
};

}  // namespace cycloid::sim
