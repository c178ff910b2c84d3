#include "protocol/schema/client_message_generated.h"
#include "protocol/wire/buffer.hpp"

namespace cycloid::protocol {
namespace {

using wire_buffer::build;
using wire_buffer::read;

using namespace wire_buffer;

flatbuffers::Offset<void> build(const Hello& hello, Builder& to) {
  const auto name = to.CreateString(hello.name);
  const auto room = text_of(hello.room, to);
  const auto token = bytes_of(hello.token, to);
  const auto resume = bytes_of(hello.resume, to);
  const auto build_text = text_of(hello.build, to);
  return wire::CreateHello(to, hello.protocol_version, hello.solver_version, hello.scene_digest,
                           static_cast<wire::Mode>(hello.mode), hello.seat_wish, name,
                           hello.protocol_minor, room, token, resume, build_text,
                           static_cast<wire::Profile>(hello.profile))
      .Union();
}

flatbuffers::Offset<void> build(const Input& input, Builder& to) {
  const wire::SeatInput said = to_wire(input.input);
  return wire::CreateInput(to, input.tick, &said).Union();
}

flatbuffers::Offset<void> build(const Ping& ping, Builder& to) {
  return wire::CreatePing(to, ping.token).Union();
}

flatbuffers::Offset<void> build(const Ack& ack, Builder& to) {
  return wire::CreateAck(to, ack.tick).Union();
}

flatbuffers::Offset<void> build(const TickDigests& said, Builder& to) {
  const auto digests = to.CreateVector(said.digests);
  return wire::CreateTickDigests(to, said.first_tick, digests).Union();
}

flatbuffers::Offset<void> build(const StatePart& part, Builder& to) {
  const auto bytes = bytes_of(part.bytes, to);
  return wire::CreateStatePart(to, part.tick, part.total_bytes, part.offset, bytes).Union();
}

std::optional<Hello> read(const wire::Hello& from, std::string& error) {
  Hello hello;
  hello.protocol_version = from.protocol_version();
  hello.solver_version = from.solver_version();
  hello.scene_digest = from.scene_digest();
  hello.mode = static_cast<Mode>(from.mode());
  hello.seat_wish = from.seat_wish();
  hello.protocol_minor = from.protocol_minor();
  hello.profile = static_cast<Profile>(from.profile());
  if (hello.mode != Mode::kLockstep && hello.mode != Mode::kSnapshot) {
    return refuse<Hello>(error, "mode " + std::to_string(static_cast<int>(hello.mode)));
  }
  if (hello.seat_wish < kSpectator) {
    return refuse<Hello>(error, "seat wish " + std::to_string(hello.seat_wish));
  }
  if (!is_profile(hello.profile)) {
    return refuse<Hello>(error, "profile " + std::to_string(static_cast<int>(hello.profile)));
  }
  const bool good = read_text(from.name(), kNameBytesMax, "a name", hello.name, error) &&
                    read_text(from.room(), kRoomNameBytesMax, "a room name", hello.room, error) &&
                    read_text(from.build(), kBuildBytesMax, "a build", hello.build, error) &&
                    read_bytes(from.token(), kTokenBytesMax, "a token", hello.token, error) &&
                    read_resume(from.resume(), hello.resume, error);
  if (!good) return {};
  return hello;
}

std::optional<Input> read(const wire::Input& from, std::string& error) {
  if (from.tick() == 0) return refuse<Input>(error, "an input for tick 0");
  if (from.input() == nullptr) return refuse<Input>(error, "an input that says nothing");
  return Input{from.tick(), from_wire(*from.input())};
}

std::optional<Ping> read(const wire::Ping& from, std::string&) {
  return Ping{from.token()};
}

std::optional<Ack> read(const wire::Ack& from, std::string&) {
  return Ack{from.tick()};
}

std::optional<TickDigests> read(const wire::TickDigests& from, std::string& error) {
  const std::size_t count = from.digests() == nullptr ? 0 : from.digests()->size();
  if (from.first_tick() == 0 || count == 0 || count > kTickDigestsMax) {
    return refuse<TickDigests>(
        error, std::to_string(count) + " digests from tick " + std::to_string(from.first_tick()));
  }
  if (!is_aligned(*from.digests())) {
    return refuse<TickDigests>(error, "digests that are not aligned");
  }
  TickDigests said{from.first_tick(), {}};
  for (const std::uint64_t digest : *from.digests()) said.digests.push_back(digest);
  return said;
}

std::optional<StatePart> read(const wire::StatePart& from, std::string& error) {
  StatePart part{from.tick(), from.total_bytes(), from.offset(), {}};
  if (!read_bytes(from.bytes(), kStatePartBytesMax, "a part", part.bytes, error)) return {};
  if (!part_fits(part.total_bytes, part.offset, part.bytes.size(), error)) return {};
  return part;
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

Bytes encode(const ClientMessage& message) {
  Builder builder(256);
  const auto body = std::visit([&](const auto& said) { return build(said, builder); }, message);
  const auto type = static_cast<wire::ClientBody>(message.index() + 1);
  const auto root = wire::CreateClientMessage(builder, type, body);
  wire::FinishClientMessageBuffer(builder, root);
  return with_prefix(builder);
}

Decoded<ClientMessage> decode_client(std::span<const std::byte> payload) {
  Decoded<ClientMessage> decoded;
  if (!fits(payload.size(), kClientMessageBytesMax, decoded.error)) return decoded;
  const Aligned aligned(payload);
  const auto* root =
      verified<wire::ClientMessage>(aligned, wire::ClientMessageIdentifier(), decoded.error);
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
    case wire::ClientBody::Ack:
      take(root->body_as_Ack(), decoded);
      break;
    case wire::ClientBody::TickDigests:
      take(root->body_as_TickDigests(), decoded);
      break;
    case wire::ClientBody::StatePart:
      take(root->body_as_StatePart(), decoded);
      break;
    default:
      decoded.error = "a body of an unknown type";
  }
  return decoded;
}

}  // namespace cycloid::protocol
