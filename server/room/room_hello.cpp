#include <utility>

#include "protocol/text.hpp"
#include "server/room/room.hpp"
#include "solver/version.hpp"

namespace cycloid::server {
namespace {

std::string differ(const std::string& what, const std::string& theirs, const std::string& ours) {
  return what + " " + theirs + ", here " + ours;
}

}  // namespace

void Room::greet(PeerId id, Peer& peer, const Admission& admission) {
  const protocol::Hello& hello = admission.hello;
  peer.name = hello.name;
  peer.identity = admission.identity;
  peer.build = hello.build;
  peer.role = admission.role;
  if (refuse_other_build(id, peer, hello)) return;
  const bool resumes = !hello.resume.empty();
  if (!resumes && locked_ && admission.role != Role::kAdmin) {
    return refuse(id, peer, protocol::Refusal::kRoomLocked, "the room is locked");
  }
  if (resumes ? !resume_seat(id, peer, admission) : !take_seat(id, peer, admission)) return;

  peer.stage = PeerStage::kPlaying;
  peer.mode = hello.mode;
  peer.packs = hello.protocol_minor >= protocol::kPackedFramesMinor;
  peer.profile = hello.profile;
  peer.framer.set_limit(protocol::kClientMessageBytesMax);
  peer.resumed = resumes;
  if (peer.seat < 0 && peer.role != Role::kAdmin) peer.delay_ticks = options_.spectator_delay_ticks;
  if (peer.seat >= 0) give_secret(peer, hello.resume);
  peer.welcome_due = true;
  want_state(peer);
  ++statistics_.clients;
  statistics_.resumes += resumes ? 1 : 0;
  notice(Notice::Kind::kJoin,
         "client " + std::to_string(id) + (resumes ? " came back" : " joined") + " at tick " +
             std::to_string(simulation_.tick()) +
             (peer.seat < 0 ? " as spectator" : " in seat " + std::to_string(peer.seat)) +
             identity_text(peer));
}

bool Room::refuse_other_build(PeerId id, Peer& peer, const protocol::Hello& hello) {
  if (hello.protocol_version != protocol::kProtocolVersion) {
    refuse(id, peer, protocol::Refusal::kProtocolVersion,
           differ("protocol version", std::to_string(hello.protocol_version),
                  std::to_string(protocol::kProtocolVersion)));
  } else if (hello.solver_version != solver::kSolverVersion) {
    refuse(id, peer, protocol::Refusal::kSolverVersion,
           differ("solver version", std::to_string(hello.solver_version),
                  std::to_string(solver::kSolverVersion)));
  } else if (hello.scene_digest != options_.scene_digest) {
    refuse(id, peer, protocol::Refusal::kSceneDigest,
           differ("scene digest", "0x" + protocol::hex16(hello.scene_digest),
                  "0x" + protocol::hex16(options_.scene_digest)));
  } else if (!hello.room.empty() && !options_.name.empty() && hello.room != options_.name) {
    refuse(id, peer, protocol::Refusal::kNoSuchRoom,
           differ("room", "\"" + hello.room + "\"", "\"" + options_.name + "\""));
  } else {
    return false;
  }
  return true;
}

bool Room::events_have_room(PeerId id, Peer& peer) {
  // Every seat can still be lost and then be left before the next frame.
  constexpr std::size_t kKept = 2 * scenes::kSeatsMax;
  if (events_.size() + 2 + kKept <= protocol::kFrameEventsMax) return true;
  refuse(id, peer, protocol::Refusal::kRoomFull,
         std::to_string(events_.size()) + " joins and leaves in one tick, of at most " +
             std::to_string(protocol::kFrameEventsMax - kKept));
  return false;
}

bool Room::take_seat(PeerId id, Peer& peer, const Admission& admission) {
  const std::int32_t wish = admission.hello.seat_wish;
  const bool may_play = admission.role != Role::kSpectator;
  const bool is_bound = admission.seat != protocol::kAnySeat;
  // A scene without seats has nothing but spectators.
  const bool spectates = admission.seat == protocol::kSpectator ||
                         (wish == protocol::kSpectator && !is_bound) ||
                         (wish == protocol::kAnySeat && seats_.size() == 0 && !is_bound);
  if (!may_play || spectates) return true;
  SeatProblem problem;
  const auto seat = seats_.find({wish, admission.seat, admission.identity}, problem);
  if (!seat) {
    refuse(id, peer, problem.code, problem.reason);
    return false;
  }
  if (!events_have_room(id, peer)) return false;
  seats_.sit(*seat, id, admission.identity);
  peer.seat = static_cast<std::int32_t>(*seat);
  events_.push_back({protocol::EventKind::kJoin, static_cast<std::uint16_t>(*seat)});
  delay_.look_anew();
  return true;
}

bool Room::resume_seat(PeerId id, Peer& peer, const Admission& admission) {
  const auto seat = tokens_.find(admission.hello.resume);
  const bool is_other =
      seat && !admission.identity.empty() && seats_[*seat].identity != admission.identity;
  if (!seat || is_other) {
    refuse(id, peer, protocol::Refusal::kResumeUnknown,
           "the resume token is of no seat here: it was used, or the seat was given up");
    return false;
  }
  if (!events_have_room(id, peer)) return false;
  const auto event_seat = static_cast<std::uint16_t>(*seat);
  if (const auto old = peers_.find(seats_[*seat].holder); old != peers_.end()) {
    old->second.seat = protocol::kSpectator;  // The seat goes on; only the connection ends.
    refuse(old->first, old->second, protocol::Refusal::kReplaced,
           "seat " + std::to_string(*seat) + " was resumed by client " + std::to_string(id));
    events_.push_back({protocol::EventKind::kLost, event_seat});
  }
  seats_.resume(*seat, id);
  peer.identity = seats_[*seat].identity;  // A resume token says none.
  events_.push_back({protocol::EventKind::kResume, event_seat});
  peer.seat = static_cast<std::int32_t>(*seat);
  return true;
}

void Room::give_secret(Peer& peer, std::span<const std::byte> used) {
  if (!hooks_.random || options_.limits.resume.count() <= 0) return;
  ResumeSecret secret{};
  hooks_.random(secret);
  const auto seat = static_cast<std::size_t>(peer.seat);
  if (used.empty()) {
    tokens_.give(seat, secret);
  } else {
    tokens_.rotate(seat, secret, used);
    peer.secret_proved = false;
  }
  peer.secret.assign(secret.begin(), secret.end());
}

}  // namespace cycloid::server
