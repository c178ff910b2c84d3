#include "client/replica/thin.hpp"

#include <algorithm>
#include <utility>

namespace cycloid::client {

Thin::Thin(scenes::Simulation simulation, FollowerOptions options)
    : Follower(protocol::Mode::kSnapshot, std::move(simulation), std::move(options)) {}

std::vector<scenes::Pose> Thin::poses() const {
  if (!quantised_) return simulation_.poses();
  const protocol::QuantisedState& state = baselines_.back().quantised;
  std::vector<scenes::Pose> poses;
  for (const protocol::QuantisedBody& body : state.bodies) {
    poses.push_back(protocol::pose_of(body, state.dimension));
  }
  return poses;
}

std::uint64_t Thin::digest() const {
  return quantised_ ? quantised_digest_ : simulation_.digest();
}

bool Thin::is_newer(std::uint64_t tick) {
  if (loading() || tick >= progress_.last_tick) return true;
  fail("the state of tick " + std::to_string(tick) + " is older than the state, of tick " +
       std::to_string(progress_.last_tick));
  return false;
}

void Thin::on_exact(const protocol::Snapshot& state, Outbox& out) {
  if (!is_newer(state.tick)) return;
  const std::uint64_t interval = loading() ? 1 : state.tick - progress_.last_tick;
  if (!load(state)) return;
  quantised_ = false;
  DecodedState whole;
  whole.tick = state.tick;
  // Deltas go on from it in the profile that was asked for.
  const bool exact = options().profile == protocol::Profile::kExact;
  if (exact) whole.exact = state.state;
  if (!exact) whole.quantised = protocol::capture(simulation_);
  keep(std::move(whole), out);
  const std::uint64_t most = std::clamp<std::uint64_t>(interval, 1, kIntervalTicksMax);
  send_inputs(state.tick + lead() + most - 1, most + 3, out);
}

const DecodedState* Thin::find_baseline(std::uint64_t tick) const {
  for (const DecodedState& state : baselines_)
    if (state.tick == tick) return &state;
  return nullptr;
}

void Thin::on_delta(const protocol::StateDelta& delta, Outbox& out) {
  const std::string name = "the delta of tick " + std::to_string(delta.tick);
  if (!is_newer(delta.tick)) return;
  const DecodedState* baseline = find_baseline(delta.baseline_tick);
  const bool whole = delta.baseline_tick == 0;
  if (!whole && baseline == nullptr) {
    ++progress_.deltas_dropped;
    return;
  }
  DecodedState state;
  const std::string wrong = options().decoder->decode(delta, whole ? nullptr : baseline, state);
  if (!wrong.empty()) return fail(name + " is corrupt: " + wrong);
  // The server builds on what it knows to be here: what is older than that it has let go.
  while (!baselines_.empty() && baselines_.front().tick < delta.baseline_tick) {
    baselines_.pop_front();
  }
  if (delta.profile == protocol::Profile::kExact) {
    return on_exact({delta.tick, delta.digest, std::move(state.exact)}, out);
  }
  const std::uint64_t interval = loading() ? 1 : delta.tick - progress_.last_tick;
  state.tick = delta.tick;
  loaded(delta.tick);
  quantised_ = true;
  quantised_digest_ = delta.digest;
  keep(std::move(state), out);
  const std::uint64_t most = std::clamp<std::uint64_t>(interval, 1, kIntervalTicksMax);
  send_inputs(delta.tick + lead() + most - 1, most + 3, out);
}

void Thin::keep(DecodedState state, Outbox& out) {
  out.emplace_back(protocol::Ack{state.tick});
  if (!baselines_.empty() && baselines_.back().tick == state.tick) baselines_.pop_back();
  // The first one is what the server builds on now; the others it may choose.
  if (baselines_.size() >= kBaselinesMax) baselines_.erase(baselines_.begin() + 1);
  baselines_.push_back(std::move(state));
}

void Thin::on_rewound(std::uint64_t) {
  baselines_.clear();
  quantised_ = false;
}

void Thin::on_frame(const protocol::InputFrame& frame, Outbox&) {
  take_frame(frame);
}

void Thin::on_digest(const protocol::Digest& digest, Outbox&) {
  // Only the held state can be compared, and only where it is exact.
  if (loading() || quantised_ || digest.tick != simulation_.tick()) return;
  ++progress_.digests_compared;
  if (digest.digest != simulation_.digest()) ++progress_.mismatches;
}

}  // namespace cycloid::client
