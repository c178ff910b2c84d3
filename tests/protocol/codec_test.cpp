#include "protocol/codec.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <variant>
#include <vector>

#include "protocol/utf8.hpp"
#include "tests/protocol/samples.hpp"

namespace cycloid::protocol {
namespace {

/// What is said again by who has understood it: FlatBuffers bytes of one encoder are equal exactly
/// when the messages are.
template <class Message>
Bytes again(const Decoded<Message>& decoded) {
  return decoded.message ? encode(*decoded.message) : Bytes{};
}

TEST(Codec, EveryClientMessageComesBack) {
  for (const ClientMessage& message : samples::client_messages()) {
    const Bytes bytes = encode(message);
    const auto decoded = decode_client(samples::payload_of(bytes));
    ASSERT_TRUE(decoded.message) << message.index() << ": " << decoded.error;
    EXPECT_EQ(decoded.message->index(), message.index());
    EXPECT_EQ(again(decoded), bytes) << message.index();
  }
}

TEST(Codec, EveryServerMessageComesBack) {
  for (const ServerMessage& message : samples::server_messages()) {
    const Bytes bytes = encode(message);
    const auto decoded = decode_server(samples::payload_of(bytes));
    ASSERT_TRUE(decoded.message) << message.index() << ": " << decoded.error;
    EXPECT_EQ(decoded.message->index(), message.index());
    EXPECT_EQ(again(decoded), bytes) << message.index();
  }
}

TEST(Codec, FieldsComeBackOneByOne) {
  const Bytes bytes = encode(ClientMessage(samples::hello()));
  const auto hello = std::get<Hello>(*decode_client(samples::payload_of(bytes)).message);
  EXPECT_EQ(hello.protocol_version, 1u);
  EXPECT_EQ(hello.solver_version, 7u);
  EXPECT_EQ(hello.scene_digest, 0x1122334455667788u);
  EXPECT_EQ(hello.mode, Mode::kSnapshot);
  EXPECT_EQ(hello.seat_wish, 3);
  EXPECT_EQ(hello.name, "Grüße");

  const Bytes frame_bytes = encode(ServerMessage(samples::frame(101)));
  const auto frame = std::get<InputFrame>(*decode_server(samples::payload_of(frame_bytes)).message);
  EXPECT_EQ(frame, samples::frame(101));

  const Bytes input_bytes = encode(ClientMessage(Input{9, {{1, -2, 3, -32768}, 6}}));
  const auto input = std::get<Input>(*decode_client(samples::payload_of(input_bytes)).message);
  EXPECT_EQ(input.input, (scenes::SeatInput{{1, -2, 3, -32768}, 6}));
}

/// The bytes of a hello for good: an old client must be able to say who it is.
TEST(Codec, GoldenHelloIsUnderstood) {
  constexpr std::uint8_t kGolden[] = {
      0x60, 0x00, 0x00, 0x00, 0x14, 0x00, 0x00, 0x00, 0x43, 0x59, 0x43, 0x4d, 0x00, 0x00, 0x00,
      0x00, 0x08, 0x00, 0x0c, 0x00, 0x07, 0x00, 0x08, 0x00, 0x08, 0x00, 0x00, 0x00, 0x00, 0x00,
      0x00, 0x01, 0x14, 0x00, 0x00, 0x00, 0x10, 0x00, 0x24, 0x00, 0x08, 0x00, 0x0c, 0x00, 0x18,
      0x00, 0x07, 0x00, 0x10, 0x00, 0x14, 0x00, 0x10, 0x00, 0x00, 0x00, 0x00, 0x00, 0x00, 0x02,
      0x01, 0x00, 0x00, 0x00, 0x07, 0x00, 0x00, 0x00, 0x03, 0x00, 0x00, 0x00, 0x10, 0x00, 0x00,
      0x00, 0x88, 0x77, 0x66, 0x55, 0x44, 0x33, 0x22, 0x11, 0x00, 0x00, 0x00, 0x00, 0x07, 0x00,
      0x00, 0x00, 0x47, 0x72, 0xc3, 0xbc, 0xc3, 0x9f, 0x65, 0x00};
  Bytes golden;
  for (const std::uint8_t byte : kGolden) golden.push_back(std::byte{byte});
  EXPECT_EQ(encode(ClientMessage(samples::hello())), golden);
  const auto decoded = decode_client(samples::payload_of(golden));
  ASSERT_TRUE(decoded.message) << decoded.error;
  EXPECT_EQ(again(decoded), golden);
}

/// Goal: no bytes make the decoder crash or accept what is out of range. Method: every single bit
/// flipped; what is still accepted must be a message that comes back as itself.
TEST(Codec, EveryBitFlipIsRefusedOrAMessage) {
  int refused = 0;
  for (const ClientMessage& message : samples::client_messages()) {
    const Bytes whole = encode(message);
    Bytes payload(whole.begin() + Framer::kPrefixBytes, whole.end());
    for (std::size_t bit = 0; bit < payload.size() * 8; ++bit) {
      payload[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
      const auto decoded = decode_client(payload);
      EXPECT_EQ(decoded.message.has_value(), decoded.error.empty());
      if (!decoded.message) ++refused;
      const Bytes once = again(decoded);
      if (decoded.message) {
        EXPECT_EQ(again(decode_client(samples::payload_of(once))), once);
      }
      payload[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
    }
  }
  EXPECT_GT(refused, 100);
}

TEST(Codec, EveryBitFlipOfTheServerIsRefusedOrAMessage) {
  int refused = 0;
  for (const ServerMessage& message : samples::server_messages()) {
    const Bytes whole = encode(message);
    Bytes payload(whole.begin() + Framer::kPrefixBytes, whole.end());
    for (std::size_t bit = 0; bit < payload.size() * 8; ++bit) {
      payload[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
      const auto decoded = decode_server(payload);
      EXPECT_EQ(decoded.message.has_value(), decoded.error.empty());
      if (!decoded.message) ++refused;
      const Bytes once = again(decoded);
      if (decoded.message) {
        EXPECT_EQ(again(decode_server(samples::payload_of(once))), once);
      }
      payload[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
    }
  }
  EXPECT_GT(refused, 100);
}

/// Each at an address of its own, so that a read past the end is one past an allocation, which the
/// sanitizers see; and at an odd one, where the numbers are not aligned.
TEST(Codec, EveryTruncationIsRefusedOrAMessage) {
  for (const ClientMessage& message : samples::client_messages()) {
    const Bytes whole = encode(message);
    for (std::size_t size = Framer::kPrefixBytes; size < whole.size(); ++size) {
      const Bytes cut(whole.begin() + Framer::kPrefixBytes,
                      whole.begin() + static_cast<std::ptrdiff_t>(size));
      const auto decoded = decode_client(cut);
      EXPECT_EQ(decoded.message.has_value(), decoded.error.empty()) << size;
    }
  }
  for (const ServerMessage& message : samples::server_messages()) {
    const Bytes whole = encode(message);
    for (std::size_t size = Framer::kPrefixBytes; size < whole.size(); ++size) {
      const Bytes cut(whole.begin() + Framer::kPrefixBytes,
                      whole.begin() + static_cast<std::ptrdiff_t>(size));
      const auto decoded = decode_server(cut);
      EXPECT_EQ(decoded.message.has_value(), decoded.error.empty()) << size;
    }
  }
}

TEST(Codec, AnyAddressWillDo) {
  const Bytes whole = encode(ClientMessage(samples::hello()));
  for (std::size_t shift = 0; shift < 8; ++shift) {
    Bytes moved(shift);
    moved.insert(moved.end(), whole.begin() + Framer::kPrefixBytes, whole.end());
    EXPECT_TRUE(decode_client(std::span<const std::byte>(moved).subspan(shift)).message) << shift;
  }
}

TEST(Codec, TheOtherDirectionIsRefused) {
  const Bytes digest = encode(ServerMessage(Digest{1, 2}));
  EXPECT_EQ(decode_client(samples::payload_of(digest)).error, "the file identifier is not CYCM");
  const Bytes ping = encode(ClientMessage(Ping{1}));
  EXPECT_EQ(decode_server(samples::payload_of(ping)).error, "the file identifier is not CYSM");
}

/// What fuzzing found: FlatBuffers verifies that the length of a vector is aligned, and not that
/// its elements are, which may be of 8 bytes.
TEST(Codec, DigestsThatAreNotAlignedAreRefused) {
  const Bytes honest = encode(ClientMessage(TickDigests{1, {0x1122334455667788u}}));
  const auto payload = samples::payload_of(honest);
  Bytes moved(payload.begin(), payload.end());
  const auto number_at = [&](std::size_t at) {
    std::uint32_t number = 0;
    std::memcpy(&number, moved.data() + at, sizeof number);
    return number;
  };
  const std::size_t vector =
      moved.size() - 12;  // Its length, then the one digest: all comes before.
  ASSERT_EQ(number_at(vector), 1u);
  ASSERT_EQ(number_at(vector + 4), 0x55667788u);
  int offsets = 0;
  for (std::size_t at = 0; at < vector; at += 4) {
    if (at + number_at(at) != vector) continue;
    const std::uint32_t farther = number_at(at) + 4;
    std::memcpy(moved.data() + at, &farther, sizeof farther);
    ++offsets;
  }
  ASSERT_EQ(offsets, 1);
  moved.insert(moved.begin() + static_cast<std::ptrdiff_t>(vector), 4, std::byte{});
  EXPECT_EQ(decode_client(moved).error, "digests that are not aligned");
}

TEST(Codec, ValuesOutOfRangeAreRefusedByName) {
  const auto client_error = [](const ClientMessage& message) {
    const Bytes bytes = encode(message);
    return decode_client(samples::payload_of(bytes)).error;
  };
  Hello hello = samples::hello();
  hello.mode = static_cast<Mode>(0);
  EXPECT_EQ(client_error(hello), "mode 0");
  hello.mode = static_cast<Mode>(3);
  EXPECT_EQ(client_error(hello), "mode 3");
  hello = samples::hello();
  hello.seat_wish = -3;
  EXPECT_EQ(client_error(hello), "seat wish -3");
  hello = samples::hello();
  hello.name = std::string(65, 'a');
  EXPECT_EQ(client_error(hello), "a name of 65 bytes, of at most 64");
  hello.name = "\xc0\x80";
  EXPECT_EQ(client_error(hello), "a name is not UTF-8");
  hello = samples::full_hello();
  hello.room = std::string(65, 'a');
  EXPECT_EQ(client_error(hello), "a room name of 65 bytes, of at most 64");
  hello = samples::full_hello();
  hello.token.resize(kTokenBytesMax + 1);
  EXPECT_EQ(client_error(hello), "a token of 513 bytes, of at most 512");
  hello = samples::full_hello();
  hello.resume.resize(31);
  EXPECT_EQ(client_error(hello), "a resume token of 31 bytes instead of 32");
  hello = samples::full_hello();
  hello.profile = static_cast<Profile>(3);
  EXPECT_EQ(client_error(hello), "profile 3");
  EXPECT_EQ(client_error(Input{0, {}}), "an input for tick 0");
  EXPECT_EQ(client_error(TickDigests{1, {}}), "0 digests from tick 1");
  const std::vector<std::uint64_t> many(kTickDigestsMax + 1);
  EXPECT_EQ(client_error(TickDigests{1, many}), "193 digests from tick 1");
  const std::vector<std::byte> part(5);
  EXPECT_EQ(client_error(StatePart{1, 8, 4, part}), "a part of 5 bytes at 4 of 8");
  EXPECT_EQ(client_error(StatePart{1, 8, 0xffffffff, part}),
            "a part of 5 bytes at 4294967295 of 8");
  EXPECT_EQ(client_error(StatePart{1, 8, 4, {}}), "a part of 0 bytes at 4 of 8");

  const auto server_error = [](const ServerMessage& message) {
    const Bytes bytes = encode(message);
    return decode_server(samples::payload_of(bytes)).error;
  };
  EXPECT_EQ(server_error(Welcome{4, 4, 0, 60000, 2}), "seat 4 of 4");
  EXPECT_EQ(server_error(Welcome{-1, 4, 0, 60000, 2}), "seat -1 of 4");
  EXPECT_EQ(server_error(Welcome{0, 257, 0, 60000, 2}), "257 seats");
  EXPECT_EQ(server_error(Welcome{0, 4, 0, 0, 2}), "a tick rate of 0");
  EXPECT_EQ(server_error(Refused{static_cast<Refusal>(23), ""}), "refusal 23");
  EXPECT_EQ(server_error(Refused{static_cast<Refusal>(0), ""}), "refusal 0");

  EXPECT_EQ(server_error(StateDelta{1, 2, 0, Profile::kExact, part}),
            "a delta of tick 1 from the later tick 2");
  EXPECT_EQ(server_error(SnapshotPart{1, 2, 4, 0, part}), "a part of 5 bytes at 0 of 4");
  EXPECT_EQ(server_error(StateWanted{0}), "the state of tick 0 is wanted");
  EXPECT_EQ(server_error(RoomNotice{static_cast<NoticeKind>(6), 1, 1, ""}), "notice 6");

  InputFrame frame = samples::frame(0);
  EXPECT_EQ(server_error(frame), "a frame of tick 0");
  frame = samples::frame(1);
  frame.seats.resize(257);
  EXPECT_EQ(server_error(frame), "a frame of 257 seats, 2 events and 1 changes");
  frame = samples::frame(1);
  frame.seats[1].origin = static_cast<Origin>(5);
  EXPECT_EQ(server_error(frame), "origin 5");
  frame = samples::frame(1);
  frame.events[0].seat = 3;
  EXPECT_EQ(server_error(frame), "event 1 of seat 3");
  frame = samples::frame(1);
  frame.changes[0].value = 0;
  EXPECT_EQ(server_error(frame), "change 1 to 0");
  frame = samples::frame(1);
  frame.events.resize(kFrameEventsMax + 1);
  EXPECT_EQ(server_error(frame), "a frame of 3 seats, 1025 events and 1 changes");
}

/// A client that counts up to a tick near the end of numbers would never come there.
TEST(Codec, TicksThatNoneHasAreRefused) {
  const auto client_error = [](const ClientMessage& message) {
    return decode_client(samples::payload_of(encode(message))).error;
  };
  const auto server_error = [](const ServerMessage& message) {
    return decode_server(samples::payload_of(encode(message))).error;
  };
  const std::vector<std::byte> part(4);
  for (const std::uint64_t tick : {kTickEnd, ~std::uint64_t{0}}) {
    const std::string error =
        "tick " + std::to_string(tick) + ", of less than " + std::to_string(kTickEnd);
    EXPECT_EQ(client_error(Input{tick, {}}), error);
    EXPECT_EQ(client_error(Digest{tick, 1}), error);
    EXPECT_EQ(client_error(Ack{tick}), error);
    EXPECT_EQ(client_error(TickDigests{tick, {1}}), error);
    EXPECT_EQ(client_error(StatePart{tick, 4, 0, part}), error);

    EXPECT_EQ(server_error(Welcome{0, 4, tick, 60000, 2}), error);
    EXPECT_EQ(server_error(samples::frame(tick)), error);
    EXPECT_EQ(decode_server(samples::payload_of(encode_packed(samples::frame(tick)))).error, error);
    EXPECT_EQ(server_error(Snapshot{tick, 1, part}), error);
    EXPECT_EQ(server_error(SnapshotPart{tick, 1, 4, 0, part}), error);
    EXPECT_EQ(server_error(StateDelta{tick, 0, 1, Profile::kExact, part}), error);
    EXPECT_EQ(server_error(Digest{tick, 1}), error);
    EXPECT_EQ(server_error(Pong{1, tick}), error);
    EXPECT_EQ(server_error(Margin{tick, 0, 0, 0}), error);
    EXPECT_EQ(server_error(StateWanted{tick}), error);
    EXPECT_EQ(server_error(RoomNotice{NoticeKind::kSlowed, tick, 1, ""}), error);
    EXPECT_EQ(server_error(RoomNotice{NoticeKind::kRewound, 1, tick, ""}), error);
  }
  EXPECT_EQ(client_error(Ack{kTickEnd - 1}), "");
  EXPECT_EQ(server_error(RoomNotice{NoticeKind::kSlowed, 1, kTickEnd, ""}), "") << "milliseconds";
}

TEST(Codec, SizesAreCheckedBeforeAnythingIsRead) {
  EXPECT_EQ(decode_client({}).error, "a payload of 0 bytes");
  EXPECT_EQ(decode_client(Bytes(7)).error, "a payload of 7 bytes");
  EXPECT_EQ(decode_client(Bytes(kClientMessageBytesMax + 1)).error, "a payload of 4097 bytes");
  EXPECT_EQ(decode_server({}).error, "a payload of 0 bytes");
}

TEST(Codec, LongReasonsAreCutBetweenCharacters) {
  const std::string reason = std::string(kReasonBytesMax - 1, 'x') + "ü";
  const Bytes bytes = encode(ServerMessage(Bye{reason}));
  const auto decoded = decode_server(samples::payload_of(bytes));
  ASSERT_TRUE(decoded.message) << decoded.error;
  EXPECT_EQ(std::get<Bye>(*decoded.message).reason, std::string(kReasonBytesMax - 1, 'x'));
}

TEST(Utf8, ShortestFormsOfRealCharactersOnly) {
  for (const char* good : {"", "abc", "\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf",
                           "\xee\x80\x80", "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"}) {
    EXPECT_TRUE(is_utf8(good)) << good;
  }
  for (const char* bad :
       {"\x80", "\xc1\xbf", "\xc2", "\xc2z", "\xe0\x9f\xbf", "\xed\xa0\x80", "\xe1\x80",
        "\xf0\x8f\xbf\xbf", "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff", "a\xe1\x80"}) {
    EXPECT_FALSE(is_utf8(bad)) << testing::PrintToString(bad);
  }
}

}  // namespace
}  // namespace cycloid::protocol
