#pragma once

#include <algorithm>
#include <cstdint>

namespace cycloid::server {

/// How fast something may go on average, and how much of it at once.
struct Rate {
  std::uint32_t per_s = 0;  ///< 0: no limit.
  std::uint32_t burst = 0;  ///< At least 1 where there is a limit.
  friend bool operator==(const Rate&, const Rate&) = default;
};

/// A token bucket, in integers: of any interval of t ns no more is taken than burst + rate * t, and
/// no less is granted, however often it is asked. A clock that goes back stands still.
class RefillBucket {
 public:
  RefillBucket(Rate rate, std::int64_t now_ns)
      : rate_(rate), level_(std::uint64_t{rate.burst} * kPerUnit), filled_ns_(now_ns) {}

  /// Whether `count` may go now; takes nothing.
  bool has(std::uint32_t count, std::int64_t now_ns) const {
    return rate_.per_s == 0 || std::uint64_t{count} * kPerUnit <= level_at(now_ns);
  }
  /// Whether `count` may go now, and then it has gone. Else nothing is taken.
  bool take(std::uint32_t count, std::int64_t now_ns) {
    if (!has(count, now_ns)) return false;
    if (rate_.per_s == 0) return true;
    level_ = level_at(now_ns) - std::uint64_t{count} * kPerUnit;
    filled_ns_ = std::max(filled_ns_, now_ns);
    return true;
  }
  /// Whether it is as good as a new one, so that forgetting it gives nothing away.
  bool full(std::int64_t now_ns) const {
    return rate_.per_s == 0 || level_at(now_ns) == capacity();
  }

 private:
  /// A level counts in 10^-9 of a unit, so that a nanosecond adds `per_s` exactly.
  static constexpr std::uint64_t kPerUnit = 1'000'000'000;

  std::uint64_t capacity() const { return std::uint64_t{rate_.burst} * kPerUnit; }
  std::uint64_t level_at(std::int64_t now_ns) const {
    if (now_ns <= filled_ns_) return level_;
    const auto elapsed_ns =
        static_cast<std::uint64_t>(now_ns) - static_cast<std::uint64_t>(filled_ns_);
    const std::uint64_t missing = capacity() - level_;
    // By division first: the product of a long time and a high rate does not fit.
    return elapsed_ns > missing / rate_.per_s ? capacity() : level_ + elapsed_ns * rate_.per_s;
  }

  Rate rate_;
  std::uint64_t level_;
  std::int64_t filled_ns_;
};

}  // namespace cycloid::server
