#include "tests/determinism/rollback.hpp"

#include <random>

namespace cycloid::history {
namespace {

class Rollback : public SceneTest {};

/// The script, over which every seat now and then holds something of its own for a while.
Match wild_match(const Scene& scene, std::uint64_t ticks, std::uint32_t seed) {
  std::mt19937 random(seed);
  Match match;
  std::vector<SeatInput> held(scene.seats.size());
  std::vector<std::uint64_t> left(scene.seats.size(), 0);
  for (std::uint64_t tick = 1; tick <= ticks; ++tick) {
    std::vector<SeatInput>& inputs = match.emplace_back();
    for (std::size_t seat = 0; seat < held.size(); ++seat) {
      if (left[seat] == 0) {
        left[seat] = 16 + random() % 32;
        for (std::int16_t& axis : held[seat].axes) axis = static_cast<std::int16_t>(random());
        held[seat].buttons = static_cast<std::uint16_t>(random());
      }
      --left[seat];
      const bool wild = left[seat] % 2 == 0 || left[seat] > 4;
      inputs.push_back(wild ? held[seat]
                            : scenes::scripted_input(scene, static_cast<int>(seat), tick));
    }
  }
  return match;
}

TEST_P(Rollback, ConfirmedDigestsAreTheAuthoritysTickForTick) {
  const Scene scene = this->scene();
  const Match match = wild_match(scene, 110, 11);
  RollbackClient client(scene);
  expect_equal_in_rollback(match, digests_of(scene, match), 3, client);
  // Else it would have guessed right all the time and shown nothing.
  EXPECT_EQ(client.longest_rollback, kRollbackTicks);
  EXPECT_GT(client.wrong_digests, 0u);
}

INSTANTIATE_TEST_SUITE_P(Scenes, Rollback, testing::ValuesIn(scene_names()), scene_test_name);

// The harness itself: an authority that heard another input once is noticed.
TEST(RollbackClient, AnotherInputOfTheAuthorityIsNoticed) {
  const Scene scene = std::move(*scenes::find("half-pipe").scene);
  const Match match = wild_match(scene, 40, 11);
  Match other = match;
  other[20][1].axes[0] = static_cast<std::int16_t>(other[20][1].axes[0] ^ 0x4000);
  RollbackClient client(scene);
  for (std::uint64_t tick = 1; tick <= match.size(); ++tick) {
    for (std::size_t seat = 0; seat < scene.seats.size(); ++seat)
      client.hear(tick, seat, match[tick - 1][seat]);
    client.advance();
  }
  const std::vector<std::uint64_t> right = digests_of(scene, other);
  EXPECT_EQ(client.confirmed()[20], right[20]);
  EXPECT_NE(client.confirmed()[21], right[21]);
}

}  // namespace
}  // namespace cycloid::history
