#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <utility>

namespace cycloid::protocol {

/// Names a state that clients hold. Two clients that hold different states after one tick, because
/// a budget kept other things from each, have different digests.
struct StateKey {
  std::uint64_t tick = 0;
  std::uint64_t digest = 0;
  friend auto operator<=>(const StateKey&, const StateKey&) = default;
};

struct HistoryLimits {
  std::uint64_t ticks_max = 180;      ///< Older than the newest by more: gone.
  std::size_t bytes_max = 16u << 20;  ///< Of all states together.
};

/// The states that clients may still name as their baseline: bounded in ticks and in bytes,
/// whatever is acknowledged or not. The oldest go first; who names one that is gone is sent a full
/// state. `State` has a free function size_bytes.
template <class State>
class StateHistory {
 public:
  explicit StateHistory(const HistoryLimits& limits) : limits_(limits) {}

  /// Keeps a state, unless one of that key is there: equal states are kept once. It is gone at once
  /// where it alone is over the bound.
  /// @pre `state` is not null.
  void put(const StateKey& key, std::shared_ptr<const State> state) {
    const std::size_t bytes = size_bytes(*state);
    const auto [at, is_new] = kept_.try_emplace(key, Kept{std::move(state), bytes});
    if (is_new) bytes_ += bytes;
    const std::uint64_t newest = kept_.rbegin()->first.tick;
    while (!kept_.empty() &&
           (bytes_ > limits_.bytes_max || newest - kept_.begin()->first.tick > limits_.ticks_max))
      drop_oldest();
  }

  /// Null where it was never there, or is gone.
  std::shared_ptr<const State> find(const StateKey& key) const {
    const auto at = kept_.find(key);
    return at == kept_.end() ? nullptr : at->second.state;
  }

  /// Nobody will name a state before this tick any more.
  void forget_before(std::uint64_t tick) {
    while (!kept_.empty() && kept_.begin()->first.tick < tick) drop_oldest();
  }
  void clear() {
    kept_.clear();
    bytes_ = 0;
  }

  std::size_t states() const { return kept_.size(); }
  std::size_t bytes() const { return bytes_; }

 private:
  struct Kept {
    std::shared_ptr<const State> state;
    std::size_t bytes = 0;
  };
  void drop_oldest() {
    bytes_ -= kept_.begin()->second.bytes;
    kept_.erase(kept_.begin());
  }

  HistoryLimits limits_;
  std::map<StateKey, Kept> kept_;
  std::size_t bytes_ = 0;
};

}  // namespace cycloid::protocol
