#include "solver/bodies/turn_freely.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <random>
#include <vector>

#include "solver/bodies/body_kernels.hpp"
#include "tests/solver/every_width.hpp"

namespace cycloid::solver {

static Rotation<3> any_rotation(std::mt19937& random) {
  std::normal_distribution<float> normal;
  return normalized_or(Rotation<3>{{normal(random), normal(random), normal(random), 1.0f}},
                       identity_rotation<3>());
}

/// A needle, a disc, a ball, what does not turn at all, a grain of sand or a mountain.
static Body<3> any_body(std::mt19937& random) {
  static constexpr float kMoments[][3] = {{0.001f, 0.4f, 0.4f},     {0.2f, 0.1f, 0.11f},
                                          {0.1f, 0.1f, 0.1f},       {0.0f, 0.0f, 0.0f},
                                          {1e-16f, 2e-16f, 2e-16f}, {3e21f, 1e21f, 2.5e21f}};
  const auto& moments = kMoments[random() % std::size(kMoments)];
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

/// Blocks of W bodies, whose slots are in no order, among others that nothing may touch.
template <int W>
static Turned turn_many(float spin, int rounds) {
  constexpr float kStep_s = 1.0f / 240.0f;
  constexpr std::uint32_t kBodies = kLaneCount<W> + 2;
  std::mt19937 random(3);
  Turned turned;
  for (int round = 0; round < rounds; ++round) {
    std::vector<Body<3>> bodies;
    std::vector<Motion<3>> motions;
    std::vector<std::uint32_t> slots;
    for (std::uint32_t i = 0; i < kBodies; ++i) {
      bodies.push_back(any_body(random));
      motions.push_back(any_motion(spin, random));
      slots.push_back(i);
    }
    std::shuffle(slots.begin(), slots.end(), random);
    slots.resize(kLaneCount<W>);
    std::vector<Motion<3>> expected = motions;
    const bool done =
        BodyKernels<W>::move_in_space(kStep_s, bodies.data(), slots.data(), motions.data());
    for (const std::uint32_t slot : slots) {
      if (!done) continue;
      expected[slot].delta_position += kStep_s * expected[slot].velocity;
      turn_freely(kStep_s, bodies[slot], expected[slot]);
    }
    for (std::size_t i = 0; i < motions.size(); ++i)
      EXPECT_EQ(std::memcmp(&motions[i], &expected[i], sizeof motions[i]), 0)
          << "round " << round << ", body " << i << ", width " << W;
    ++(done ? turned.in_lanes : turned.left);
  }
  return turned;
}

template <int W>
static void expect_to_turn_as_each_by_itself() {
  constexpr int kRounds = 20000 / kLaneCount<W>;
  EXPECT_GT(turn_many<W>(3.0f, kRounds).in_lanes, kRounds / 2);
  Turned fast;  // Up to a sixth of a radian in a substep, and more at times.
  for (const float spin : {10.0f, 20.0f, 40.0f}) {
    const Turned turned = turn_many<W>(spin, kRounds);
    fast.in_lanes += turned.in_lanes;
    fast.left += turned.left;
  }
  EXPECT_GT(fast.in_lanes, kRounds / 10);
  EXPECT_GT(fast.left, kRounds / 50);
}

TEST(TurnFreely, LanesTurnToTheBitAsEachByItself) {
  for_each_width<1, 4>([]<int W>() { expect_to_turn_as_each_by_itself<W>(); });
}

}  // namespace cycloid::solver
