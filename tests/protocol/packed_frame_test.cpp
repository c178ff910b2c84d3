#include "protocol/wire/packed_frame.hpp"

#include <gtest/gtest.h>

#include "tests/protocol/samples.hpp"

namespace cycloid::protocol {
namespace {

std::vector<std::byte> packed(const InputFrame& frame) {
  std::vector<std::byte> bytes;
  pack_frame(frame, bytes);
  return bytes;
}

std::optional<InputFrame> unpacked(const std::vector<std::byte>& bytes) {
  std::string error;
  auto frame = unpack_frame(bytes, error);
  EXPECT_EQ(frame.has_value(), error.empty()) << error;
  return frame;
}

/// Eight players who push to one side each, as in `./dev load`.
InputFrame frame_of_eight() {
  InputFrame frame;
  frame.tick = 18'000;
  for (int seat = 0; seat < 8; ++seat) {
    const auto axis = static_cast<std::int16_t>(seat % 2 == 0 ? 20'000 : -20'000);
    frame.seats.push_back({Origin::kGiven, {{axis, 0, 0, 0}, 0}});
  }
  return frame;
}

InputFrame largest_frame() {
  InputFrame frame;
  frame.tick = kTickEnd - 1;
  for (std::uint32_t seat = 0; seat < scenes::kSeatsMax; ++seat) {
    const auto origin = static_cast<Origin>(seat % 4 + 1);
    frame.seats.push_back({origin, {{-1, 32767, -32768, 1}, 0xffff}});
    frame.events.push_back({EventKind::kResume, static_cast<std::uint16_t>(seat)});
  }
  frame.changes.assign(kFrameChangesMax, {ChangeKind::kInputDelay, ~std::uint32_t{0}});
  return frame;
}

TEST(PackedFrame, ComesBackAsItWas) {
  InputFrame nothing;
  nothing.tick = 1;
  InputFrame changed = frame_of_eight();
  changed.changes = {{ChangeKind::kInputDelay, 300}};
  for (const InputFrame& frame :
       {nothing, samples::frame(101), frame_of_eight(), changed, largest_frame()}) {
    EXPECT_EQ(unpacked(packed(frame)), frame);
    const Bytes message = encode_packed(frame);
    const auto decoded = decode_server(samples::payload_of(message));
    ASSERT_TRUE(decoded.message) << decoded.error;
    EXPECT_EQ(std::get<InputFrame>(*decoded.message), frame);
  }
}

TEST(PackedFrame, OfEightPlayersHas80Bytes) {
  EXPECT_EQ(encode_packed(frame_of_eight()).size(), 80u);
  EXPECT_EQ(encode(ServerMessage(frame_of_eight())).size(), 172u);
}

/// One form of a frame, and nothing else: whatever is flipped or cut is refused, or another frame
/// whose form it is.
TEST(PackedFrame, HasOneForm) {
  int refused = 0;
  for (const InputFrame& frame : {samples::frame(101), frame_of_eight()}) {
    std::vector<std::byte> bytes = packed(frame);
    for (std::size_t bit = 0; bit < bytes.size() * 8; ++bit) {
      bytes[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
      const auto other = unpacked(bytes);
      refused += other ? 0 : 1;
      if (other) {
        EXPECT_EQ(packed(*other), bytes) << bit;
      }
      bytes[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
    }
    for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
      const auto other = unpacked({bytes.begin(), bytes.begin() + static_cast<long>(cut)});
      if (other) {
        EXPECT_EQ(packed(*other).size(), cut);
      }
    }
  }
  EXPECT_GT(refused, 30);
}

TEST(PackedFrame, WhatIsNoneIsRefused) {
  const auto refused = [](std::initializer_list<int> numbers) {
    std::vector<std::byte> bytes;
    for (const int number : numbers) bytes.push_back(static_cast<std::byte>(number));
    return !unpacked(bytes);
  };
  EXPECT_FALSE(refused({1, 0}));
  EXPECT_TRUE(refused({}));
  EXPECT_TRUE(refused({0, 0})) << "tick 0";
  EXPECT_TRUE(refused({0x81, 0x00, 0})) << "a tick in more bytes than it needs";
  EXPECT_TRUE(refused({1, 0, 0, 0})) << "no events and no changes, said";
  EXPECT_TRUE(refused({1, 0x81, 0x02})) << "257 seats";
  EXPECT_TRUE(refused({1, 3, 0})) << "three seats in a byte";
  EXPECT_TRUE(refused({1, 1, 0x04, 0, 0})) << "an axis that is not zero, and zero";
  EXPECT_TRUE(refused({1, 1, 0x40, 0})) << "buttons that are not zero, and zero";
  EXPECT_TRUE(refused({1, 1, 0x40, 0x80, 0x80, 0x04})) << "17 buttons";
  EXPECT_TRUE(refused({1, 1, 0x80})) << "the bit that is zero";
  EXPECT_FALSE(refused({1, 1, 0, 1, 1, 0, 0})) << "seat 0 joins";
  EXPECT_TRUE(refused({1, 1, 0, 1, 1, 1, 0})) << "an event of a seat that is not there";
  EXPECT_TRUE(refused({1, 1, 0, 1, 6, 0, 0})) << "an event of no kind";
  EXPECT_TRUE(refused({1, 0, 0, 1, 1, 0})) << "a change to 0";
  EXPECT_TRUE(refused({1, 0, 0, 1, 2, 1})) << "a change of no kind";
  EXPECT_TRUE(refused({0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x02, 0}))
      << "a tick of 65 bits";
}

}  // namespace
}  // namespace cycloid::protocol
