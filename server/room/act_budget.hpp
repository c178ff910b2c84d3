#pragma once

#include <chrono>
#include <cstdint>
#include <deque>

namespace cycloid::server {

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
  /// What was done before counts on.
  void set_bounds(std::uint32_t acts_max, std::chrono::nanoseconds span) {
    acts_max_ = acts_max;
    span_ns_ = span.count();
  }

 private:
  std::uint32_t acts_max_;
  std::int64_t span_ns_;
  std::deque<std::int64_t> acts_ns_;  ///< At most the largest `acts_max_` so far.
};

}  // namespace cycloid::server
