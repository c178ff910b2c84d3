#include "client/replica/evidence.hpp"

#include <algorithm>
#include <utility>

namespace cycloid::client {

void Evidence::leaving(const scenes::Simulation& confirmed, Outbox& out) {
  keep(confirmed);
  send_parts(out);
}

void Evidence::keep(const scenes::Simulation& confirmed) {
  const std::uint64_t tick = confirmed.tick();
  forget_from(tick);
  const std::size_t bytes = confirmed.encoded_bytes();
  while (!ring_.empty() &&
         (ring_.size() >= options_.ticks_max || bytes_ + bytes > options_.bytes_max)) {
    forget(std::move(ring_.front()));
    ring_.pop_front();
  }
  if (bytes > options_.bytes_max) return;
  Kept kept;
  if (!spare_.empty()) {
    kept = std::move(spare_.back());
    spare_.clear();
  }
  kept.tick = tick;
  kept.bytes = bytes;
  confirmed.save(kept.state);
  bytes_ += bytes;
  ring_.push_back(std::move(kept));
}

void Evidence::forget(Kept&& kept) {
  bytes_ -= kept.bytes;
  spare_.clear();
  spare_.push_back(std::move(kept));
}

const Evidence::Kept* Evidence::find(std::uint64_t tick) const {
  const auto found = std::ranges::find(ring_, tick, &Kept::tick);
  return found == ring_.end() ? nullptr : &*found;
}

void Evidence::replaced(const scenes::Simulation& simulation) {
  agreed_tick_ = simulation.tick();
  forget_from(agreed_tick_);
}

void Evidence::forget_from(std::uint64_t tick) {
  for (; !ring_.empty() && ring_.back().tick >= tick; ring_.pop_back())
    forget(std::move(ring_.back()));
}

void Evidence::diverged(std::uint64_t tick, Outbox& out) {
  // A gap (a snapshot that was further on) ends what can be told in one row.
  std::vector<const Kept*> row;
  for (auto kept = ring_.rbegin(); kept != ring_.rend(); ++kept) {
    if (kept->tick > tick) continue;
    if (kept->tick + row.size() != tick || kept->tick == 0) break;  // Tick 0 is the scene.
    row.push_back(&*kept);
    if (kept->tick <= agreed_tick_) break;
  }
  std::ranges::reverse(row);
  open_ = !row.empty();
  for (std::size_t i = 0; i < row.size(); i += protocol::kTickDigestsMax) {
    protocol::TickDigests digests{row[i]->tick, {}};
    const std::size_t end = std::min(row.size(), i + protocol::kTickDigestsMax);
    for (std::size_t j = i; j < end; ++j) digests.digests.push_back(row[j]->state.digest());
    out.emplace_back(std::move(digests));
  }
}

void Evidence::wanted(const protocol::StateWanted& wanted, Outbox&) {
  const Kept* kept = find(wanted.tick);
  if (!std::exchange(open_, false) || kept == nullptr) return;
  sending_tick_ = wanted.tick;
  sent_bytes_ = 0;
  kept->state.encode(sending_);
}

void Evidence::send_parts(Outbox& out) {
  for (std::size_t i = 0; i < options_.parts_per_tick && !sending_.empty(); ++i) {
    const std::size_t size = std::min(protocol::kStatePartBytesMax, sending_.size() - sent_bytes_);
    const auto* first = sending_.data() + sent_bytes_;
    out.emplace_back(protocol::StatePart{sending_tick_,
                                         static_cast<std::uint32_t>(sending_.size()),
                                         static_cast<std::uint32_t>(sent_bytes_),
                                         {first, first + size}});
    sent_bytes_ += size;
    if (sent_bytes_ == sending_.size()) sending_ = {};
  }
}

}  // namespace cycloid::client
