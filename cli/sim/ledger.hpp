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

/// What one room has confirmed, from its first tick to its end: what everybody is held to. Where
/// the match was taken back, the ticks before and behind that are timelines of their own, which
/// begin alike.
class Ledger {
 public:
  /// @param seed  Of the honest inputs.
  /// @param shown  Of the scene, before its first tick: to know what every tick looks like. None:
  /// nobody asks.
  Ledger(std::uint64_t seed, Chronicle& chronicle, std::optional<scenes::Simulation> shown = {})
      : seed_(seed), chronicle_(&chronicle), shown_(std::move(shown)) {}

  /// The next tick; checks that it can follow what there is.
  void add(const protocol::LogTick& tick);

  /// The match goes on from after an earlier tick, which left this state: another timeline begins.
  void branch(std::uint64_t tick, std::span<const std::byte> state);
  std::size_t timeline() const { return timelines_.size() - 1; }  ///< The one that goes on.

  /// The last tick that a timeline has from the one before it.
  std::uint64_t branch_tick(std::size_t timeline) const { return timelines_[timeline].branch_tick; }
  /// The highest that was ever made, in whichever timeline.
  std::uint64_t highest_tick() const;

  std::uint64_t ticks() const { return now().ticks.size(); }
  std::uint64_t ticks(std::size_t timeline) const { return timelines_[timeline].ticks.size(); }
  std::uint64_t digest() const { return digest_; }  ///< Of all frames and digests.
  /// Null where it is not confirmed.
  const protocol::LogTick* at(std::uint64_t tick, std::size_t timeline) const {
    const auto& ticks = timelines_[timeline].ticks;
    return tick == 0 || tick > ticks.size() ? nullptr : &ticks[tick - 1];
  }
  /// Where all bodies were after a confirmed tick, or before the first one.
  /// @pre it was given a simulation, and 0 < ticks(timeline) >= tick.
  const std::vector<scenes::Pose>& poses(std::uint64_t tick, std::size_t timeline) const {
    return timelines_[timeline].poses[tick];
  }
  /// Somebody in this room says what honest clients would not: given inputs are not checked.
  void excuse_inputs() { inputs_excused_ = true; }

  /// Whether `ticks` are how the timeline goes on behind its first `before` ticks. Says where they
  /// are not.
  std::optional<std::string> not_a_prefix(std::span<const protocol::LogTick> ticks,
                                          std::uint64_t before, std::size_t timeline) const;
  /// Steps a world by the frames of the last timeline and compares every digest. Says where they
  /// differ.
  std::optional<std::string> not_replayable(scenes::Simulation fresh) const;

 private:
  void mix(const protocol::LogTick& tick);
  void show(const protocol::LogTick& tick);
  void check_seat(std::uint64_t tick, std::size_t seat, const protocol::SeatFrame& said);
  void check_event(std::uint64_t tick, const protocol::FrameEvent& event);

  std::uint64_t seed_;
  Chronicle* chronicle_;
  struct Timeline {
    std::vector<protocol::LogTick> ticks;
    std::vector<std::vector<scenes::Pose>> poses;  ///< By tick, from 0 on.
    std::uint64_t branch_tick = 0;                 ///< The last that is of the timeline before.
  };
  Timeline& now() { return timelines_.back(); }
  const Timeline& now() const { return timelines_.back(); }

  std::vector<Timeline> timelines_ = std::vector<Timeline>(1);
  std::vector<bool> held_;                     ///< By seat.
  std::vector<scenes::SeatInput> last_given_;  ///< By seat, of its holder.
  std::uint64_t digest_ = 0;
  std::optional<scenes::Simulation> shown_;
  bool inputs_excused_ = false;
};

}  // namespace cycloid::sim
