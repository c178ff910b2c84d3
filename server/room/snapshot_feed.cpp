#include "server/room/snapshot_feed.hpp"

#include <algorithm>

namespace cycloid::server {

ProfiledState FullStateCoder::capture(protocol::Profile, const scenes::Simulation&,
                                      const ExactState& state) const {
  return {state.tick(), state.digest(), state.bytes()};
}

std::optional<protocol::Bytes> FullStateCoder::delta(protocol::Profile,
                                                     const ProfiledState* baseline,
                                                     const ProfiledState& now) const {
  if (baseline != nullptr) return std::nullopt;
  return now.bytes;
}

const SnapshotFeed::Kept* SnapshotFeed::find(protocol::Profile profile, std::uint64_t tick) const {
  const auto found = std::ranges::find_if(
      kept_, [&](const Kept& kept) { return kept.profile == profile && kept.state.tick == tick; });
  return found == kept_.end() ? nullptr : &*found;
}

void SnapshotFeed::keep(protocol::Profile profile, const scenes::Simulation& simulation,
                        const ExactState& state) {
  if (find(profile, state.tick()) != nullptr) return;
  kept_.push_back({profile, coder_.capture(profile, simulation, state)});
  bytes_ += kept_.back().state.bytes.size();
  evict(state.tick());
}

void SnapshotFeed::evict(std::uint64_t now_tick) {
  // The newest tick stays, or there would be nothing to send.
  while (kept_.front().state.tick < now_tick &&
         (bytes_ > bytes_max_ || now_tick - kept_.front().state.tick > kept_ticks_)) {
    bytes_ -= kept_.front().state.bytes.size();
    kept_.pop_front();
  }
}

Shared SnapshotFeed::message(protocol::Profile profile, std::uint64_t baseline_tick,
                             const scenes::Simulation& simulation, const ExactState& state) {
  if (made_tick_ != state.tick()) made_.clear();
  made_tick_ = state.tick();
  keep(profile, simulation, state);
  const Kept* baseline = nullptr;
  if (baseline_tick != 0 && baseline_tick < state.tick()) baseline = find(profile, baseline_tick);
  Shared& made = made_[{profile, baseline == nullptr ? 0 : baseline_tick}];
  if (made) return made;

  const ProfiledState& now = find(profile, state.tick())->state;
  std::optional<protocol::Bytes> bytes;
  if (baseline != nullptr) bytes = coder_.delta(profile, &baseline->state, now);
  const bool whole = !bytes;
  if (whole) bytes = coder_.delta(profile, nullptr, now);
  ++encodes_;
  protocol::StateDelta delta;
  delta.tick = now.tick;
  delta.baseline_tick = whole ? 0 : baseline_tick;
  delta.digest = now.digest;
  delta.profile = profile;
  delta.bytes = std::move(*bytes);
  made = std::make_shared<const protocol::Bytes>(
      protocol::encode(protocol::ServerMessage(std::move(delta))));
  return made;
}

void SnapshotFeed::forget_all() {
  kept_.clear();
  made_.clear();
  bytes_ = 0;
  made_tick_ = 0;
}

}  // namespace cycloid::server
