#include "protocol/codec.hpp"

#include <cstring>
#include <memory>
#include <utility>

#include "protocol/little_endian.hpp"
#include "protocol/schema/client_message_generated.h"
#include "protocol/schema/server_message_generated.h"
#include "protocol/utf8.hpp"

namespace cycloid::protocol {
namespace {

// Every table is built in statements of its own: two calls that change the builder in one argument
// list would come in an order that differs between GCC and Clang, and so would the bytes.

using Builder = flatbuffers::FlatBufferBuilder;

/// A message is a root table and its body, and nothing nests deeper than struct in vector in table.
constexpr flatbuffers::uoffset_t kDepthMax = 8;
constexpr flatbuffers::uoffset_t kClientTablesMax = 4;
constexpr flatbuffers::uoffset_t kServerTablesMax = 4;
/// Offset to the root, then the file identifier.
constexpr std::size_t kPayloadBytesMin = 8;

wire::SeatInput to_wire(const scenes::SeatInput& input) {
  return {flatbuffers::span<const std::int16_t, scenes::kAxes>(input.axes), input.buttons};
}

scenes::SeatInput from_wire(const wire::SeatInput& input) {
  scenes::SeatInput result;
  for (std::size_t axis = 0; axis < result.axes.size(); ++axis) {
    result.axes[axis] = input.axes()->Get(static_cast<flatbuffers::uoffset_t>(axis));
  }
  result.buttons = input.buttons();
  return result;
}

flatbuffers::Offset<flatbuffers::String> reason_of(const std::string& reason, Builder& to) {
  return to.CreateString(cut_utf8(reason, kReasonBytesMax));
}

flatbuffers::Offset<void> build(const Hello& hello, Builder& to) {
  const auto name = to.CreateString(hello.name);
  const auto mode = static_cast<wire::Mode>(hello.mode);
  return wire::CreateHello(to, hello.protocol_version, hello.solver_version, hello.scene_digest,
                           mode, hello.seat_wish, name)
      .Union();
}

flatbuffers::Offset<void> build(const Input& input, Builder& to) {
  const wire::SeatInput said = to_wire(input.input);
  return wire::CreateInput(to, input.tick, &said).Union();
}

flatbuffers::Offset<void> build(const Digest& digest, Builder& to) {
  return wire::CreateDigest(to, digest.tick, digest.digest).Union();
}

flatbuffers::Offset<void> build(const Ping& ping, Builder& to) {
  return wire::CreatePing(to, ping.token).Union();
}

flatbuffers::Offset<void> build(const Bye& bye, Builder& to) {
  const auto reason = reason_of(bye.reason, to);
  return wire::CreateBye(to, reason).Union();
}

flatbuffers::Offset<void> build(const Welcome& welcome, Builder& to) {
  return wire::CreateWelcome(to, welcome.seat, welcome.seats, welcome.tick,
                             welcome.tick_rate_millihertz, welcome.input_delay_ticks)
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
  const auto seats_at = to.CreateVectorOfStructs(seats);
  const auto events_at = to.CreateVectorOfStructs(events);
  return wire::CreateInputFrame(to, frame.tick, seats_at, events_at).Union();
}

flatbuffers::Offset<void> build(const Snapshot& snapshot, Builder& to) {
  const auto* bytes = reinterpret_cast<const std::uint8_t*>(snapshot.state.data());
  const auto state = to.CreateVector(bytes, snapshot.state.size());
  return wire::CreateSnapshot(to, snapshot.tick, snapshot.digest, state).Union();
}

flatbuffers::Offset<void> build(const Pong& pong, Builder& to) {
  return wire::CreatePong(to, pong.token, pong.tick).Union();
}

Bytes with_prefix(const Builder& builder) {
  const auto payload_bytes = static_cast<std::uint32_t>(builder.GetSize());
  const auto* payload = reinterpret_cast<const std::byte*>(builder.GetBufferPointer());
  Bytes bytes;
  bytes.reserve(Framer::kPrefixBytes + payload_bytes);
  append_little(payload_bytes, bytes);
  bytes.insert(bytes.end(), payload, payload + payload_bytes);
  return bytes;
}

/// The payload at an address where its numbers are aligned, as FlatBuffers reads them in place.
class Aligned {
 public:
  explicit Aligned(std::span<const std::byte> payload)
      : data_(payload.data()), bytes_(payload.size()) {
    if (reinterpret_cast<std::uintptr_t>(data_) % alignof(std::uint64_t) == 0) return;
    copy_ = std::make_unique<std::uint64_t[]>((bytes_ + 7) / 8);
    std::memcpy(copy_.get(), data_, bytes_);
    data_ = reinterpret_cast<const std::byte*>(copy_.get());
  }
  const std::uint8_t* data() const { return reinterpret_cast<const std::uint8_t*>(data_); }
  std::size_t size() const { return bytes_; }

 private:
  const std::byte* data_;
  std::size_t bytes_;
  std::unique_ptr<std::uint64_t[]> copy_;
};

template <class Root>
const Root* verified(const Aligned& payload, const char* identifier,
                     flatbuffers::uoffset_t tables_max, std::string& error) {
  if (!flatbuffers::BufferHasIdentifier(payload.data(), identifier)) {
    error = std::string("the file identifier is not ") + identifier;
    return nullptr;
  }
  flatbuffers::Verifier verifier(payload.data(), payload.size(), kDepthMax, tables_max);
  if (!verifier.VerifyBuffer<Root>(identifier)) {
    error = "the structure is damaged";
    return nullptr;
  }
  return flatbuffers::GetRoot<Root>(payload.data());
}

/// Before anything is copied, and before the identifier is looked for, which reads 8 bytes.
bool fits(std::size_t payload_bytes, std::uint32_t bytes_max, std::string& error) {
  if (payload_bytes >= kPayloadBytesMin && payload_bytes <= bytes_max) return true;
  error = "a payload of " + std::to_string(payload_bytes) + " bytes";
  return false;
}

// Validation: what the verifier does not look at. Each sets `error` and returns nothing, or returns
// the message.

template <class Message>
std::optional<Message> refuse(std::string& error, std::string why) {
  error = std::move(why);
  return {};
}

bool read_text(const flatbuffers::String* from, std::size_t bytes_max, const char* what,
               std::string& into, std::string& error) {
  if (from == nullptr) return true;
  if (from->size() > bytes_max) {
    error = std::string(what) + " of " + std::to_string(from->size()) + " bytes, of at most " +
            std::to_string(bytes_max);
    return false;
  }
  into.assign(from->c_str(), from->size());
  if (is_utf8(into)) return true;
  error = std::string(what) + " is not UTF-8";
  return false;
}

std::optional<Hello> read(const wire::Hello& from, std::string& error) {
  Hello hello;
  hello.protocol_version = from.protocol_version();
  hello.solver_version = from.solver_version();
  hello.scene_digest = from.scene_digest();
  hello.mode = static_cast<Mode>(from.mode());
  hello.seat_wish = from.seat_wish();
  if (hello.mode != Mode::kLockstep && hello.mode != Mode::kSnapshot) {
    return refuse<Hello>(error, "mode " + std::to_string(static_cast<int>(hello.mode)));
  }
  if (hello.seat_wish < kSpectator) {
    return refuse<Hello>(error, "seat wish " + std::to_string(hello.seat_wish));
  }
  if (!read_text(from.name(), kNameBytesMax, "a name", hello.name, error)) return {};
  return hello;
}

std::optional<Input> read(const wire::Input& from, std::string& error) {
  if (from.tick() == 0) return refuse<Input>(error, "an input for tick 0");
  if (from.input() == nullptr) return refuse<Input>(error, "an input that says nothing");
  return Input{from.tick(), from_wire(*from.input())};
}

std::optional<Digest> read(const wire::Digest& from, std::string&) {
  return Digest{from.tick(), from.digest()};
}

std::optional<Ping> read(const wire::Ping& from, std::string&) {
  return Ping{from.token()};
}

std::optional<Bye> read(const wire::Bye& from, std::string& error) {
  Bye bye;
  if (!read_text(from.reason(), kReasonBytesMax, "a reason", bye.reason, error)) return {};
  return bye;
}

std::optional<Welcome> read(const wire::Welcome& from, std::string& error) {
  const Welcome welcome{from.seat(), from.seats(), from.tick(), from.tick_rate_millihertz(),
                        from.input_delay_ticks()};
  if (welcome.seats > scenes::kSeatsMax) {
    return refuse<Welcome>(error, std::to_string(welcome.seats) + " seats");
  }
  const bool spectates = welcome.seat == kSpectator;
  if (!spectates && (welcome.seat < 0 || std::cmp_greater_equal(welcome.seat, welcome.seats))) {
    return refuse<Welcome>(
        error, "seat " + std::to_string(welcome.seat) + " of " + std::to_string(welcome.seats));
  }
  if (welcome.tick_rate_millihertz == 0) return refuse<Welcome>(error, "a tick rate of 0");
  return welcome;
}

std::optional<Refused> read(const wire::Refused& from, std::string& error) {
  Refused refused;
  refused.code = static_cast<Refusal>(from.code());
  if (refused.code < Refusal::kProtocolVersion || refused.code > Refusal::kFaulted) {
    return refuse<Refused>(error, "refusal " + std::to_string(static_cast<int>(refused.code)));
  }
  if (!read_text(from.reason(), kReasonBytesMax, "a reason", refused.reason, error)) return {};
  return refused;
}

std::optional<InputFrame> read(const wire::InputFrame& from, std::string& error) {
  InputFrame frame;
  frame.tick = from.tick();
  const std::size_t seats = from.seats() == nullptr ? 0 : from.seats()->size();
  const std::size_t events = from.events() == nullptr ? 0 : from.events()->size();
  if (frame.tick == 0) return refuse<InputFrame>(error, "a frame of tick 0");
  if (seats > scenes::kSeatsMax || events > kFrameEventsMax) {
    return refuse<InputFrame>(error, "a frame of " + std::to_string(seats) + " seats and " +
                                         std::to_string(events) + " events");
  }
  frame.seats.reserve(seats);
  for (flatbuffers::uoffset_t i = 0; i < seats; ++i) {
    const wire::SeatFrame& seat = *from.seats()->Get(i);
    const auto origin = static_cast<Origin>(seat.origin());
    if (origin < Origin::kGiven || origin > Origin::kAbsent) {
      return refuse<InputFrame>(error, "origin " + std::to_string(static_cast<int>(origin)));
    }
    frame.seats.push_back({origin, from_wire(seat.input())});
  }
  frame.events.reserve(events);
  for (flatbuffers::uoffset_t i = 0; i < events; ++i) {
    const wire::FrameEvent& event = *from.events()->Get(i);
    const auto kind = static_cast<EventKind>(event.kind());
    if ((kind != EventKind::kJoin && kind != EventKind::kLeave) || event.seat() >= seats) {
      return refuse<InputFrame>(error, "event " + std::to_string(static_cast<int>(kind)) +
                                           " of seat " + std::to_string(event.seat()));
    }
    frame.events.push_back({kind, event.seat()});
  }
  return frame;
}

std::optional<Snapshot> read(const wire::Snapshot& from, std::string&) {
  Snapshot snapshot{from.tick(), from.digest(), {}};
  if (from.state() != nullptr) {
    const auto* bytes = reinterpret_cast<const std::byte*>(from.state()->data());
    snapshot.state.assign(bytes, bytes + from.state()->size());
  }
  return snapshot;
}

std::optional<Pong> read(const wire::Pong& from, std::string&) {
  return Pong{from.token(), from.tick()};
}

/// The body, if it is one of the wanted type, in the variant of its direction.
template <class Message, class Table>
void take(const Table* table, Decoded<Message>& into) {
  if (table == nullptr) {
    into.error = "a message without a body";
    return;
  }
  auto body = read(*table, into.error);
  if (body) into.message.emplace(std::move(*body));
}

}  // namespace

Bytes encode(const ClientMessage& message) {
  Builder builder(256);
  const auto body = std::visit([&](const auto& said) { return build(said, builder); }, message);
  const auto type = static_cast<wire::ClientBody>(message.index() + 1);
  const auto root = wire::CreateClientMessage(builder, type, body);
  wire::FinishClientMessageBuffer(builder, root);
  return with_prefix(builder);
}

Bytes encode(const ServerMessage& message) {
  Builder builder(256);
  const auto body = std::visit([&](const auto& said) { return build(said, builder); }, message);
  const auto type = static_cast<wire::ServerBody>(message.index() + 1);
  const auto root = wire::CreateServerMessage(builder, type, body);
  wire::FinishServerMessageBuffer(builder, root);
  return with_prefix(builder);
}

Decoded<ClientMessage> decode_client(std::span<const std::byte> payload) {
  Decoded<ClientMessage> decoded;
  if (!fits(payload.size(), kClientMessageBytesMax, decoded.error)) return decoded;
  const Aligned aligned(payload);
  const auto* root = verified<wire::ClientMessage>(aligned, wire::ClientMessageIdentifier(),
                                                   kClientTablesMax, decoded.error);
  if (root == nullptr) return decoded;
  switch (root->body_type()) {
    case wire::ClientBody::Hello:
      take(root->body_as_Hello(), decoded);
      break;
    case wire::ClientBody::Input:
      take(root->body_as_Input(), decoded);
      break;
    case wire::ClientBody::Digest:
      take(root->body_as_Digest(), decoded);
      break;
    case wire::ClientBody::Ping:
      take(root->body_as_Ping(), decoded);
      break;
    case wire::ClientBody::Bye:
      take(root->body_as_Bye(), decoded);
      break;
    default:
      decoded.error = "a body of an unknown type";
  }
  return decoded;
}

Decoded<ServerMessage> decode_server(std::span<const std::byte> payload) {
  Decoded<ServerMessage> decoded;
  if (!fits(payload.size(), kServerMessageBytesMax, decoded.error)) return decoded;
  const Aligned aligned(payload);
  const auto* root = verified<wire::ServerMessage>(aligned, wire::ServerMessageIdentifier(),
                                                   kServerTablesMax, decoded.error);
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
    default:
      decoded.error = "a body of an unknown type";
  }
  return decoded;
}

}  // namespace cycloid::protocol
