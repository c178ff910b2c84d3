#include <algorithm>
#include <cstdio>
#include <utility>

#include "server/room/room.hpp"

namespace cycloid::server {
namespace {

template <class... Handlers>
struct Overloaded : Handlers... {
  using Handlers::operator()...;
};
// Implied by C++20, but Clang before 17 does not know.
template <class... Handlers>
Overloaded(Handlers...) -> Overloaded<Handlers...>;

std::string hex(std::uint64_t value) {
  char text[19];
  (void)std::snprintf(text, sizeof text, "0x%016llx", static_cast<unsigned long long>(value));
  return text;
}

std::string differ(const std::string& what, const std::string& theirs, const std::string& ours) {
  return what + " " + theirs + ", here " + ours;
}

}  // namespace

void Room::receive(PeerId id, std::span<const std::byte> bytes) {
  const auto found = peers_.find(id);
  if (found == peers_.end()) return;
  statistics_.bytes_in += bytes.size();
  Peer& peer = found->second;
  if (peer.stage == Stage::kClosing) return;
  (void)peer.framer.feed(bytes);  // `process` asks whether it is broken.
  process(id, peer);
}

void Room::process(PeerId id, Peer& peer) {
  while (peer.stage != Stage::kClosing && peer.messages < options_.limits.messages_per_tick_max) {
    const auto payload = peer.framer.next();
    if (!payload) break;
    ++peer.messages;
    const auto decoded = protocol::decode_client(*payload);
    if (!decoded.message) {
      return refuse(id, peer, protocol::Refusal::kBadMessage, "not a message: " + decoded.error);
    }
    peer.heard_ns = hooks_.now_ns();
    take(id, peer, *decoded.message);
  }
  if (peer.stage == Stage::kClosing || !peer.framer.broken()) return;
  const bool greets = peer.stage == Stage::kGreeting;
  const std::uint32_t most = greets ? protocol::kHelloBytesMax : protocol::kClientMessageBytesMax;
  const std::uint32_t announced = peer.framer.announced_bytes();
  refuse(id, peer, announced == 0 ? protocol::Refusal::kBadMessage : protocol::Refusal::kTooLarge,
         "a message of " + std::to_string(announced) + " bytes, of 1 to " + std::to_string(most));
}

void Room::take(PeerId id, Peer& peer, const protocol::ClientMessage& message) {
  const bool is_hello = std::holds_alternative<protocol::Hello>(message);
  if (is_hello != (peer.stage == Stage::kGreeting)) {
    return refuse(id, peer, protocol::Refusal::kBadMessage,
                  is_hello ? "a second hello" : "the first message is not a hello");
  }
  const auto handler = Overloaded{
      [&](const protocol::Hello& hello) { on_hello(id, peer, hello); },
      [&](const protocol::Input& input) { on_input(id, peer, input); },
      [&](const protocol::Digest& digest) { on_digest(id, peer, digest); },
      [&](const protocol::Ping& ping) {
        answer(id, peer, protocol::Pong{ping.token, simulation_.tick()});
      },
      [&](const protocol::Bye& bye) { leave(id, peer, "bye: " + bye.reason); },
      [](const auto&) {},
  };
  std::visit(handler, message);
}

void Room::on_hello(PeerId id, Peer& peer, const protocol::Hello& hello) {
  peer.name = hello.name;
  if (hello.protocol_version != protocol::kProtocolVersion) {
    return refuse(id, peer, protocol::Refusal::kProtocolVersion,
                  differ("protocol version", std::to_string(hello.protocol_version),
                         std::to_string(protocol::kProtocolVersion)));
  }
  if (hello.solver_version != solver::kSolverVersion) {
    return refuse(id, peer, protocol::Refusal::kSolverVersion,
                  differ("solver version", std::to_string(hello.solver_version),
                         std::to_string(solver::kSolverVersion)));
  }
  if (hello.scene_digest != options_.scene_digest) {
    return refuse(id, peer, protocol::Refusal::kSceneDigest,
                  differ("scene digest", hex(hello.scene_digest), hex(options_.scene_digest)));
  }
  if (!find_seat(id, peer, hello.seat_wish)) return;

  peer.stage = Stage::kPlaying;
  peer.mode = hello.mode;
  peer.framer.set_limit(protocol::kClientMessageBytesMax);
  peer.exact_tick = simulation_.tick();
  ++statistics_.clients;
  notice(Notice::Kind::kJoin,
         "client " + std::to_string(id) + " joined at tick " + std::to_string(simulation_.tick()) +
             (peer.seat < 0 ? " as spectator" : " in seat " + std::to_string(peer.seat)));
  answer(id, peer,
         protocol::Welcome{peer.seat, static_cast<std::uint32_t>(seats_.size()), simulation_.tick(),
                           options_.tick_rate_millihertz, options_.limits.input_delay_ticks});
  if (peer.stage == Stage::kPlaying) peer.outbox.push_exact(exact_snapshot());
}

bool Room::find_seat(PeerId id, Peer& peer, std::int32_t wish) {
  // A scene without seats has nothing but spectators.
  if (wish == protocol::kSpectator || (wish == protocol::kAnySeat && seats_.empty())) return true;

  const std::string seats = std::to_string(seats_.size());
  // Every event of a leave has room, for at most kSeatsMax seats can be left before the next frame.
  if (events_.size() + scenes::kSeatsMax >= protocol::kFrameEventsMax) {
    refuse(id, peer, protocol::Refusal::kRoomFull,
           std::to_string(events_.size()) + " joins and leaves in one tick, of at most " +
               std::to_string(protocol::kFrameEventsMax - scenes::kSeatsMax));
    return false;
  }
  const auto free = [](const Seat& seat) { return seat.holder() == kNobody; };
  auto index = static_cast<std::size_t>(wish);
  if (wish == protocol::kAnySeat) {
    index = static_cast<std::size_t>(std::ranges::find_if(seats_, free) - seats_.begin());
    if (index == seats_.size()) {
      refuse(id, peer, protocol::Refusal::kRoomFull, seats + " seats taken, of " + seats);
      return false;
    }
  } else if (index >= seats_.size()) {
    refuse(id, peer, protocol::Refusal::kNoSuchSeat,
           "seat " + std::to_string(wish) + ", here are " + seats + " seats from 0");
    return false;
  } else if (!free(seats_[index])) {
    refuse(id, peer, protocol::Refusal::kSeatTaken,
           "seat " + std::to_string(wish) + " is held by client " +
               std::to_string(seats_[index].holder()));
    return false;
  }
  seats_[index].hand_to(id);
  peer.seat = static_cast<std::int32_t>(index);
  events_.push_back({protocol::EventKind::kJoin, static_cast<std::uint16_t>(index)});
  return true;
}

void Room::on_input(PeerId id, Peer& peer, const protocol::Input& input) {
  if (peer.seat < 0) {
    return refuse(id, peer, protocol::Refusal::kBadMessage, "an input of a spectator");
  }
  switch (protocol::timing(simulation_.tick(), input.tick)) {
    case protocol::Timing::kLate:
      ++statistics_.inputs_late;
      return;
    case protocol::Timing::kEarly:
      ++statistics_.inputs_early;
      return;
    case protocol::Timing::kInTime:
      break;
  }
  seats_[static_cast<std::size_t>(peer.seat)].say(input.tick, input.input);
}

void Room::on_digest(PeerId id, Peer& peer, const protocol::Digest& digest) {
  if (digest.tick > simulation_.tick()) {
    return refuse(id, peer, protocol::Refusal::kBadMessage,
                  "a digest of tick " + std::to_string(digest.tick) + ", the last made is " +
                      std::to_string(simulation_.tick()));
  }
  if (peer.mode != protocol::Mode::kLockstep || digest.tick <= peer.exact_tick) return;
  const auto mine = std::ranges::find(digests_, digest.tick, &DigestAt::tick);
  if (mine == digests_.end() || mine->digest == digest.digest) return;

  ++statistics_.desyncs;
  if (!std::exchange(peer.desync_noticed, true)) {
    notice(Notice::Kind::kDesync, "client " + std::to_string(id) + " desynced by tick " +
                                      std::to_string(digest.tick) + ": " +
                                      differ("digest", hex(digest.digest), hex(mine->digest)));
  }
  if (peer.outbox.exact_waits()) {
    return refuse(id, peer, protocol::Refusal::kTooSlow, "a second snapshot waits for it");
  }
  peer.exact_tick = simulation_.tick();
  peer.outbox.push_exact(exact_snapshot());
}

}  // namespace cycloid::server
