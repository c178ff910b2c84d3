#include "client/replica/thin.hpp"

#include <algorithm>
#include <utility>

namespace cycloid::client {

Thin::Thin(scenes::Simulation simulation, FollowerOptions options)
    : Follower(protocol::Mode::kSnapshot, std::move(simulation), std::move(options)) {}

void Thin::on_snapshot(const protocol::Snapshot& snapshot, Outbox& out) {
  const bool first = progress_.phase == Phase::kLoading;
  const std::uint64_t before = progress_.last_tick;
  if (!load(snapshot)) return;
  const std::uint64_t interval = first ? 1 : snapshot.tick - before;
  send_inputs(snapshot.tick + input_delay() + std::min(interval, kIntervalTicksMax) - 1, out);
}

void Thin::on_frame(const protocol::InputFrame& frame, Outbox&) {
  if (check_frame(frame)) count_frame(frame);
}

void Thin::on_digest(const protocol::Digest& digest, Outbox&) {
  if (digest.tick != simulation_.tick()) return;  // Only the held state can be compared.
  ++progress_.digests_compared;
  if (digest.digest != simulation_.digest()) ++progress_.mismatches;
}

}  // namespace cycloid::client
