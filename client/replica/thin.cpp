#include "client/replica/thin.hpp"

#include <algorithm>
#include <utility>

#include "protocol/state/exact_delta.hpp"

namespace cycloid::client {

static protocol::ReceivedLimits limits_of(const FollowerOptions& options) {
  protocol::ReceivedLimits limits;
  limits.states_max = Thin::kBaselinesMax;
  limits.held_bytes_max = options.baselines_bytes_max;
  limits.exact_bytes_max = options.snapshot_bytes_max;
  return limits;
}

Thin::Thin(scenes::Simulation simulation, FollowerOptions options)
    : Follower(protocol::Mode::kSnapshot, std::move(simulation), std::move(options)),
      states_(Follower::options().profile, limits_of(Follower::options())) {}

std::vector<scenes::Pose> Thin::poses() const {
  if (!quantised_) return simulation_.poses();
  const protocol::QuantisedState& state = states_.empty() ? before_rewind_ : states_.quantised();
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
  if (!load(state.tick, state.digest, state.state)) return;
  quantised_ = false;
  // Deltas go on from it in the profile that was asked for.
  const bool exact = options().profile == protocol::Profile::kExact;
  if (exact) states_.hold(state.tick, state.state, {});
  if (!exact) states_.hold(state.tick, {}, protocol::capture(simulation_));
  took(state.tick, interval, out);
}

/// A whole exact state, which a client of either profile may be sent.
void Thin::take_exact(const protocol::StateDelta& delta, Outbox& out) {
  auto state = protocol::decode_exact_delta({}, delta.bytes, options().snapshot_bytes_max);
  if (state) return on_exact({delta.tick, delta.digest, std::move(*state)}, out);
  fail("the state of tick " + std::to_string(delta.tick) + " is corrupt");
}

void Thin::on_delta(const protocol::StateDelta& delta, Outbox& out) {
  if (!is_newer(delta.tick)) return;
  const bool exact = delta.profile == protocol::Profile::kExact;
  if (exact && delta.baseline_tick == 0) return take_exact(delta, out);
  if (delta.baseline_tick != 0 && !states_.holds(delta.baseline_tick)) {
    ++progress_.deltas_dropped;
    return;
  }
  const std::uint64_t interval = loading() ? 1 : delta.tick - progress_.last_tick;
  if (const std::string wrong = states_.take(delta); !wrong.empty()) {
    return fail("the delta of tick " + std::to_string(delta.tick) + " is corrupt: " + wrong);
  }
  if (exact && !load(delta.tick, delta.digest, states_.exact())) return;
  if (!exact) loaded(delta.tick);
  quantised_ = !exact;
  quantised_digest_ = delta.digest;
  took(delta.tick, interval, out);
}

/// Acknowledges a state, and sends the inputs of the interval since the one before.
void Thin::took(std::uint64_t tick, std::uint64_t interval, Outbox& out) {
  out.emplace_back(protocol::Ack{tick});
  const std::uint64_t most = std::clamp<std::uint64_t>(interval, 1, kIntervalTicksMax);
  send_inputs(tick + lead() + most - 1, most + 3, out);
}

/// What was shown last is shown until the exact state comes, which may take parts.
void Thin::on_rewound(std::uint64_t) {
  if (quantised_ && !states_.empty()) before_rewind_ = states_.quantised();
  states_.forget_all();
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
