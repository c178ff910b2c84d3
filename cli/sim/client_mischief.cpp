#include <bit>
#include <utility>
#include <variant>

#include "cli/sim/client.hpp"

namespace cycloid::sim {
namespace {

/// In which stretch of a connection's life its mischief begins.
constexpr std::int64_t kMischiefNs = 5 * kSecond;

}  // namespace

void SimClient::draw_mischief() {
  mischief_ = {};
  if (chronicle_->quiet) return;
  const ClientSettings& client = settings_->client;
  const auto draw = [&](std::uint32_t per_million) {
    const std::int64_t at = chronicle_->now_ns + random_.between(0, kMischiefNs);
    return random_.chance(per_million) ? at : kNever;
  };
  mischief_.zero_window_ns = draw(client.zero_window_per_million);
  mischief_.zero_window_until_ns = mischief_.zero_window_ns;
  if (mischief_.zero_window_ns != kNever) {
    mischief_.zero_window_until_ns += random_.between(0, client.zero_window_max_ns);
  }
  mischief_.half_close_ns = draw(client.half_close_per_million);
  mischief_.leave_ns = draw(client.leave_per_million);
  mischief_.duplicate_ns = draw(client.duplicate_per_million);
  mischief_.desync_ns = lockstep() ? draw(client.desync_per_million) : kNever;
}

void SimClient::make_mischief() {
  const std::int64_t now = chronicle_->now_ns;
  const bool running = follower_->progress().phase == client::Phase::kRunning;
  if (now >= mischief_.desync_ns && running && !observer_->disturbed()) disturb();
  if (now >= mischief_.half_close_ns) {
    mischief_.half_close_ns = kNever;
    wire_->up.finish();
    chronicle_->count(Event::kHalfClose);
    chronicle_->note(persona_.name + " closes its half");
  }
  if (now >= mischief_.duplicate_ns) {
    chronicle_->count(Event::kDuplicate);
    chronicle_->note(persona_.name + " connects a second time");
    ghosts_.push_back(std::exchange(wire_, nullptr));
    dial_at_ns_ = 0;
    return;
  }
  if (now < mischief_.leave_ns || !running) return;
  mischief_.leave_ns = kNever;
  chronicle_->count(Event::kLeave);
  ticket_ = {};
  outbox_.emplace_back(protocol::Bye{"enough"});
  send();
  finish("leaves");
}

void SimClient::disturb() {
  mischief_.desync_ns = kNever;
  scenes::Simulation& mine = follower_->simulation();
  const std::uint64_t before = mine.digest();
  // The lowest bit of one velocity, of a body that can move.
  const auto flip = [&](auto& world) {
    auto state = world.state();
    for (std::size_t i = 0; i < state.bodies.size(); ++i) {
      if (state.bodies[i].inverse_mass == 0.0f) continue;
      float& speed = state.bodies.moved(i).velocity[0];
      speed = std::bit_cast<float>(std::bit_cast<std::uint32_t>(speed) ^ 1u);
      break;
    }
    world.restore(state);
  };
  if (auto* planar = mine.planar()) flip(*planar);
  if (auto* spatial = mine.spatial()) flip(*spatial);
  if (mine.digest() == before) return;
  observer_->disturb();
  host_->room(persona_.room).excuse_desyncs();
  chronicle_->count(Event::kDesync);
  chronicle_->note(persona_.name + " has one bit wrong");
}

void SimClient::take_planted(protocol::ServerMessage message) {
  constexpr std::uint64_t kSkipped = 20;
  auto* frame = std::get_if<protocol::InputFrame>(&message);
  const client::Progress& progress = follower_->progress();
  if (frame != nullptr && planted(Plant::kClientSkipsFrame) &&
      frame->tick == progress.first_tick + kSkipped) {
    return;
  }
  if (frame != nullptr && planted(Plant::kClientAppliesLateInput) && progress.seat >= 0) {
    protocol::SeatFrame& mine = frame->seats[static_cast<std::size_t>(progress.seat)];
    if (mine.origin != protocol::Origin::kGiven) {
      mine.input = honest_input(settings_->seed, progress.seat, frame->tick);
    }
  }
  const std::uint64_t snapshots = progress.snapshots;
  follower_->receive(message, outbox_);
  if (planted(Plant::kSnapshotWithoutImpulses) && progress.snapshots != snapshots) {
    forget_impulses(follower_->simulation());
  }
  if (frame == nullptr || !planted(Plant::kClientComparesUnconfirmed) || !lockstep()) return;
  guess_.clear();
  for (const protocol::SeatFrame& seat : frame->seats) guess_.push_back(seat.input);
  compare_unconfirmed(frame->tick + 1);
}

/// Steps on as it believes that the next tick will be, and tells the server the digest of that.
void SimClient::compare_unconfirmed(std::uint64_t tick) {
  scenes::Simulation& mine = follower_->simulation();
  if (tick % settings_->limits.digest_ticks != 0 || mine.tick() + 1 != tick) return;
  scenes::Simulation::Saved saved;
  mine.save(saved);
  if (mine.step(guess_).ok()) outbox_.emplace_back(protocol::Digest{tick, mine.digest()});
  mine.restore(saved);
}

}  // namespace cycloid::sim
