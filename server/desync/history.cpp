#include "server/desync/history.hpp"

#include <algorithm>
#include <utility>

namespace cycloid::server {

void History::start(const scenes::Simulation& simulation) {
  ticks_.clear();
  states_.clear();
  bytes_ = 0;
  last_tick_ = simulation.tick();
  keep(simulation, simulation.digest());
}

void History::add(const protocol::InputFrame& frame, std::uint64_t digest,
                  const scenes::Simulation& simulation) {
  last_tick_ = frame.tick;
  ticks_.push_back({frame, digest});
  if (ticks_.size() > options_.ticks_max) ticks_.pop_front();
  // A state whose next frame is gone leads nowhere.
  while (states_.size() > 1 && states_.front().tick + 1 < ticks_.front().frame.tick) {
    bytes_ -= states_.front().state->size();
    states_.pop_front();
  }
  if (frame.tick % options_.state_ticks == 0) keep(simulation, digest);
}

void History::keep(const scenes::Simulation& simulation, std::uint64_t digest) {
  std::vector<std::byte> state;
  simulation.encode(state);
  bytes_ += state.size();
  states_.push_back({simulation.tick(), digest,
                     std::make_shared<const std::vector<std::byte>>(std::move(state))});
  while (states_.size() > 1 && bytes_ > options_.bytes_max) {
    bytes_ -= states_.front().state->size();
    states_.pop_front();
  }
}

std::optional<std::uint64_t> History::digest(std::uint64_t tick) const {
  if (!states_.empty() && states_.front().tick == tick) return states_.front().digest;
  if (ticks_.empty() || tick < ticks_.front().frame.tick) return std::nullopt;
  const auto at = static_cast<std::size_t>(tick - ticks_.front().frame.tick);
  if (at >= ticks_.size()) return std::nullopt;
  return ticks_[at].digest;
}

std::optional<KeptState> History::before(std::uint64_t tick) const {
  const auto found = std::find_if(states_.rbegin(), states_.rend(),
                                  [&](const KeptState& kept) { return kept.tick < tick; });
  return found == states_.rend() ? std::nullopt : std::optional(*found);
}

std::optional<KeptState> History::from(std::uint64_t tick) const {
  const auto found =
      std::ranges::find_if(states_, [&](const KeptState& kept) { return kept.tick >= tick; });
  return found == states_.end() ? std::nullopt : std::optional(*found);
}

std::vector<protocol::LogTick> History::ticks(std::uint64_t first, std::uint64_t last) const {
  std::vector<protocol::LogTick> found;
  for (const protocol::LogTick& tick : ticks_)
    if (tick.frame.tick >= first && tick.frame.tick <= last) found.push_back(tick);
  return found;
}

}  // namespace cycloid::server
