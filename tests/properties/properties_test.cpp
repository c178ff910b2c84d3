#include <gtest/gtest.h>
#include <rapidcheck/detail/TestListenerAdapter.h>

#include <charconv>
#include <chrono>
#include <cstdlib>
#include <string_view>

#include "tests/properties/generate.hpp"
#include "tests/properties/play.hpp"

namespace cycloid::properties {
namespace {

/// A number from the environment; a wrong one fails, so that no night runs nothing.
std::uint64_t from_environment(const char* name, std::uint64_t otherwise) {
  const char* text = std::getenv(name);
  if (text == nullptr || *text == '\0') return otherwise;
  std::uint64_t value = 0;
  const std::string_view view(text);
  const auto read = std::from_chars(view.data(), view.data() + view.size(), value);
  EXPECT_TRUE(read.ec == std::errc() && read.ptr == view.data() + view.size() && value > 0)
      << name << " is \"" << text << "\" instead of a number above 0";
  return value;
}

/// What a search over many cases came to.
struct Found {
  bool failed = false;
  Case smallest;  ///< The last failing one: shrinking went no further.
  std::string report;
  Played played;
};

Found search(int dimension, Flaw flaw, std::uint64_t count, std::uint64_t seed) {
  Found found;
  const auto property = [&] {
    const Case example = *cases(dimension, flaw == Flaw::kNone);
    const Played played = play(example, flaw);
    found.played.add(played);
    if (played.failure.empty()) return;
    found.failed = true;
    found.smallest = example;
    found.report = played.failure;
    RC_FAIL(played.failure);
  };
  rc::detail::TestParams parameters;
  parameters.seed = seed;
  parameters.maxSuccess = static_cast<int>(count);
  rc::detail::TestListenerAdapter listener;
  const rc::detail::TestResult result = rc::detail::checkProperty(
      rc::detail::toProperty(property), rc::detail::TestMetadata{}, parameters, listener);
  rc::detail::SuccessResult success;
  if (!found.failed && !result.match(success)) {
    std::ostringstream text;
    rc::detail::printResultMessage(result, text);
    found.failed = true;
    found.report = text.str();
  }
  return found;
}

std::string show(const Found& found) {
  std::ostringstream text;
  text << found.report << "\nthe smallest case that was found to fail:\n" << found.smallest;
  return text.str();
}

class Properties : public testing::TestWithParam<int> {};

TEST_P(Properties, AnyCallsInAnySettingWithAnyRestoresAreTheSame) {
  const std::uint64_t count = from_environment("CYCLOID_CASES", 270) / 2;
  const std::uint64_t seed = from_environment("CYCLOID_SEED", 1);
  const auto begin = std::chrono::steady_clock::now();
  const Found found = search(GetParam(), Flaw::kNone, count, seed);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  const Played& played = found.played;
  std::printf(
      "%dD: %llu cases from seed %llu in %.1f s: %llu ticks, %llu calls (%llu refused), "
      "%llu cases faulted; per tick %.1f contacts, %.2f joints, %.1f asleep, %.2f particles, "
      "%.2f links; %llu ticks with more than 64 contacts, %llu with more than 64 asleep, "
      "%llu in fewer substeps\n",
      GetParam(), static_cast<unsigned long long>(played.cases),
      static_cast<unsigned long long>(seed), seconds.count(),
      static_cast<unsigned long long>(played.ticks), static_cast<unsigned long long>(played.calls),
      static_cast<unsigned long long>(played.refused),
      static_cast<unsigned long long>(played.faulted),
      double(played.contacts) / double(played.ticks), double(played.joints) / double(played.ticks),
      double(played.asleep) / double(played.ticks), double(played.particles) / double(played.ticks),
      double(played.links) / double(played.ticks),
      static_cast<unsigned long long>(played.crowded_ticks),
      static_cast<unsigned long long>(played.resting_ticks),
      static_cast<unsigned long long>(played.paced_ticks));
  ASSERT_FALSE(found.failed) << "CYCLOID_SEED=" << seed << " CYCLOID_CASES=" << 2 * count << '\n'
                             << show(found);
  // Dull cases would prove nothing.
  EXPECT_GT(played.contacts, played.ticks);
  EXPECT_GT(played.joints, played.ticks / 20);
  EXPECT_GT(played.particles, played.ticks / 20);
  EXPECT_GT(played.links, played.ticks / 20);
  EXPECT_GT(played.asleep, played.ticks / 20);
  EXPECT_GT(played.crowded_ticks, played.ticks / 100);
  EXPECT_GT(played.resting_ticks, 0u);
  EXPECT_GT(played.paced_ticks, played.ticks / 1000);
  EXPECT_LT(played.refused, played.calls / 2);
  EXPECT_LT(played.faulted, played.cases / 4);
}

INSTANTIATE_TEST_SUITE_P(Dimensions, Properties, testing::Values(2, 3));

struct Known {
  Flaw flaw;
  std::size_t commands_max;  ///< That the smallest case may have.
};

class KnownFlaw : public testing::TestWithParam<Known> {};

// The test of the test: a restore that is wrong in one thing is found, and shrinks to the few
// commands that matter.
TEST_P(KnownFlaw, IsFoundAndShrinksToAFewCommands) {
  for (const int dimension : {2, 3}) {
    const Found found = search(dimension, GetParam().flaw, 200, 1);
    ASSERT_TRUE(found.failed) << "in " << found.played.cases << " cases nothing was found";
    EXPECT_LE(found.smallest.commands.size(), GetParam().commands_max) << show(found);
    EXPECT_FALSE(play(found.smallest, GetParam().flaw).failure.empty());
    EXPECT_EQ(play(found.smallest).failure, "") << "the flaw is not what made it fail";
  }
}

// A body and its restore; with a force between them; two bodies made and destroyed, and the
// restore; two that touch, or one and the ground, a tick, the restore.
INSTANTIATE_TEST_SUITE_P(Flaws, KnownFlaw,
                         testing::Values(Known{Flaw::kLowestBit, 2},
                                         Known{Flaw::kForgottenForces, 3},
                                         Known{Flaw::kFreeListReversed, 5},
                                         Known{Flaw::kForgottenMemory, 4}));

TEST(PropertyCase, IsShownAsCodeThatMakesItAgain) {
  const Case example{
      2, 3, 1, 9, {1, 4, 0}, {8, 16, 3}, {{Op::kCreateBody, 0, 0, {1, 2}}, {Op::kStep, 2, 0, {}}}};
  std::ostringstream text;
  text << example;
  EXPECT_EQ(text.str(),
            "Case{2, 3, 1, 9, {1, 4, 0}, {8, 16, 3}, {\n"
            "    {Op::kCreateBody, 0, 0, {1, 2, 0, 0, 0, 0, 0, 0}},  // dynamic of 1 shapes at "
            "0.07 0.14\n"
            "    {Op::kStep, 2, 0, {0, 0, 0, 0, 0, 0, 0, 0}},  // 3 ticks\n"
            "}}");
}

}  // namespace
}  // namespace cycloid::properties
