#include <gtest/gtest.h>
#include <rapidcheck/detail/TestListenerAdapter.h>

#include <sstream>
#include <string>

#include "tests/properties/generate.hpp"
#include "tests/properties/player.hpp"

namespace cycloid::properties {
namespace {

/// What the cases were made of, so that dull ones are noticed.
struct Lively {
  std::uint64_t ticks = 0;
  std::uint64_t pairs = 0;
  std::uint64_t edits = 0;
};

/// One world goes on as it is; the other is restored before each tick, so it never has a candidate
/// for a pair from before.
template <int D>
std::string compare(const Case& example, Lively& lively) {
  Player<D> keeps(example, example.one, false, Flaw::kNone);
  Player<D> forgets(example, example.other, false, Flaw::kNone);
  for (std::size_t i = 0; i < example.commands.size(); ++i) {
    const Command& command = example.commands[i];
    if (command.op != Op::kStep) {
      (void)keeps.obey(command);
      (void)forgets.obey(command);
      ++lively.edits;
      continue;
    }
    for (std::uint32_t k = 0; k < 1 + command.a % 12; ++k) {
      forgets.forget();
      const Answer answer = keeps.step();
      if (answer != forgets.step()) return "step: " + text_of(answer);
      const std::string at =
          "command " + std::to_string(i) + ", tick " + std::to_string(keeps.world().tick()) + ": ";
      if (keeps.world().digest() != forgets.world().digest()) return at + "other bits";
      if (answer.code != solver::Code::kOk) return "";  // In its fault state it makes no tick.
      if (keeps.world().statistics().pairs != forgets.world().statistics().pairs)
        return at + "other pairs";
      ++lively.ticks;
      lively.pairs += keeps.world().statistics().pairs;
    }
  }
  return "";
}

class CandidatesKept : public testing::TestWithParam<int> {};

TEST_P(CandidatesKept, ShowNeitherInPairsNorInBitsWhateverIsEdited) {
  Lively lively;
  const auto property = [&] {
    const Case example = *cases(GetParam());
    const std::string failure =
        example.dimension == 2 ? compare<2>(example, lively) : compare<3>(example, lively);
    if (!failure.empty()) RC_FAIL(failure);
  };
  rc::detail::TestParams parameters;
  parameters.seed = 3;
  parameters.maxSuccess = 40;
  rc::detail::TestListenerAdapter listener;
  const rc::detail::TestResult result = rc::detail::checkProperty(
      rc::detail::toProperty(property), rc::detail::TestMetadata{}, parameters, listener);
  std::ostringstream text;
  rc::detail::printResultMessage(result, text);
  rc::detail::SuccessResult success;
  EXPECT_TRUE(result.match(success)) << text.str();
  EXPECT_GT(lively.pairs, lively.ticks);
  EXPECT_GT(lively.edits, lively.ticks / 10);
}

INSTANTIATE_TEST_SUITE_P(Dimensions, CandidatesKept, testing::Values(2, 3));

}  // namespace
}  // namespace cycloid::properties
