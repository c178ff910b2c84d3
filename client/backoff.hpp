#pragma once

#include <algorithm>
#include <chrono>
#include <cstdint>

namespace cycloid::client {

/// How to come back after a connection broke.
struct ReconnectOptions {
  bool on = false;
  std::chrono::milliseconds first{100};  ///< Longest wait before the first try.
  /// No wait is longer, however often it failed; a connection that has worked for so long makes
  /// the next wait a first one.
  std::chrono::milliseconds longest{5000};
  std::chrono::milliseconds deadline{60000};  ///< From the break; then it gives up.
  std::uint64_t seed = 0;  ///< Of the jitter: unequal for clients that lose one server at once.
  /// Join as somebody new where the server no longer knows the seat's resume token.
  bool fresh_join = true;
};

/// Waits that double, each cut by up to a half at random, so that many clients do not come at once.
class Backoff {
 public:
  Backoff(std::chrono::milliseconds first, std::chrono::milliseconds longest, std::uint64_t seed)
      : first_(first), longest_(longest), wait_(first), random_(seed) {}

  /// The wait before the next try: from half to all of min(first * 2^tries, longest).
  std::chrono::milliseconds next() {
    const std::int64_t whole = std::max<std::int64_t>(1, std::min(wait_, longest_).count());
    wait_ = std::min(longest_, 2 * std::min(wait_, longest_));
    const auto half = static_cast<std::uint64_t>(whole / 2);
    return std::chrono::milliseconds(whole - static_cast<std::int64_t>(random() % (half + 1)));
  }
  /// It worked: the next wait is a first one.
  void reset() { wait_ = first_; }

 private:
  /// SplitMix64. Source: Steele, Lea, Flood, "Fast splittable pseudorandom number generators",
  /// 2014.
  std::uint64_t random() {
    random_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = random_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }

  std::chrono::milliseconds first_;
  std::chrono::milliseconds longest_;
  std::chrono::milliseconds wait_;
  std::uint64_t random_;
};

}  // namespace cycloid::client
