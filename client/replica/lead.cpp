#include "client/replica/lead.hpp"

#include <algorithm>

namespace cycloid::client {

void LeadController::start(std::uint64_t tick, std::uint32_t delay_ticks) {
  delay_ = delay_ticks;
  lead_ = std::clamp(delay_ticks, 1u, kLeadTicksMax);
  margin_tick_ = settles_tick_ = tick;
  watch_ticks_ = kWatchTicksMin;
  watching_ = lowered_ = false;
}

void LeadController::change_delay(std::uint32_t delay_ticks, std::uint64_t sent_tick) {
  const std::int64_t by = std::int64_t{delay_ticks} - std::int64_t{delay_};
  delay_ = delay_ticks;
  if (by != 0) move(by, sent_tick + static_cast<std::uint64_t>(std::max<std::int64_t>(by, 0)));
}

void LeadController::take(const protocol::Margin& margin, std::uint64_t sent_tick) {
  const bool settled = margin_tick_ >= settles_tick_;
  margin_tick_ = margin.tick;
  const bool came = margin.merged != 0 || margin.early_ticks < 0;
  if (!settled || !came || sent_tick == 0) return;

  // A wrong server cannot ask for more than there is.
  const auto most = static_cast<std::int32_t>(kLeadTicksMax);
  const std::int32_t early = std::clamp(margin.early_ticks, -most, most);
  if (early < 1) {
    const std::int32_t by = kEarlyTicksWanted - early;
    const std::int32_t late = std::max(0, -early);
    if (lowered_) watch_ticks_ = std::min(kWatchTicksMax, 2 * watch_ticks_);
    lowered_ = false;
    // What is sent in one burst to make up for the raise is late too, in part.
    return move(by, sent_tick + static_cast<std::uint64_t>(by + late));
  }
  if (!watching_) {
    watching_ = true;
    watch_begin_ = margin.tick;
    watch_worst_ = early;
  }
  watch_worst_ = std::min(watch_worst_, early);
  if (margin.tick - watch_begin_ < watch_ticks_) return;
  watching_ = false;
  if (watch_worst_ <= kEarlyTicksWanted) return;
  lowered_ = true;
  move(std::int64_t{kEarlyTicksWanted} - watch_worst_, sent_tick);
}

void LeadController::move(std::int64_t by_ticks, std::uint64_t settles_tick) {
  const std::int64_t wanted = std::int64_t{lead_} + by_ticks;
  const std::int64_t lead = std::clamp<std::int64_t>(wanted, 1, kLeadTicksMax);
  if (lead != std::int64_t{lead_}) ++changes_;
  lead_ = static_cast<std::uint32_t>(lead);
  settles_tick_ = settles_tick;
  watching_ = false;
}

}  // namespace cycloid::client
