#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "tests/protocol/samples.hpp"

namespace cycloid::protocol {
namespace {

Bytes prefix(std::uint32_t size) {
  Bytes bytes;
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::byte>(size >> (8 * i)));
  return bytes;
}

Bytes message_of(std::size_t size, int fill) {
  Bytes bytes = prefix(static_cast<std::uint32_t>(size));
  bytes.resize(bytes.size() + size, static_cast<std::byte>(fill));
  return bytes;
}

std::vector<Bytes> drain(Framer& framer) {
  std::vector<Bytes> payloads;
  while (const auto payload = framer.next())
    payloads.emplace_back(payload->begin(), payload->end());
  return payloads;
}

/// Goal: payloads do not depend on how the stream was cut. Method: all cuts into chunks of one
/// size, from 1 byte to the whole, and all cuts in two.
TEST(Framer, EverySegmentationGivesTheSamePayloads) {
  Bytes stream;
  std::vector<Bytes> expected;
  for (const std::size_t size : {1u, 8u, 3u, 100u, 2u}) {
    const Bytes message = message_of(size, static_cast<int>(size));
    stream.insert(stream.end(), message.begin(), message.end());
    expected.emplace_back(message.begin() + Framer::kPrefixBytes, message.end());
  }
  const std::span<const std::byte> all(stream);
  for (std::size_t chunk = 1; chunk <= stream.size(); ++chunk) {
    Framer framer(100);
    std::vector<Bytes> got;
    for (std::size_t at = 0; at < stream.size(); at += chunk) {
      ASSERT_TRUE(framer.feed(all.subspan(at, std::min(chunk, stream.size() - at))));
      for (Bytes& payload : drain(framer)) got.push_back(std::move(payload));
    }
    EXPECT_EQ(got, expected) << chunk;
    EXPECT_EQ(framer.held_bytes(), 0u);
  }
  for (std::size_t cut = 0; cut <= stream.size(); ++cut) {
    Framer framer(100);
    ASSERT_TRUE(framer.feed(all.first(cut)));
    std::vector<Bytes> got = drain(framer);
    ASSERT_TRUE(framer.feed(all.subspan(cut)));
    for (Bytes& payload : drain(framer)) got.push_back(std::move(payload));
    EXPECT_EQ(got, expected) << cut;
  }
}

TEST(Framer, ASizeOverTheLimitBreaksItForEver) {
  Framer framer(100);
  EXPECT_TRUE(framer.feed(message_of(100, 1)));
  EXPECT_EQ(drain(framer).size(), 1u);
  EXPECT_FALSE(framer.feed(prefix(101)));
  EXPECT_EQ(framer.announced_bytes(), 101u);
  EXPECT_FALSE(framer.feed(message_of(1, 1)));
  EXPECT_FALSE(framer.next());
  EXPECT_TRUE(framer.broken());
}

TEST(Framer, ZeroIsNoSize) {
  Framer framer(100);
  EXPECT_FALSE(framer.feed(prefix(0)));
  EXPECT_EQ(framer.announced_bytes(), 0u);
}

TEST(Framer, NothingIsReservedForAnAnnouncedSize) {
  Framer framer(0xffffffffu);
  EXPECT_TRUE(framer.feed(prefix(0xffffffffu)));  // 4 GiB, which would fail if it were.
  EXPECT_FALSE(framer.next());
  EXPECT_EQ(framer.held_bytes(), 4u);
}

TEST(Framer, ABadSizeBehindAGoodMessageSparesTheMessage) {
  Framer framer(100);
  Bytes both = message_of(5, 7);
  const Bytes bad = prefix(101);
  both.insert(both.end(), bad.begin(), bad.end());
  EXPECT_TRUE(framer.feed(both));
  EXPECT_EQ(framer.next()->size(), 5u);
  EXPECT_FALSE(framer.next());
  EXPECT_TRUE(framer.broken());
  EXPECT_FALSE(framer.feed({}));
}

TEST(Framer, TheLimitMayRiseBetweenTwoMessages) {
  Framer framer(5);
  Bytes both = message_of(5, 7);
  const Bytes larger = message_of(50, 8);
  both.insert(both.end(), larger.begin(), larger.end());
  EXPECT_TRUE(framer.feed(both));
  EXPECT_EQ(framer.next()->size(), 5u);
  framer.set_limit(50);
  EXPECT_EQ(framer.next()->size(), 50u);
  EXPECT_FALSE(framer.broken());
}

}  // namespace
}  // namespace cycloid::protocol
