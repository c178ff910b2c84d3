#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <span>
#include <vector>

#include "client/replica/body_changes.hpp"
#include "protocol/messages.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::client {

struct InterpolatorOptions {
  /// A body that is farther from where it was, per tick between the two states, has not moved but
  /// was put there: m.
  float teleport_m = 4.0f;
  /// Beyond the newest state bodies go on as they were for so many ticks, then they stand.
  double extrapolation_ticks = 6.0;
  std::size_t states_max = 64;  ///< Older ones are let go; at least 2.
};

/// Poses to draw at a time that lies between two states. For pictures alone: nothing that it makes
/// is the state, and none of it is the same on all machines.
class Interpolator {
 public:
  explicit Interpolator(InterpolatorOptions options = {});

  /// A state of a tick. One of a tick that is there already, or of an earlier one after a rewind,
  /// replaces it and all that is later.
  void add(std::uint64_t tick, std::span<const scenes::Pose> poses);

  /// Poses at a time in ticks, such as 61.25, in order of the bodies' indices.
  ///
  /// Between two states positions go straight and rotations the shorter way round, at constant
  /// rates. A body that is in one of the two states alone is shown while the time has not reached
  /// the later one, or from then on. Before the oldest state: that one. Beyond the newest: on by
  /// the last two, within bounds. At no number (NaN): the newest. Empty where no state is there.
  std::vector<scenes::Pose> at(double tick) const;

  std::uint64_t newest_tick() const { return states_.empty() ? 0 : states_.back().tick; }
  std::size_t states() const { return states_.size(); }

 private:
  struct State {
    std::uint64_t tick = 0;
    std::vector<scenes::Pose> poses;  ///< Sorted by index and generation.
  };

  std::vector<scenes::Pose> between(const State& from, const State& to, double part) const;
  bool teleports(const State& from, const State& to, const scenes::Pose& a,
                 const scenes::Pose& b) const;

  InterpolatorOptions options_;
  std::deque<State> states_;  ///< Ticks ascending.
};

/// What happened in a tick.
struct TickEvents {
  std::uint64_t tick = 0;
  std::vector<protocol::FrameEvent> seats;
  std::vector<BodyChange> bodies;  ///< Since the state before.
};

/// Collects what happens so that it is shown when its tick is, not when its message came.
class EventFeed {
 public:
  static constexpr std::size_t kTicksMax = 1024;

  /// Joins, leaves and so on of a confirmed frame.
  void add(const protocol::InputFrame& frame);
  /// Bodies that came and went since the state that was told before this one.
  void add(std::uint64_t tick, std::span<const scenes::Pose> poses);
  /// The ticks up to this time in which something happened, oldest first; they are gone then.
  std::vector<TickEvents> take_until(double tick);
  /// Ticks that nobody took and that were let go.
  std::uint64_t lost() const { return lost_; }

 private:
  TickEvents& of(std::uint64_t tick);

  BodyChanges changes_;
  std::deque<TickEvents> waiting_;  ///< Ticks ascending.
  std::uint64_t lost_ = 0;
};

}  // namespace cycloid::client
