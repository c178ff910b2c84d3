#include <algorithm>
#include <utility>

#include "server/room/room.hpp"

namespace cycloid::server {
namespace {

/// Digests of the server that a client may still answer: at the default interval one minute of
/// ticks. A later answer is not compared.
constexpr std::size_t kDigestsKept = 64;

void append(const protocol::ServerMessage& message, protocol::Bytes& into) {
  const protocol::Bytes bytes = protocol::encode(message);
  into.insert(into.end(), bytes.begin(), bytes.end());
}

}  // namespace

void Room::advance() {
  if (state_ != RoomState::kRunning) return;
  close_overdue();
  const std::int64_t begin = hooks_.now_ns();
  const std::int64_t tick_ns = schedule_.deadline_ns(1) - schedule_.deadline_ns(0);
  for (std::uint32_t made = 0; state_ == RoomState::kRunning; ++made) {
    const std::int64_t now = hooks_.now_ns();
    const bool out_of_time = made > 0 && now - begin >= tick_ns;
    if (now < next_deadline_ns()) return;
    if (made == options_.limits.catch_up_ticks_max || out_of_time) break;
    make_tick();
  }
  if (state_ == RoomState::kRunning) slow_down(tick_ns);
}

void Room::make_tick() {
  const std::int64_t begin = hooks_.now_ns();
  statistics_.lateness_ns.add(static_cast<std::uint64_t>(begin - next_deadline_ns()));
  const protocol::InputFrame frame = close_frame();
  std::vector<scenes::SeatInput> inputs;
  for (const protocol::SeatFrame& seat : frame.seats) inputs.push_back(seat.input);
  const solver::Error error = simulation_.step(inputs);
  if (!error.ok()) return fault(frame, error);
  digest_ = simulation_.digest();
  // The log's record holds the digest, so it can only be made here; but no client has heard yet.
  if (hooks_.log != nullptr) hooks_.log->tick({frame, digest_});
  publish(frame);
  const auto took = static_cast<std::uint64_t>(hooks_.now_ns() - begin);
  statistics_.worst_tick_ns = std::max(statistics_.worst_tick_ns, took);

  for (auto& [id, peer] : peers_) {
    peer.messages = 0;
    process(id, peer);  // What was too much for the tick before.
  }
  check_log();
  if (state_ == RoomState::kRunning && simulation_.tick() == options_.ticks) {
    end(RoomState::kTicksDone, "all " + std::to_string(options_.ticks) + " ticks are made");
  }
}

protocol::InputFrame Room::close_frame() {
  protocol::InputFrame frame;
  frame.tick = simulation_.tick() + 1;
  for (Seat& seat : seats_) frame.seats.push_back(seat.close(frame.tick));
  frame.events = std::exchange(events_, {});
  return frame;
}

void Room::publish(const protocol::InputFrame& frame) {
  const Limits& limits = options_.limits;
  protocol::Bytes bytes = protocol::encode(protocol::ServerMessage(frame));
  if (frame.tick % limits.digest_ticks == 0) {
    digests_.push_back({frame.tick, digest_});
    if (digests_.size() > kDigestsKept) digests_.pop_front();
    append(protocol::Digest{frame.tick, digest_}, bytes);
  }
  const auto said = std::make_shared<const protocol::Bytes>(std::move(bytes));
  for (auto& [id, peer] : peers_) {
    if (peer.stage != Stage::kPlaying) continue;
    if (peer.mode == protocol::Mode::kSnapshot) {
      if (frame.tick % limits.snapshot_ticks == 0) peer.outbox.replace_snapshot(exact_snapshot());
    } else if (!peer.outbox.push(said)) {
      refuse(id, peer, protocol::Refusal::kTooSlow,
             "more than " + std::to_string(limits.queue_bytes_max) + " bytes wait for it");
    }
  }
}

void Room::fault(const protocol::InputFrame& frame, const solver::Error& error) {
  std::string where = std::string(solver::code_name(error.code)) + " " + error.field;
  if (const auto fault = simulation_.fault()) {
    where = solver::fault_field_name(fault->field);
    if (fault->body.index != solver::kNone) {
      where += " of body " + std::to_string(fault->body.index);
    }
  }
  const std::string reason =
      "the world faulted at tick " + std::to_string(frame.tick) + ": " + where;
  notice(Notice::Kind::kFault, reason);
  end(RoomState::kFaulted, reason);
}

void Room::check_log() {
  if (hooks_.log == nullptr || hooks_.log->durable() || log_noticed_) return;
  log_noticed_ = true;
  const std::string reason = "the log has ended: " + hooks_.log->error();
  notice(Notice::Kind::kLog, reason + "; the match is not durable from here on");
  if (options_.stop_on_log_error && state_ == RoomState::kRunning) {
    end(RoomState::kLogFailed, reason);
  }
}

void Room::slow_down(std::int64_t tick_ns) {
  const std::int64_t behind = hooks_.now_ns() - next_deadline_ns();
  if (behind <= tick_ns * static_cast<std::int64_t>(options_.limits.catch_up_ticks_max)) return;
  schedule_.delay(behind);
  statistics_.slowed_ns += static_cast<std::uint64_t>(behind);
  const bool slow_steps = std::cmp_greater(statistics_.worst_tick_ns, tick_ns);
  bool& noticed = slow_steps ? slow_steps_noticed_ : stall_noticed_;
  if (std::exchange(noticed, true)) return;
  notice(Notice::Kind::kOverload,
         std::string(slow_steps ? "a tick takes longer than it lasts" : "the process was not run") +
             ": the match is slowed by " + std::to_string(behind / 1'000'000) + " ms at tick " +
             std::to_string(simulation_.tick()) + "; said once, and counted");
}

Shared Room::exact_snapshot() {
  if (snapshot_ && snapshot_tick_ == simulation_.tick()) return snapshot_;
  protocol::Snapshot snapshot{simulation_.tick(), digest_, {}};
  simulation_.encode(snapshot.state);
  snapshot_ = std::make_shared<const protocol::Bytes>(
      protocol::encode(protocol::ServerMessage(std::move(snapshot))));
  snapshot_tick_ = simulation_.tick();
  return snapshot_;
}

}  // namespace cycloid::server
