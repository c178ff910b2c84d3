#include "solver/stages/turn_freely.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>
#include <vector>

namespace cycloid::solver {

static Rotation<3> any_rotation(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return normalized_or(Rotation<3>{{normal(random), normal(random), normal(random), 1.0f}},
                       identity_rotation<3>());
}

/// A needle, a disc, a ball, or what does not turn at all.
static Body<3> any_body(std::mt19937& random) {
  static constexpr float kMoments[][3] = {
      {0.001f, 0.4f, 0.4f}, {0.2f, 0.1f, 0.11f}, {0.1f, 0.1f, 0.1f}, {0.0f, 0.0f, 0.0f}};
  const auto& moments = kMoments[random() % 4];
  Body<3> body{};
  body.rotation = any_rotation(random);
  for (int i = 0; i < 3; ++i) {
    body.inertia.m[4 * i] = moments[i];
    body.inverse_inertia.m[4 * i] = moments[i] > 0.0f ? 1.0f / moments[i] : 0.0f;
  }
  return body;
}

static Motion<3> any_motion(float spin, std::mt19937& random) {
  std::normal_distribution<float> normal;
  Motion<3> motion{};
  const bool still = random() % 8 == 0;
  for (int i = 0; i < 3; ++i) {
    motion.velocity[i] = normal(random);
    motion.delta_position[i] = 0.01f * normal(random);
    motion.spin[i] = still ? 0.0f : spin * normal(random);
  }
  motion.delta_rotation = any_rotation(random);
  return motion;
}

struct Turned {
  int in_lanes = 0;
  int left = 0;  ///< To the one that takes a body at a time.
};

static Turned turn_many(float spin) {
  constexpr float kStep_s = 1.0f / 240.0f;
  std::mt19937 random(3);
  Turned turned;
  for (int round = 0; round < 20000; ++round) {
    std::vector<Body<3>> bodies;
    std::vector<Motion<3>> motions;
    for (int i = 0; i < 6; ++i) {
      bodies.push_back(any_body(random));
      motions.push_back(any_motion(spin, random));
    }
    const LaneIndices<4> slots = {4, 0, 5, 2};
    std::vector<Motion<3>> expected = motions;
    const bool done = move_four(kStep_s, bodies.data(), slots, motions.data());
    for (const std::uint32_t slot : slots) {
      if (!done) continue;
      expected[slot].delta_position += kStep_s * expected[slot].velocity;
      turn_freely(kStep_s, bodies[slot], expected[slot]);
    }
    for (std::size_t i = 0; i < motions.size(); ++i)
      EXPECT_EQ(std::memcmp(&motions[i], &expected[i], sizeof motions[i]), 0) << round << ", " << i;
    ++(done ? turned.in_lanes : turned.left);
  }
  return turned;
}

TEST(TurnFreely, FourInLanesTurnToTheBitAsEachByItself) {
  EXPECT_GT(turn_many(3.0f).in_lanes, 19000);
  const Turned fast = turn_many(40.0f);  // A sixth of a radian in a substep, and more at times.
  EXPECT_GT(fast.in_lanes, 2000);
  EXPECT_GT(fast.left, 1000);
}

}  // namespace cycloid::solver
