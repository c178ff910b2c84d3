#include "protocol/schema/server_message_generated.h"
#include "protocol/wire/buffer.hpp"
#include "protocol/wire/packed_frame.hpp"

namespace cycloid::protocol {
namespace {

using wire_buffer::build;
using wire_buffer::read;

using namespace wire_buffer;

flatbuffers::Offset<void> build(const Welcome& welcome, Builder& to) {
  const auto room = text_of(welcome.room, to);
  const auto resume = bytes_of(welcome.resume, to);
  const auto build_text = text_of(welcome.build, to);
  return wire::CreateWelcome(to, welcome.seat, welcome.seats, welcome.tick,
                             welcome.tick_rate_millihertz, welcome.input_delay_ticks,
                             welcome.protocol_minor, room, resume, build_text, welcome.digest_ticks)
      .Union();
}

flatbuffers::Offset<void> build(const Refused& refused, Builder& to) {
  const auto reason = reason_of(refused.reason, to);
  return wire::CreateRefused(to, static_cast<wire::RefusalCode>(refused.code), reason).Union();
}

flatbuffers::Offset<void> build(const InputFrame& frame, Builder& to) {
  std::vector<wire::SeatFrame> seats;
  for (const SeatFrame& seat : frame.seats) {
    seats.emplace_back(to_wire(seat.input), static_cast<wire::Origin>(seat.origin));
  }
  std::vector<wire::FrameEvent> events;
  for (const FrameEvent& event : frame.events) {
    events.emplace_back(event.seat, static_cast<wire::EventKind>(event.kind));
  }
  std::vector<wire::FrameChange> changes;
  for (const FrameChange& change : frame.changes) {
    changes.emplace_back(change.value, static_cast<wire::ChangeKind>(change.kind));
  }
  const auto seats_at = to.CreateVectorOfStructs(seats);
  const auto events_at = to.CreateVectorOfStructs(events);
  flatbuffers::Offset<flatbuffers::Vector<const wire::FrameChange*>> changes_at;
  if (!changes.empty()) changes_at = to.CreateVectorOfStructs(changes);
  return wire::CreateInputFrame(to, frame.tick, seats_at, events_at, changes_at).Union();
}

flatbuffers::Offset<void> build(const Snapshot& snapshot, Builder& to) {
  const auto state = bytes_of(snapshot.state, to);
  return wire::CreateSnapshot(to, snapshot.tick, snapshot.digest, state).Union();
}

flatbuffers::Offset<void> build(const Pong& pong, Builder& to) {
  return wire::CreatePong(to, pong.token, pong.tick).Union();
}

flatbuffers::Offset<void> build(const SnapshotPart& part, Builder& to) {
  const auto bytes = bytes_of(part.bytes, to);
  return wire::CreateSnapshotPart(to, part.tick, part.digest, part.total_bytes, part.offset, bytes)
      .Union();
}

flatbuffers::Offset<void> build(const StateDelta& delta, Builder& to) {
  const auto bytes = bytes_of(delta.bytes, to);
  return wire::CreateStateDelta(to, delta.tick, delta.baseline_tick, delta.digest,
                                static_cast<wire::Profile>(delta.profile), bytes)
      .Union();
}

flatbuffers::Offset<void> build(const Margin& margin, Builder& to) {
  return wire::CreateMargin(to, margin.tick, margin.early_ticks, margin.merged, margin.missed)
      .Union();
}

flatbuffers::Offset<void> build(const StateWanted& wanted, Builder& to) {
  return wire::CreateStateWanted(to, wanted.tick).Union();
}

flatbuffers::Offset<void> build(const RoomNotice& notice, Builder& to) {
  const auto text = reason_of(notice.text, to);
  return wire::CreateRoomNotice(to, static_cast<wire::NoticeKind>(notice.kind), notice.tick,
                                notice.value, text)
      .Union();
}

std::optional<Welcome> read(const wire::Welcome& from, std::string& error) {
  Welcome welcome;
  welcome.seat = from.seat();
  welcome.seats = from.seats();
  welcome.tick = from.tick();
  welcome.tick_rate_millihertz = from.tick_rate_millihertz();
  welcome.input_delay_ticks = from.input_delay_ticks();
  welcome.protocol_minor = from.protocol_minor();
  welcome.digest_ticks = from.digest_ticks();
  if (welcome.seats > scenes::kSeatsMax) {
    return refuse<Welcome>(error, std::to_string(welcome.seats) + " seats");
  }
  const bool spectates = welcome.seat == kSpectator;
  if (!spectates && (welcome.seat < 0 || std::cmp_greater_equal(welcome.seat, welcome.seats))) {
    return refuse<Welcome>(
        error, "seat " + std::to_string(welcome.seat) + " of " + std::to_string(welcome.seats));
  }
  if (welcome.tick_rate_millihertz == 0) return refuse<Welcome>(error, "a tick rate of 0");
  const bool good = read_text(from.room(), kRoomNameBytesMax, "a room name", welcome.room, error) &&
                    read_text(from.build(), kBuildBytesMax, "a build", welcome.build, error) &&
                    read_resume(from.resume(), welcome.resume, error);
  if (!good) return {};
  return welcome;
}

std::optional<Refused> read(const wire::Refused& from, std::string& error) {
  Refused refused;
  refused.code = static_cast<Refusal>(from.code());
  if (refused.code < Refusal::kProtocolVersion || refused.code > kLastRefusal) {
    return refuse<Refused>(error, "refusal " + std::to_string(static_cast<int>(refused.code)));
  }
  if (!read_text(from.reason(), kReasonBytesMax, "a reason", refused.reason, error)) return {};
  return refused;
}

bool read_seats(const flatbuffers::Vector<const wire::SeatFrame*>& from, InputFrame& frame,
                std::string& error) {
  frame.seats.reserve(from.size());
  for (const wire::SeatFrame* seat : from) {
    const auto origin = static_cast<Origin>(seat->origin());
    if (origin < Origin::kGiven || origin > Origin::kNeutral) {
      error = "origin " + std::to_string(static_cast<int>(origin));
      return false;
    }
    frame.seats.push_back({origin, from_wire(seat->input())});
  }
  return true;
}

bool read_events(const flatbuffers::Vector<const wire::FrameEvent*>& from, InputFrame& frame,
                 std::string& error) {
  frame.events.reserve(from.size());
  for (const wire::FrameEvent* event : from) {
    const auto kind = static_cast<EventKind>(event->kind());
    const bool known = kind >= EventKind::kJoin && kind <= EventKind::kResume;
    if (!known || event->seat() >= frame.seats.size()) {
      error = "event " + std::to_string(static_cast<int>(kind)) + " of seat " +
              std::to_string(event->seat());
      return false;
    }
    frame.events.push_back({kind, event->seat()});
  }
  return true;
}

bool read_changes(const flatbuffers::Vector<const wire::FrameChange*>& from, InputFrame& frame,
                  std::string& error) {
  for (const wire::FrameChange* change : from) {
    const auto kind = static_cast<ChangeKind>(change->kind());
    if (kind != ChangeKind::kInputDelay || change->value() == 0) {
      error = "change " + std::to_string(static_cast<int>(kind)) + " to " +
              std::to_string(change->value());
      return false;
    }
    frame.changes.push_back({kind, change->value()});
  }
  return true;
}

std::optional<InputFrame> read(const wire::InputFrame& from, std::string& error) {
  const std::size_t seats = from.seats() == nullptr ? 0 : from.seats()->size();
  const std::size_t events = from.events() == nullptr ? 0 : from.events()->size();
  const std::size_t changes = from.changes() == nullptr ? 0 : from.changes()->size();
  if (from.tick() == 0) return refuse<InputFrame>(error, "a frame of tick 0");
  if (seats > scenes::kSeatsMax || events > kFrameEventsMax || changes > kFrameChangesMax) {
    return refuse<InputFrame>(error, "a frame of " + std::to_string(seats) + " seats, " +
                                         std::to_string(events) + " events and " +
                                         std::to_string(changes) + " changes");
  }
  InputFrame frame;
  frame.tick = from.tick();
  if (seats != 0 && !read_seats(*from.seats(), frame, error)) return {};
  if (events != 0 && !read_events(*from.events(), frame, error)) return {};
  if (changes != 0 && !read_changes(*from.changes(), frame, error)) return {};
  return frame;
}

std::optional<InputFrame> read(const wire::PackedFrame& from, std::string& error) {
  if (from.bytes() == nullptr) return refuse<InputFrame>(error, "a packed frame of nothing");
  const auto* bytes = reinterpret_cast<const std::byte*>(from.bytes()->data());
  return unpack_frame({bytes, from.bytes()->size()}, error);
}

std::optional<Snapshot> read(const wire::Snapshot& from, std::string& error) {
  Snapshot snapshot{from.tick(), from.digest(), {}};
  if (!read_bytes(from.state(), kServerMessageBytesMax, "a state", snapshot.state, error))
    return {};
  return snapshot;
}

std::optional<Pong> read(const wire::Pong& from, std::string&) {
  return Pong{from.token(), from.tick()};
}

std::optional<SnapshotPart> read(const wire::SnapshotPart& from, std::string& error) {
  SnapshotPart part{from.tick(), from.digest(), from.total_bytes(), from.offset(), {}};
  if (!read_bytes(from.bytes(), kSnapshotPartBytesMax, "a part", part.bytes, error)) return {};
  if (!part_fits(part.total_bytes, part.offset, part.bytes.size(), error)) return {};
  return part;
}

std::optional<StateDelta> read(const wire::StateDelta& from, std::string& error) {
  StateDelta delta{
      from.tick(), from.baseline_tick(), from.digest(), static_cast<Profile>(from.profile()), {}};
  if (!is_profile(delta.profile)) {
    return refuse<StateDelta>(error, "profile " + std::to_string(static_cast<int>(delta.profile)));
  }
  if (delta.baseline_tick > delta.tick) {
    return refuse<StateDelta>(error, "a delta of tick " + std::to_string(delta.tick) +
                                         " from the later tick " +
                                         std::to_string(delta.baseline_tick));
  }
  if (!read_bytes(from.bytes(), kServerMessageBytesMax, "a delta", delta.bytes, error)) return {};
  return delta;
}

std::optional<Margin> read(const wire::Margin& from, std::string&) {
  return Margin{from.tick(), from.early_ticks(), from.merged(), from.missed()};
}

std::optional<StateWanted> read(const wire::StateWanted& from, std::string& error) {
  if (from.tick() == 0) return refuse<StateWanted>(error, "the state of tick 0 is wanted");
  return StateWanted{from.tick()};
}

std::optional<RoomNotice> read(const wire::RoomNotice& from, std::string& error) {
  RoomNotice notice{static_cast<NoticeKind>(from.kind()), from.tick(), from.value(), {}};
  if (notice.kind < NoticeKind::kSlowed || notice.kind > NoticeKind::kReport) {
    return refuse<RoomNotice>(error, "notice " + std::to_string(static_cast<int>(notice.kind)));
  }
  if (!read_text(from.text(), kReasonBytesMax, "a notice", notice.text, error)) return {};
  return notice;
}

/// The body, if it is one of the wanted type, in the variant of its direction.
template <class Message, class Table>
void take(const Table* table, Decoded<Message>& into) {
  if (table == nullptr) {
    into.error = "a message without a body";
    return;
  }
  take_body(read(*table, into.error), into);
}

}  // namespace

Bytes encode(const ServerMessage& message) {
  Builder builder(256);
  const auto body = std::visit([&](const auto& said) { return build(said, builder); }, message);
  const auto type = static_cast<wire::ServerBody>(message.index() + 1);
  const auto root = wire::CreateServerMessage(builder, type, body);
  wire::FinishServerMessageBuffer(builder, root);
  return with_prefix(builder);
}

Bytes encode_packed(const InputFrame& frame) {
  Bytes packed;
  packed.reserve(16 + 4 * frame.seats.size());
  pack_frame(frame, packed);
  Builder builder(256);
  const auto bytes = bytes_of(packed, builder);
  const auto body = wire::CreatePackedFrame(builder, bytes).Union();
  const auto root = wire::CreateServerMessage(builder, wire::ServerBody::PackedFrame, body);
  wire::FinishServerMessageBuffer(builder, root);
  return with_prefix(builder);
}

Decoded<ServerMessage> decode_server(std::span<const std::byte> payload) {
  Decoded<ServerMessage> decoded;
  if (!fits(payload.size(), kServerMessageBytesMax, decoded.error)) return decoded;
  const Aligned aligned(payload);
  const auto* root =
      verified<wire::ServerMessage>(aligned, wire::ServerMessageIdentifier(), decoded.error);
  if (root == nullptr) return decoded;
  switch (root->body_type()) {
    case wire::ServerBody::Welcome:
      take(root->body_as_Welcome(), decoded);
      break;
    case wire::ServerBody::Refused:
      take(root->body_as_Refused(), decoded);
      break;
    case wire::ServerBody::InputFrame:
      take(root->body_as_InputFrame(), decoded);
      break;
    case wire::ServerBody::Snapshot:
      take(root->body_as_Snapshot(), decoded);
      break;
    case wire::ServerBody::Digest:
      take(root->body_as_Digest(), decoded);
      break;
    case wire::ServerBody::Pong:
      take(root->body_as_Pong(), decoded);
      break;
    case wire::ServerBody::Bye:
      take(root->body_as_Bye(), decoded);
      break;
    case wire::ServerBody::SnapshotPart:
      take(root->body_as_SnapshotPart(), decoded);
      break;
    case wire::ServerBody::StateDelta:
      take(root->body_as_StateDelta(), decoded);
      break;
    case wire::ServerBody::Margin:
      take(root->body_as_Margin(), decoded);
      break;
    case wire::ServerBody::StateWanted:
      take(root->body_as_StateWanted(), decoded);
      break;
    case wire::ServerBody::RoomNotice:
      take(root->body_as_RoomNotice(), decoded);
      break;
    case wire::ServerBody::PackedFrame:
      take(root->body_as_PackedFrame(), decoded);
      break;
    default:
      decoded.error = "a body of an unknown type";
  }
  return decoded;
}

}  // namespace cycloid::protocol
