#include <algorithm>
#include <utility>

#include "protocol/overloaded.hpp"
#include "server/room/room.hpp"
#include "server/room/wrong_size.hpp"

namespace cycloid::server {
void Room::receive(PeerId id, std::span<const std::byte> bytes) {
  const auto found = peers_.find(id);
  if (found == peers_.end()) return;
  statistics_.bytes_in += bytes.size();
  Peer& peer = found->second;
  if (peer.stage == PeerStage::kClosing) return;
  (void)peer.framer.feed(bytes);  // `process` asks whether it is broken.
  process(id, peer);
}

void Room::process(PeerId id, Peer& peer) {
  while (peer.stage != PeerStage::kClosing &&
         peer.messages < options_.limits.messages_per_tick_max) {
    const auto payload = peer.framer.next();
    if (!payload) break;
    ++peer.messages;
    const auto decoded = protocol::decode_client(*payload);
    if (!decoded.message) {
      return refuse(id, peer, protocol::Refusal::kBadMessage, "not a message: " + decoded.error);
    }
    peer.heard_ns = hooks_.now_ns();
    if (!within_rates(id, peer, payload->size(), *decoded.message)) return;
    take(id, peer, *decoded.message);
  }
  if (peer.stage == PeerStage::kClosing || !peer.framer.broken()) return;
  const bool greets = peer.stage == PeerStage::kGreeting;
  const auto [code, reason] =
      wrong_size(peer.framer.announced_bytes(),
                 greets ? protocol::kHelloBytesMax : protocol::kClientMessageBytesMax);
  refuse(id, peer, code, reason);
}

bool Room::within_rates(PeerId id, Peer& peer, std::size_t bytes,
                        const protocol::ClientMessage& said) {
  // What the room has asked for is not held against the client.
  if (std::holds_alternative<protocol::StatePart>(said) && bytes <= peer.free_bytes) {
    peer.free_bytes -= bytes;
    return true;
  }
  const std::int64_t now = peer.heard_ns;
  const Limits& limits = options_.limits;
  if (!peer.messages_rate.take(1, now)) {
    refuse(id, peer, protocol::Refusal::kRateLimited,
           "more than " + std::to_string(limits.messages_per_s) + " messages a second");
  } else if (!peer.bytes_rate.take(static_cast<std::uint32_t>(bytes), now)) {
    refuse(id, peer, protocol::Refusal::kRateLimited,
           "more than " + std::to_string(limits.bytes_per_s) + " bytes a second");
  } else {
    return true;
  }
  return false;
}

void Room::take(PeerId id, Peer& peer, const protocol::ClientMessage& message) {
  const bool is_hello = std::holds_alternative<protocol::Hello>(message);
  if (is_hello != (peer.stage == PeerStage::kGreeting)) {
    return refuse(id, peer, protocol::Refusal::kBadMessage,
                  is_hello ? "a second hello" : "the first message is not a hello");
  }
  const auto handler = protocol::Overloaded{
      [&](const protocol::Hello& hello) {
        Admission admission;
        admission.hello = hello;
        greet(id, peer, admission);
      },
      [&](const protocol::Input& input) { on_input(id, peer, input); },
      [&](const protocol::Digest& digest) { on_digest(id, peer, digest); },
      [&](const protocol::Ping& ping) {
        answer(id, peer, protocol::Pong{ping.token, visible_tick(peer)});
      },
      [&](const protocol::Bye& bye) {
        leave(id, peer, "bye: " + bye.reason, protocol::EventKind::kLeave);
      },
      [&](const protocol::Ack& ack) { on_ack(id, peer, ack); },
      [&](const protocol::TickDigests& digests) { on_tick_digests(id, peer, digests); },
      [&](const protocol::StatePart& part) { on_state_part(id, peer, part); },
  };
  std::visit(handler, message);
}

void Room::on_input(PeerId id, Peer& peer, const protocol::Input& input) {
  const std::uint64_t made = simulation_.tick();
  if (peer.seat < 0) {
    if (!peer.unseated) {
      return refuse(id, peer, protocol::Refusal::kBadMessage, "an input of a spectator");
    }
    ++statistics_.inputs_late;
    return;
  }
  prove_secret(peer);
  SeatHold& hold = seats_[static_cast<std::size_t>(peer.seat)];
  switch (protocol::timing(made, input.tick)) {
    case protocol::Timing::kLate: {
      ++statistics_.inputs_late;
      const std::uint64_t late = made + 1 - input.tick;
      if (late > protocol::kInputWindowTicks) return;  // Of another time, and nothing to steer by.
      hold.window.note_late();
      hold.margin.on_input(-static_cast<std::int32_t>(late), false);
      inputs_.late_ticks = std::max(inputs_.late_ticks, static_cast<std::uint32_t>(late));
      return;
    }
    case protocol::Timing::kEarly: {
      ++statistics_.inputs_early;
      const std::uint64_t early = input.tick - made - 1;
      if (early >= 2 * protocol::kInputWindowTicks) return;  // Likewise.
      hold.margin.on_input(static_cast<std::int32_t>(early), false);
      return;
    }
    case protocol::Timing::kInTime:
      break;
  }
  const std::uint32_t words = hold.window.say(made, input.tick, input.input);
  if (words > options_.limits.words_per_input_max) {
    return refuse(id, peer, protocol::Refusal::kRateLimited,
                  std::to_string(words) + " inputs for tick " + std::to_string(input.tick) +
                      ", of at most " + std::to_string(options_.limits.words_per_input_max));
  }
  auto early = static_cast<std::int32_t>(input.tick - made - 1);
  if (pacer_.waiting() && early == 0) {  // In time only because the tick has waited.
    const std::int64_t over_ns = hooks_.now_ns() - pacer_.due_ns(input.tick);
    early = -1 - static_cast<std::int32_t>(over_ns / pacer_.tick_ns());
    inputs_.late_ticks = std::max(inputs_.late_ticks, static_cast<std::uint32_t>(-early));
  }
  hold.margin.on_input(early, true);
}

void Room::on_ack(PeerId id, Peer& peer, const protocol::Ack& ack) {
  if (ack.tick > std::max(visible_tick(peer), highest_tick_)) {
    return refuse(id, peer, protocol::Refusal::kBadMessage,
                  "an acknowledgement of tick " + std::to_string(ack.tick) + ", the last made is " +
                      std::to_string(visible_tick(peer)));
  }
  if (peer.mode == protocol::Mode::kSnapshot) return on_ack_of_snapshot(peer, ack.tick);
  if (was_taken_back(ack.tick)) return;
  // Of a client that came back with its state: the frames since are enough, if they are kept.
  const bool waits = peer.resumed && peer.welcome_due && peer.state_due;
  const std::uint64_t made = visible_tick(peer);
  if (!waits || ack.tick > made) return;
  if (ack.tick < made && frames_.find(ack.tick + 1) == nullptr) return;
  peer.state_due = false;
  peer.exact_tick = ack.tick;
  peer.next_frame = ack.tick + 1;
  say_welcome(id, peer, ack.tick);
  if (peer.playing()) send_frames(id, peer, hooks_.now_ns());
}

/// A client acknowledges rising ticks until it hears of a rewind, and begins anew with the exact
/// state behind it. So each fall of the tick shows that it has heard of one more; when it has of
/// all, what it says is of this branch. Until then a tick that was taken back may be of another.
void Room::on_ack_of_snapshot(Peer& peer, std::uint64_t tick) {
  if (tick < peer.acknowledged_tick && peer.rewinds_unheard > 0) --peer.rewinds_unheard;
  peer.acknowledged_tick = tick;
  if (peer.rewinds_unheard > 0 && was_taken_back(tick)) return;
  if (!peer.state_due && tick >= peer.exact_tick) (void)peer.sent.acknowledge(tick);
}

void Room::prove_secret(Peer& peer) {
  // Before its welcome has left it cannot have the secret that is in it.
  if (peer.secret_proved || peer.welcome_due) return;
  peer.secret_proved = true;
  tokens_.confirm(static_cast<std::size_t>(peer.seat));
}

}  // namespace cycloid::server
