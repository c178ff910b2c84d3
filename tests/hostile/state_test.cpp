#include <gtest/gtest.h>

#include <random>

#include "protocol/state/exact_delta.hpp"
#include "protocol/state/quantised_delta.hpp"
#include "tests/hostile/allocations.hpp"
#include "tests/hostile/matches.hpp"

namespace cycloid::hostile {
namespace {

using Delta = std::vector<std::byte>;

/// A head that is taken, then anything: noise, runs of equal bytes, nothing.
Delta hostile_delta(std::byte head, std::size_t head_bytes, std::mt19937& random) {
  Delta delta(head_bytes, head);
  const std::size_t size = random() % 64;
  const auto fill = static_cast<std::byte>(random() % 3 == 0 ? 0xff : random() % 256);
  const bool noise = random() % 2 == 0;
  for (std::size_t i = 0; i < size; ++i)
    delta.push_back(noise ? static_cast<std::byte>(random()) : fill);
  return delta;
}

TEST(StateAllocations, OfAnExactDeltaAreBoundedByTheCaller) {
  constexpr std::size_t kLimit = 1u << 20;
  constexpr std::size_t kModels = 1u << 19;  // What a coder learns; the same for any state.
  std::mt19937 random(51);
  for (int round = 0; round < 2000; ++round) {
    const Delta delta = hostile_delta(std::byte{0x12}, 5, random);
    reset_allocations();
    EXPECT_FALSE(protocol::decode_exact_delta({}, delta, kLimit));
    ASSERT_LE(allocations().peak_bytes, 2 * kLimit + kModels);
  }
  // A state that is too large is refused before there is room for it.
  const auto scene = catalogue_scene("pyramid-20");
  Delta state;
  Delta delta;
  scenes::Simulation::create(scene).value().encode(state);
  ASSERT_TRUE(protocol::encode_exact_delta({}, state, delta));
  reset_allocations();
  EXPECT_FALSE(protocol::decode_exact_delta({}, delta, state.size() - 1));
  EXPECT_LE(allocations().peak_bytes, 4096u);
}

TEST(StateAllocations, OfAQuantisedDeltaAreBoundedByTheCaller) {
  constexpr std::size_t kBodies = 1000;
  // The list that comes grows as it is heard, then the two lists are merged.
  constexpr std::size_t kBytesMax = 6 * kBodies * sizeof(protocol::QuantisedBody) + (1u << 16);
  std::mt19937 random(52);
  for (int round = 0; round < 20'000; ++round) {
    const Delta delta = hostile_delta(static_cast<std::byte>(0x10 | (random() % 8)), 1, random);
    reset_allocations();
    const auto read = protocol::decode_quantised(nullptr, 1, delta, kBodies);
    ASSERT_LE(allocations().peak_bytes, kBytesMax);
    if (read) {
      ASSERT_LE(read->bodies.size(), kBodies);
    }
  }
}

}  // namespace
}  // namespace cycloid::hostile
