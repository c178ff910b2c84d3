#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <deque>

namespace cycloid::server {

/// A token bucket in integers: `per_s` tokens a second, `burst` at most, full at first.
class RateBucket {
 public:
  /// @pre 0 < per_s, burst <= 10^9.
  RateBucket(std::uint64_t per_s, std::uint64_t burst)
      : per_s_(per_s), full_(burst * kNanosecondsInSecond), level_(full_) {}

  /// False, and nothing has been taken, where there are not so many. The time never goes back.
  [[nodiscard]] bool take(std::int64_t now_ns, std::uint64_t tokens) {
    if (started_) fill(static_cast<std::uint64_t>(now_ns - filled_ns_));
    started_ = true;
    filled_ns_ = now_ns;
    if (tokens > level_ / kNanosecondsInSecond) return false;
    level_ -= tokens * kNanosecondsInSecond;
    return true;
  }

 private:
  static constexpr std::uint64_t kNanosecondsInSecond = 1'000'000'000;

  void fill(std::uint64_t elapsed_ns) {
    const std::uint64_t missing = full_ - level_;
    const bool is_full = elapsed_ns > missing / per_s_;
    level_ = is_full ? full_ : level_ + elapsed_ns * per_s_;
  }

  std::uint64_t per_s_;
  std::uint64_t full_;  ///< In tokens times nanoseconds, so that no remainder is lost.
  std::uint64_t level_;
  std::int64_t filled_ns_ = 0;
  bool started_ = false;
};

/// So many acts within any span of a length, and no more.
class ActBudget {
 public:
  ActBudget(std::uint32_t acts_max, std::chrono::nanoseconds span)
      : acts_max_(acts_max), span_ns_(span.count()) {}

  /// False, and nothing has changed, where the budget is spent.
  [[nodiscard]] bool take(std::int64_t now_ns) {
    while (!acts_ns_.empty() && now_ns - acts_ns_.front() >= span_ns_) acts_ns_.pop_front();
    if (acts_ns_.size() >= acts_max_) return false;
    acts_ns_.push_back(now_ns);
    return true;
  }

 private:
  std::uint32_t acts_max_;
  std::int64_t span_ns_;
  std::deque<std::int64_t> acts_ns_;  ///< At most `acts_max_`.
};

}  // namespace cycloid::server
