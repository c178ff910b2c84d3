#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "protocol/messages.hpp"

namespace cycloid::server {

/// How the inputs of one seat come in, for its client to steer its lead by.
class MarginMeter {
 public:
  static constexpr std::uint64_t kEveryTicks = 6;

  /// An input that came so many ticks before its tick was to be closed; negative: so many too late.
  /// It may be taken all the same, where the tick has waited for it.
  void on_input(std::int32_t early_ticks, bool taken) {
    worst_ = worst_ ? std::min(*worst_, early_ticks) : early_ticks;
    if (taken) ++merged_;
  }
  void on_missed() { ++missed_; }

  /// What to tell after `tick`: at most once in six ticks, or when something was missed or late;
  /// nothing where nothing came and nothing was missed.
  std::optional<protocol::Margin> take(std::uint64_t tick) {
    if (!worst_ && missed_ == 0) return std::nullopt;
    const bool in_time = missed_ == 0 && *worst_ >= 0;
    if (in_time && tick - told_tick_ < kEveryTicks) return std::nullopt;
    const protocol::Margin margin{tick, worst_.value_or(0), merged_, missed_};
    *this = MarginMeter();
    told_tick_ = tick;
    return margin;
  }

 private:
  std::optional<std::int32_t> worst_;
  std::uint32_t merged_ = 0;
  std::uint32_t missed_ = 0;
  std::uint64_t told_tick_ = 0;
};

}  // namespace cycloid::server
