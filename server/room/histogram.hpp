#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace cycloid::server {

/// Counts of durations in buckets that are at most 1/8 wide: quantiles of any number of values in
/// 4 KiB.
class Histogram {
 public:
  void add(std::uint64_t value) {
    ++counts_[bucket(value)];
    ++total_;
  }

  /// An upper bound of the value that a share of `per_mille` do not exceed; 0 if there is none.
  std::uint64_t quantile(std::uint64_t per_mille) const {
    const std::uint64_t wanted = (total_ * per_mille + 999) / 1000;
    std::uint64_t seen = 0;
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      seen += counts_[i];
      if (seen >= wanted && seen != 0) return upper(i);
    }
    return 0;
  }

 private:
  static constexpr std::size_t kPerDouble = 8;

  static std::size_t bucket(std::uint64_t value) {
    if (value < kPerDouble) return value;
    const auto shift = static_cast<std::size_t>(std::bit_width(value)) - 4;
    return kPerDouble * shift + static_cast<std::size_t>(value >> shift);
  }
  static std::uint64_t upper(std::size_t i) {
    if (i < 2 * kPerDouble) return i;
    const std::size_t shift = i / kPerDouble - 1;
    return ((i % kPerDouble + kPerDouble + 1) << shift) - 1;
  }

  std::array<std::uint64_t, 62 * kPerDouble> counts_{};
  std::uint64_t total_ = 0;
};

}  // namespace cycloid::server
