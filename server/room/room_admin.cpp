#include <utility>

#include "protocol/text.hpp"
#include "server/room/room.hpp"

namespace cycloid::server {

bool Room::kick(std::size_t seat, const std::string& reason) {
  if (state_ != RoomState::kRunning || seat >= seats_.size()) return false;
  const SeatHold& hold = seats_[seat];
  if (hold.state == SeatState::kHeld) return kick_peer(hold.holder, reason);
  if (hold.state == SeatState::kFree) return false;
  const bool lost = hold.state == SeatState::kLost;
  seats_.free(seat);
  tokens_.forget(seat);
  if (lost) events_.push_back({protocol::EventKind::kKick, static_cast<std::uint16_t>(seat)});
  notice(Notice::Kind::kAct,
         "seat " + std::to_string(seat) + " is freed: " + protocol::printable(reason));
  return true;
}

bool Room::kick_peer(PeerId id, const std::string& reason) {
  const auto found = peers_.find(id);
  if (found == peers_.end() || found->second.stage == PeerStage::kClosing) return false;
  refuse(id, found->second, protocol::Refusal::kKicked, reason, protocol::EventKind::kKick);
  return true;
}

void Room::lock(bool locked) {
  if (std::exchange(locked_, locked) == locked) return;
  notice(Notice::Kind::kAct, locked ? "the room is locked" : "the room is open");
}

bool Room::reserve(std::size_t seat, const std::string& identity, std::uint64_t ticks) {
  if (state_ != RoomState::kRunning || ticks == 0) return false;
  if (!seats_.reserve(seat, identity, simulation_.tick() + ticks)) return false;
  notice(Notice::Kind::kAct, "seat " + std::to_string(seat) + " is reserved for \"" +
                                 protocol::printable(identity) + "\" for " + std::to_string(ticks) +
                                 " ticks");
  return true;
}

void Room::pause(const std::string& reason) {
  if (state_ != RoomState::kRunning || pacer_.paused()) return;
  pacer_.pause(hooks_.now_ns());
  const std::string text = "the match stands still" + (reason.empty() ? "" : ": " + reason);
  notice(Notice::Kind::kAct, protocol::printable(text));
  tell_all(protocol::NoticeKind::kSlowed, statistics_.slowed_ns / 1'000'000, text);
}

void Room::resume() {
  if (!pacer_.paused()) return;
  const std::int64_t now = hooks_.now_ns();
  statistics_.slowed_ns += static_cast<std::uint64_t>(pacer_.resume(now));
  for (auto& [id, peer] : peers_) peer.heard_ns = now;
  notice(Notice::Kind::kAct, "the match goes on");
  tell_all(protocol::NoticeKind::kSlowed, statistics_.slowed_ns / 1'000'000, "the match goes on");
}

void Room::set_limits(const Limits& limits) {
  options_.limits = at_tick_rate(options_.tick_rate_millihertz, limits);
  const std::int64_t now = hooks_.now_ns();
  for (auto& [id, peer] : peers_) peer.set_limits(options_.limits, now);
}

void Room::announce_drain(std::chrono::milliseconds within, const std::string& reason) {
  if (state_ != RoomState::kRunning) return;
  tell_all(protocol::NoticeKind::kDraining, static_cast<std::uint64_t>(within.count()), reason);
}

void Room::encode_state(std::vector<std::byte>& into) {
  into = states_.of(simulation_, digest_)->bytes();
}

}  // namespace cycloid::server
