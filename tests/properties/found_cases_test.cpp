#include <gtest/gtest.h>

#include <string>

#include "tests/properties/play.hpp"

namespace cycloid::properties {
namespace {

/// A case that long searches have found to part, and what was wrong.
struct FoundCase {
  const char* name;
  bool faults;  ///< Whether it ends in a fault, in both settings the same.
  Case example;
};

class FoundCases : public testing::TestWithParam<FoundCase> {};

TEST_P(FoundCases, AreTheSame) {
  const Played played = play(GetParam().example);
  EXPECT_EQ(played.failure, "");
  EXPECT_EQ(played.faulted, GetParam().faults ? 1u : 0u);
}

const FoundCase kFound[] = {
    // Friction under XPBD took arms that only a bouncing neighbour in the block had placed.
    {"XpbdBesideWhatBounces", false,
     Case{3,
          0,
          0,
          0,
          {8, 1},
          {8, 16},
          {{Op::kCreateBody, 0, 2, {}},
           {Op::kTuning, 29, 0, {}},
           {Op::kCreateGrid, 0, 0, {0, 0, 0, -69}},
           {Op::kStep, 5, 0, {}}}}},
    // A material lost its friction; whose block had no friction left kept the impulses of before.
    {"FrictionThatIsTakenAway", false,
     Case{2,
          0,
          1,
          0,
          {2, 1},
          {8, 8},
          {{Op::kCreateBody, 0, 0, {}},
           {Op::kGravity, 0, 0, {1, -31}},
           {Op::kCreateBody, 0, 0, {0, 64}},
           {Op::kStep, 0, 0, {}},
           {Op::kMaterial, 0, 0, {}},
           {Op::kCreateBody, 0, 0, {0, 44, 0, 0, 0, 81, 69}},
           {Op::kStep, 2, 0, {}}}}},
    // Rows whose arms had grown by 30 m in a tick threw bodies of 2 km/s out of what float holds.
    {"AFastBodyInAPile", false,
     Case{2,
          0,
          0,
          0,
          {8, 8},
          {3, 1},
          {{Op::kMaterial, 0, 0, {8}},
           {Op::kCreateGrid, 39, 9, {}},
           {Op::kSetVelocity, 35, 31, {-2, 36, 0, -4}},
           {Op::kStep, 1, 0, {}}}}},
    // Sums that left what float can hold: in lanes beside one another they came to other values,
    // and the fault was named after another body or field. Since guesses are bounded none leaves.
    {"AFaultInSpace", false,
     Case{3,
          675,
          1,
          0,
          {2, 16},
          {1, 1},
          {{Op::kCreateBody, 0, 0, {0, 0, 0, 0, 0, 0, 0, 1}},
           {Op::kCreateBody, 0, 0, {}},
           {Op::kCreateBody, 0, 0, {}},
           {Op::kCreateBody, 0, 0, {}},
           {Op::kCreateBody, 0, 7, {35, 86, 89, -100, 63, 71, -81, -88}},
           {Op::kSetPose, 1, 0, {0, 0, 33}},
           {Op::kStep, 6, 0, {}},
           {Op::kCreateJoint, 23, 0, {-48, -50, 89, 0, 0, -86}},
           {Op::kStep, 1, 0, {}}}}},
    // What does not roll kept an impulse of 1e-34 in a block with what does: the square of its
    // length was 0, so no bound held it.
    {"WhatDoesNotRollBesideWhatDoes", false,
     Case{3,
          184,
          1,
          2,
          {3, 4},
          {1, 8},
          {{Op::kCreateGrid, 0, 0, {0, -42, 0, -75}},
           {Op::kStep, 1, 0, {}},
           {Op::kCreateJoint, 59, 52, {-9, 0, 54, 0, 0, 95, 12}},
           {Op::kCreateBody, 0, 0, {}},
           {Op::kSetPose, 40, 0, {-46, -34, -61, 0, 0, 0, 0, 97}},
           {Op::kStep, 6, 0, {}}}}},
    // XPBD let what has no friction stick where the square of its slip was 0, in a block with what
    // has some.
    {"WhatDoesNotRubUnderXpbd", false,
     Case{3,
          614,
          2,
          12,
          {2, 16},
          {1, 1},
          {{Op::kCreateBody, 0, 0, {0, 0, 0, 0, -49, -70, 0, 61}},
           {Op::kCreateBody, 0, 0, {0, 0, 0, -69, 0, 0, 0, 5}},
           {Op::kCreateBody, 0, 0, {0, 0, 0, -67}},
           {Op::kCreateBody, 0, 0, {-23, 0, 0, 0, 0, 16, 85}},
           {Op::kCreateBody, 0, 11, {-13, 89, 29, 51, 77, 28, 24, -68}},
           {Op::kSetPose, 1, 0, {-19, -4, 51, 73, 95, -89, 61, -53}},
           {Op::kSetVelocity, 25, 3, {51, 46, -14, -94, -77, -100}},
           {Op::kStep, 1, 0, {}},
           {Op::kCreateJoint, 4, 31, {-7, -66, 69, -54, -78, 42, 58, 77}},
           {Op::kStep, 5, 0, {}}}}},
};

INSTANTIATE_TEST_SUITE_P(Found, FoundCases, testing::ValuesIn(kFound),
                         [](const auto& found) { return std::string(found.param.name); });

}  // namespace
}  // namespace cycloid::properties
