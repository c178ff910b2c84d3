#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>

#include "protocol/messages.hpp"
#include "protocol/state/quantised_delta.hpp"
#include "protocol/state/state_history.hpp"

namespace cycloid::protocol {

struct FeedOptions {
  Profile profile = Profile::kQuantised;
  CaptureOptions capture;
  /// Of one quantised delta; an exact one is as large as it is. 533 bytes at 60 Hz are 256 kbit/s.
  std::size_t budget_bytes = 1200;
  HistoryLimits history;
};

/// What one client is sent after a tick.
struct FeedDelta {
  StateDelta message;
  StateKey held;        ///< What the client holds once it has taken it in.
  bool changes = true;  ///< False: it shows what the baseline shows, and need not be sent.
};

/// The states of one room in one profile, coded once for each baseline that is in use, however many
/// clients have it. Without a budget that binds, all clients that acknowledge a tick have the same
/// baseline, whichever way they came to it.
class StateFeed {
 public:
  explicit StateFeed(const FeedOptions& options) : options_(options), history_(options.history) {}

  /// The room has made a tick, or has another state of the same one.
  /// @param digest  Simulation::digest of it.
  void advance(const scenes::Simulation& simulation, std::uint64_t digest);

  /// From a baseline to the tick of the last `advance`. A baseline that is gone, never was, or is
  /// not before that tick is none: then the delta is from nothing, with baseline_tick 0.
  /// @pre advance was called. The result stays good for as long as somebody holds it.
  std::shared_ptr<const FeedDelta> delta(const std::optional<StateKey>& baseline);

  /// What a client holds that was sent the exact state of the last `advance`.
  /// @pre advance was called.
  StateKey now() const { return now_; }

  /// No client's baseline is before this tick.
  void forget_before(std::uint64_t tick) { history_.forget_before(tick); }
  /// After a rewind: ticks come again, with other states.
  void forget_all();

  std::uint64_t encodes() const { return encodes_; }  ///< Deltas coded, whoever got them.
  std::size_t states() const { return history_.states(); }
  std::size_t bytes() const { return history_.bytes(); }

 private:
  /// One profile's way to hold a state: exact bytes, or a quantised state with what waits.
  struct Stored {
    std::vector<std::byte> exact;
    HeldState quantised;
    friend std::size_t size_bytes(const Stored& stored) {
      return sizeof stored + stored.exact.capacity() + size_bytes(stored.quantised.state) +
             stored.quantised.waiting.capacity() * sizeof(WaitingChange);
    }
  };
  void code(const StateKey& key, const Stored* baseline, FeedDelta& into);

  FeedOptions options_;
  StateHistory<Stored> history_;
  StateKey now_;
  std::shared_ptr<const Stored> state_;
  std::map<StateKey, std::shared_ptr<const FeedDelta>> made_;  ///< Of this tick, by baseline.
  std::uint64_t encodes_ = 0;
};

/// What one client was sent and has acknowledged. Bounded: of more than kSentMax that it leaves
/// unanswered, the oldest count as lost.
class SentStates {
 public:
  static constexpr std::size_t kSentMax = 256;

  void sent(const StateKey& held);
  /// @returns false for a tick that was not sent, or is not newer than what was acknowledged:
  ///     nothing has changed.
  bool acknowledge(std::uint64_t tick);
  std::optional<StateKey> baseline() const { return baseline_; }
  std::size_t unanswered() const { return sent_.size(); }

 private:
  std::deque<StateKey> sent_;  ///< By rising tick.
  std::optional<StateKey> baseline_;
};

}  // namespace cycloid::protocol
