#include "server/room/snapshot_feed.hpp"

#include "protocol/state/exact_delta.hpp"

namespace cycloid::server {
namespace {

protocol::FeedOptions options_of(protocol::Profile profile, const SnapshotFeedLimits& limits) {
  protocol::FeedOptions options;
  options.profile = profile;
  options.budget_bytes = limits.delta_bytes_max;
  options.history = {limits.baseline_ticks_max, limits.baseline_bytes_max};
  return options;
}

Shared encoded(protocol::ServerMessage message) {
  return std::make_shared<const protocol::Bytes>(protocol::encode(message));
}

}  // namespace

SnapshotFeed::SnapshotFeed(const SnapshotFeedLimits& limits)
    : exact_(options_of(protocol::Profile::kExact, limits)),
      quantised_(options_of(protocol::Profile::kQuantised, limits)) {}

void SnapshotFeed::Channel::advance(const scenes::Simulation& simulation, std::uint64_t digest) {
  if (has_tick && tick == simulation.tick()) return;
  has_tick = true;
  tick = simulation.tick();
  made.clear();
  states.advance(simulation, digest);
}

Shared SnapshotFeed::message(protocol::Profile profile, protocol::SentStates& sent, bool speaks,
                             const scenes::Simulation& simulation, std::uint64_t digest) {
  Channel& from = channel(profile);
  from.advance(simulation, digest);
  const auto delta = from.states.delta(sent.baseline());
  // What it was sent since may show something else, unless it has said that it has all of it.
  if (!delta->changes && sent.unanswered() == 0 && !speaks) return nullptr;
  sent.sent(delta->held);
  Made& made = from.made[delta.get()];
  if (!made.bytes) made = {delta, encoded(delta->message)};
  return made.bytes;
}

void SnapshotFeed::hold(protocol::Profile profile, protocol::SentStates& sent,
                        const scenes::Simulation& simulation, std::uint64_t digest) {
  Channel& from = channel(profile);
  from.advance(simulation, digest);
  sent.sent(from.states.now());
}

void SnapshotFeed::forget_all() {
  for (Channel* each : {&exact_, &quantised_}) {
    each->states.forget_all();
    each->made.clear();
    each->has_tick = false;
  }
}

std::uint64_t SnapshotFeed::encodes() const {
  return exact_.states.encodes() + quantised_.states.encodes();
}

Shared whole_state_delta(const ExactState& state) {
  protocol::StateDelta delta;
  delta.tick = state.tick();
  delta.digest = state.digest();
  // An encoding that this process has made is canonical.
  (void)protocol::encode_exact_delta({}, state.bytes(), delta.bytes);
  return encoded(std::move(delta));
}

}  // namespace cycloid::server
