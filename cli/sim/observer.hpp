#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli/sim/ledger.hpp"
#include "client/replica/follower.hpp"
#include "protocol/messages.hpp"

namespace cycloid::sim {

/// Holds what one client hears, on one connection, against what was confirmed.
class Observer {
 public:
  Observer(const Ledger& ledger, std::string name, Chronicle& chronicle)
      : ledger_(&ledger), name_(std::move(name)), chronicle_(&chronicle) {}

  /// The room lets the client in, in this timeline of its ledger.
  /// @param delay_ticks  By which it sees the match late.
  void welcomed(std::uint64_t tick, std::size_t timeline, std::uint64_t delay_ticks);
  /// Before the follower has it.
  void heard(const protocol::ServerMessage& message);
  /// After the follower took what was heard: its state is the confirmed one.
  void check_state(const client::Follower& follower);

  /// The same of a follower with the quantised profile: what it shows is within the profile's error
  /// of where each body was; of the tick that it shows, or, where the budget of bytes `may_lag`, of
  /// one before.
  void check_shown(const client::Follower& follower, bool may_lag);

  /// Its bytes were damaged on the way: what it hears is nobody's word, so nothing is checked until
  /// it connects again.
  void excuse() { excused_ = true; }
  bool excused() const { return excused_; }
  /// Its world was disturbed: its digests are wrong until an exact state comes.
  void disturb() { disturbed_ = true; }
  bool disturbed() const { return disturbed_; }
  void mended() { disturbed_ = false; }

  /// The last tick at which its state was found to be the confirmed one.
  std::uint64_t verified_tick() const { return verified_tick_; }
  std::uint64_t delay_ticks() const { return delay_ticks_; }

 private:
  /// The confirmed tick that the follower holds, where it has not been looked at yet; else 0.
  std::uint64_t new_tick(const client::Follower& follower);
  void on_frame(const protocol::InputFrame& frame);
  void on_exact_state(std::uint64_t tick);
  void check_delay(const protocol::ServerMessage& message);
  /// Of the timelines that the client may be in, those stay of which `matches`; where none does,
  /// all stay. @returns whether one does.
  template <class Matches>
  bool narrow(Matches&& matches) {
    widen();
    std::set<std::size_t> left;
    for (const std::size_t timeline : timelines_) {
      if (matches(timeline)) left.insert(timeline);
    }
    if (left.empty()) return false;
    timelines_ = std::move(left);
    return true;
  }
  void widen();
  void on_rewound(std::uint64_t tick);
  bool is_shown_right(const scenes::Pose& pose, std::uint64_t tick, bool may_lag,
                      std::size_t timeline) const;
  std::string mistake_of(const std::vector<scenes::Pose>& shown, std::uint64_t tick, bool may_lag,
                         std::size_t timeline) const;
  void verify(std::uint64_t tick);
  void wrong(Invariant invariant, const std::string& text) {
    chronicle_->violate(invariant, name_ + ": " + text);
  }

  const Ledger* ledger_;
  std::string name_;
  Chronicle* chronicle_;
  /// Of the ledger: those that what was heard may be of. Without a delay it is one.
  std::set<std::size_t> timelines_ = {0};
  std::uint64_t seen_tick_ = 0;  ///< The last tick that it was shown, or told to go on from.
  std::uint64_t last_frame_ = 0;
  std::uint64_t exact_tick_ = 0;  ///< Of the last exact state announced: frames may go on there.
  std::uint64_t verified_tick_ = 0;
  std::uint64_t delay_ticks_ = 0;
  bool welcomed_ = false;
  bool excused_ = false;
  bool disturbed_ = false;
};

}  // namespace cycloid::sim
