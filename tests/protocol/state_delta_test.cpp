#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "protocol/state/quantised_delta.hpp"
#include "tests/protocol/state_scenes.hpp"

namespace cycloid::protocol {
namespace {

using states::Encoding;
using states::Played;

constexpr std::size_t kAnyBytes = 1u << 20;
constexpr std::size_t kBodiesMax = 4096;

Encoding delta_of(const QuantisedState* baseline, const QuantisedState& now) {
  const HeldState held = baseline == nullptr ? HeldState{} : HeldState{*baseline, {}};
  return encode_quantised(baseline == nullptr ? nullptr : &held, now, kAnyBytes).bytes;
}

void expect_same(const QuantisedState* baseline, const QuantisedState& now) {
  const auto read = decode_quantised(baseline, now.tick, delta_of(baseline, now), kBodiesMax);
  ASSERT_TRUE(read);
  ASSERT_EQ(*read, now);
  ASSERT_EQ(digest_of(*read), digest_of(now));
}

TEST(QuantisedDelta, IsTheStateAgainstAnyBaseline) {
  std::mt19937 random(21);
  for (const std::string& name : states::names()) {
    for (const bool velocities : {false, true}) {
      SCOPED_TRACE(name);
      Played played(name);
      std::vector<QuantisedState> past = {capture(played.simulation(), {velocities})};
      for (int tick = 0; tick < 120; ++tick) {
        played.step_wildly(random);
        const QuantisedState now = capture(played.simulation(), {velocities});
        const std::size_t back = 1 + random() % std::min<std::size_t>(20, past.size());
        expect_same(random() % 20 == 0 ? nullptr : &past[past.size() - back], now);
        past.push_back(now);
      }
    }
  }
}

/// Numbers that no scene has: extremes, slots that change hands, gaps.
QuantisedState any_state(std::mt19937& random) {
  QuantisedState state;
  state.tick = random() % 1000;
  const auto extreme = [&] {
    const std::int32_t kEdges[] = {INT32_MIN, INT32_MAX, 0, 1, -1};
    return random() % 3 == 0 ? kEdges[random() % 5] : static_cast<std::int32_t>(random());
  };
  const auto small = [&] { return static_cast<std::int16_t>(random()); };
  for (std::uint32_t index = 0; index < 40; ++index) {
    if (random() % 3 == 0) continue;
    QuantisedBody body;
    body.index = index == 39 ? 0xffffffffu : index;
    body.generation = static_cast<std::uint32_t>(extreme());
    for (std::int32_t& steps : body.position) steps = extreme();
    for (std::int16_t& steps : body.velocity) steps = small();
    body.at_rest = random() % 2 == 0;
    if (random() % 2 == 0) state.particles.push_back(body);
    body.rotation.largest = static_cast<std::uint8_t>(random() % 4);
    for (std::int16_t& part : body.rotation.parts)
      part = static_cast<std::int16_t>(static_cast<int>(random() % 1023) - kRotationParts);
    for (std::int16_t& steps : body.spin) steps = small();
    state.bodies.push_back(body);
  }
  state.characters.resize(random() % 4);
  for (QuantisedCharacter& character : state.characters) {
    for (std::int32_t& steps : character.position) steps = extreme();
    for (std::int16_t& steps : character.velocity) steps = small();
    character.grounded = random() % 2 == 0;
  }
  return state;
}

TEST(QuantisedDelta, IsTheStateForAnyNumbers) {
  std::mt19937 random(22);
  for (int round = 0; round < 2000; ++round) {
    const QuantisedState before = any_state(random);
    const QuantisedState now = any_state(random);
    expect_same(random() % 5 == 0 ? nullptr : &before, now);
  }
}

TEST(QuantisedDelta, OfNothingNewIsNoByte) {
  Played played("cubes-901");
  played.idle(400);
  const QuantisedState before = capture(played.simulation());
  played.idle(1);
  const QuantisedState now = capture(played.simulation());
  EXPECT_TRUE(delta_of(&before, now).empty());
  expect_same(&before, now);
  EXPECT_FALSE(decode_quantised(nullptr, 5, {}, kBodiesMax));
}

/// Two states of a scene some ticks apart and the delta between them.
struct DeltaSpecimen {
  QuantisedState before;
  QuantisedState now;
  Encoding delta;
};

DeltaSpecimen delta_specimen(const std::string& name) {
  Played played(name);
  std::mt19937 random(23);
  for (int i = 0; i < 40; ++i) played.step_wildly(random);
  DeltaSpecimen made{capture(played.simulation()), {}, {}};
  for (int i = 0; i < 4; ++i) played.step_wildly(random);
  made.now = capture(played.simulation());
  made.delta = delta_of(&made.before, made.now);
  return made;
}

void expect_refused(const DeltaSpecimen& made, const Encoding& damaged) {
  const auto read = decode_quantised(&made.before, made.now.tick, damaged, kBodiesMax);
  // Another way to say the same is no damage.
  if (read && *read != made.now) {
    ASSERT_NE(digest_of(*read), digest_of(made.now));
  }
}

TEST(QuantisedDelta, CutOrFlippedItIsRefusedOrTheDigestRefusesIt) {
  for (const char* name : {"stack-10-3d", "character-course-3d", "ragdolls", "cloth"}) {
    SCOPED_TRACE(name);
    const DeltaSpecimen made = delta_specimen(name);
    ASSERT_GT(made.delta.size(), 10u);
    for (std::size_t size = 0; size < made.delta.size(); ++size) {
      const Encoding cut(made.delta.begin(),
                         made.delta.begin() + static_cast<std::ptrdiff_t>(size));
      expect_refused(made, cut);
      const auto read = decode_quantised(&made.before, made.now.tick, cut, kBodiesMax);
      EXPECT_TRUE(!read || *read != made.now) << "cut to " << size << " and still whole";
    }
    for (std::size_t bit = 0; bit < 8 * made.delta.size(); ++bit) {
      Encoding damaged = made.delta;
      damaged[bit / 8] ^= static_cast<std::byte>(1u << (bit % 8));
      expect_refused(made, damaged);
    }
    Encoding longer = made.delta;
    longer.resize(longer.size() + 8, std::byte{1});
    EXPECT_FALSE(decode_quantised(&made.before, made.now.tick, longer, kBodiesMax));
  }
}

TEST(QuantisedDelta, AgainstTheWrongBaselineTheDigestRefusesIt) {
  const DeltaSpecimen made = delta_specimen("stack-10-3d");
  EXPECT_FALSE(decode_quantised(nullptr, made.now.tick, made.delta, kBodiesMax));
  const QuantisedState planar = capture(Played("stack-10").simulation());
  EXPECT_FALSE(decode_quantised(&planar, made.now.tick, made.delta, kBodiesMax));
  const auto later = decode_quantised(&made.now, made.now.tick, made.delta, kBodiesMax);
  EXPECT_TRUE(!later || digest_of(*later) != digest_of(made.now));
}

TEST(QuantisedDelta, OfMoreBodiesThanAllowedIsRefused) {
  Played played("pyramid-20");
  const QuantisedState now = capture(played.simulation());
  const Encoding delta = delta_of(nullptr, now);
  EXPECT_TRUE(decode_quantised(nullptr, 0, delta, now.bodies.size()));
  EXPECT_FALSE(decode_quantised(nullptr, 0, delta, now.bodies.size() - 1));
  // A count of 2^32 - 1 in a few bytes.
  const Encoding hostile = {std::byte{0x11}, std::byte{0xff}, std::byte{0xff}, std::byte{0xff},
                            std::byte{0xff}, std::byte{0xff}, std::byte{0xff}, std::byte{0xff}};
  EXPECT_FALSE(decode_quantised(nullptr, 0, hostile, kBodiesMax));
}

/// Bytes per tick of a scene's script, acknowledged `lag` ticks late.
struct Traffic {
  double bytes_per_tick = 0.0;
  double bytes_per_moving = 0.0;
};

Traffic traffic(Played& played, int ticks, std::size_t lag) {
  std::vector<QuantisedState> past;
  std::size_t bytes = 0;
  std::size_t moving = 0;
  for (int tick = 0; tick < ticks; ++tick) {
    past.push_back(capture(played.simulation()));
    played.step();
    const QuantisedState& base = past[past.size() - std::min(lag, past.size())];
    const QuantisedState now = capture(played.simulation());
    bytes += delta_of(&base, now).size();
    for (std::size_t i = 0; i < now.bodies.size(); ++i) moving += now.bodies[i].at_rest ? 0 : 1;
  }
  return {static_cast<double>(bytes) / ticks,
          static_cast<double>(bytes) / static_cast<double>(std::max<std::size_t>(1, moving))};
}

TEST(QuantisedDelta, OfGaffersSceneFitsInto256KilobitsASecond) {
  Played played("cubes-901");
  // 533 bytes a tick at 60 Hz; acknowledged after 100 ms.
  EXPECT_LE(traffic(played, 600, 6).bytes_per_tick, 533.0);
}

TEST(QuantisedDelta, OfAMovingBodyIsAtMostEightBytes) {
  for (const char* name : {"cubes-901", "ball-pit-3d", "ragdolls-3d"}) {
    Played played(name);
    std::mt19937 random(24);
    played.step(30);
    played.kick_all(4.0f, random);
    const Traffic all = traffic(played, 60, 1);
    EXPECT_LE(all.bytes_per_moving, 8.0) << name;
    std::printf("%s, all kicked: %.0f bytes a tick, %.2f a moving body\n", name, all.bytes_per_tick,
                all.bytes_per_moving);
  }
}

TEST(QuantisedDelta, IsTheSameForTheSameArguments) {
  const DeltaSpecimen made = delta_specimen("ragdolls");
  for (const std::size_t budget : {64u, 100u, 4096u}) {
    const HeldState held{made.before, {}};
    const QuantisedDelta once = encode_quantised(&held, made.now, budget);
    const QuantisedDelta again = encode_quantised(&held, made.now, budget);
    EXPECT_EQ(once.bytes, again.bytes);
    EXPECT_EQ(once.held.state, again.held.state);
    EXPECT_EQ(once.held.waiting, again.held.waiting);
  }
}

}  // namespace
}  // namespace cycloid::protocol
