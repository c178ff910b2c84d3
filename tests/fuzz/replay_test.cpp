#include <gtest/gtest.h>

#include <random>

#include "tests/fuzz/targets.hpp"

namespace cycloid::fuzz {

/// The same targets without libFuzzer: seeds, and seeded damage to them. A failure aborts with the
/// target and the number, which say how to make the input again.
class FuzzReplay : public testing::TestWithParam<FuzzTarget> {};

static void damage(std::mt19937& random, Seed& input) {
  const std::size_t changes = 1 + random() % 6;
  for (std::size_t i = 0; i < changes && !input.empty(); ++i) {
    const std::size_t at = random() % input.size();
    switch (random() % 5) {
      case 0:
        input[at] = static_cast<std::byte>(random());
        break;
      case 1:
        input[at] ^= static_cast<std::byte>(1u << (random() % 8));
        break;
      case 2:
        input.resize(at);
        break;
      case 3:
        for (std::size_t k = at; k < std::min(at + 4, input.size()); ++k)
          input[k] = std::byte{0xff};
        break;
      default:
        for (int k = 0; k < 16; ++k) input.push_back(static_cast<std::byte>(random()));
    }
  }
}

TEST_P(FuzzReplay, SeedsAndDamagedSeedsKeepThePromises) {
  constexpr int kInputs = 12000;
  const FuzzTarget& target = GetParam();
  const std::vector<Seed> seeds = target.seeds();
  ASSERT_FALSE(seeds.empty());
  for (const Seed& seed : seeds) target.run(seed);
  target.run({});
  std::mt19937 random(5);
  for (int i = 0; i < kInputs; ++i) {
    SCOPED_TRACE(i);
    Seed input = seeds[random() % seeds.size()];
    damage(random, input);
    target.run(input);
  }
}

INSTANTIATE_TEST_SUITE_P(Targets, FuzzReplay, testing::ValuesIn(targets()), [](const auto& of) {
  std::string name = of.param.name;
  std::erase(name, '-');
  return name;
});

TEST(FuzzTargets, EditsAreDeterministicAndReachEveryWord) {
  const Seed good(64, std::byte{0});
  Seed edits(8, std::byte{0});
  edits[0] = std::byte{3};
  edits[4] = std::byte{0x7f};
  const Seed once = edited(good, edits);
  EXPECT_EQ(once, edited(good, edits));
  EXPECT_EQ(once[12], std::byte{0x7f});
  EXPECT_EQ(find_target("no such"), nullptr);
}

}  // namespace cycloid::fuzz
