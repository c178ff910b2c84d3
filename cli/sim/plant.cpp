#include "cli/sim/plant.hpp"

#include <utility>
#include <variant>

namespace cycloid::sim {
namespace {

/// Which frame of a connection a plant takes.
constexpr std::uint64_t kFrameOfPlant = 20;

template <int D>
void forget_in(solver::World<D>& world) {
  solver::WorldState<D> state;
  world.save(state);
  for (auto& contact : state.contacts) {
    for (auto& point : contact.points) {
      point.normal_impulse = 0.0f;
      point.tangent_impulse = {};
    }
  }
  world.restore(state);
}

void append(const protocol::ServerMessage& message, protocol::Bytes& into) {
  const protocol::Bytes bytes = protocol::encode(message);
  into.insert(into.end(), bytes.begin(), bytes.end());
}

}  // namespace

const char* plant_name(Plant plant) {
  static constexpr std::array<const char*, static_cast<std::size_t>(Plant::kCount)> kNames = {
      "none",
      "client-skips-frame",
      "client-applies-late-input",
      "client-compares-unconfirmed",
      "room-repeats-frame",
      "room-swaps-frames",
      "room-forgets-event-at-snapshot",
      "room-shares-seat",
      "room-outbox-unbounded",
      "room-extends-deadline",
      "snapshot-without-impulses",
      "log-drops-record",
      "log-swaps-records",
      "log-forgets-sync",
      "log-spoils-keyframe",
      "gate-trusts-tokens",
      "room-gives-equal-secrets",
      "room-hides-rewind",
      "room-forgets-delay"};
  return kNames[static_cast<std::size_t>(plant)];
}

void forget_impulses(scenes::Simulation& simulation) {
  if (auto* planar = simulation.planar()) forget_in(*planar);
  if (auto* spatial = simulation.spatial()) forget_in(*spatial);
}

protocol::Bytes OutputTamper::tampered(const protocol::Bytes& bytes) {
  protocol::Bytes changed;
  protocol::Framer framer(protocol::kServerMessageBytesMax);
  (void)framer.feed(bytes);
  while (const auto payload = framer.next()) {
    const auto decoded = protocol::decode_server(*payload);
    if (!decoded.message) return bytes;
    if (const auto* said = std::get_if<protocol::InputFrame>(&*decoded.message)) {
      frame(*said, changed);
      continue;
    }
    protocol::ServerMessage other = *decoded.message;
    const auto* notice = std::get_if<protocol::RoomNotice>(&other);
    const bool rewound = notice != nullptr && notice->kind == protocol::NoticeKind::kRewound;
    if (rewound && plant_ == Plant::kRoomHidesRewind) continue;
    auto* welcome = std::get_if<protocol::Welcome>(&other);
    if (welcome != nullptr || std::holds_alternative<protocol::Snapshot>(other) ||
        std::holds_alternative<protocol::SnapshotPart>(other)) {
      state_before_ = true;
    }
    if (welcome != nullptr && plant_ == Plant::kRoomSharesSeat && welcome->seats != 0) {
      welcome->seat = 0;
    }
    append(other, changed);
  }
  return changed;
}

void OutputTamper::frame(protocol::InputFrame frame, protocol::Bytes& into) {
  ++frames_;
  const bool first_after_state = std::exchange(state_before_, false);
  if (plant_ == Plant::kRoomForgetsEventAtSnapshot && first_after_state) frame.events.clear();
  if (plant_ == Plant::kRoomSwapsFrames && frames_ == kFrameOfPlant) {
    append(frame, kept_);
    return;
  }
  append(frame, into);
  if (plant_ == Plant::kRoomRepeatsFrame && frames_ == kFrameOfPlant) append(frame, into);
  into.insert(into.end(), kept_.begin(), kept_.end());
  kept_.clear();
}

}  // namespace cycloid::sim
