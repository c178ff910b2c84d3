#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "solver/constraints/motion_lanes.hpp"
#include "solver/constraints/trig_lanes.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// Motions whose every float says which body and which component it is.
template <int D>
std::vector<Motion<D>> numbered_motions(int count) {
  std::vector<Motion<D>> motions(static_cast<std::size_t>(count));
  for (int body = 0; body < count; ++body) {
    float value = 100.0f * static_cast<float>(body);
    Motion<D>& motion = motions[static_cast<std::size_t>(body)];
    for (float& x : motion.velocity.v) x = value++;
    for (float& x : motion.spin.v) x = value++;
    for (float& x : motion.delta_position.v) x = value++;
    for (float& x : motion.delta_rotation.v) x = value++;
  }
  return motions;
}

/// Lanes hold bodies 31, 29, ...; those of odd lanes have no mass.
template <int D, int W>
void expect_records_pass_through_lanes() {
  std::vector<Motion<D>> motions = numbered_motions<D>(32);
  LaneIndices<W> bodies;
  LaneBits moves = 0;
  for (int lane = 0; lane < W; ++lane) {
    bodies[lane] = static_cast<std::uint32_t>(31 - 2 * lane);
    if (lane % 2 == 0) moves |= LaneBits{1} << lane;
  }
  MotionLanes<D, W> lanes = gather<D, W>(motions.data(), bodies);
  for (int i = 0; i < kMotionComponents<D>; ++i)
    for (int lane = 0; lane < W; ++lane)
      EXPECT_EQ(component(lanes, i).raw[lane], static_cast<float>(100 * (31 - 2 * lane) + i));
  for (int i = 0; i < kMotionComponents<D>; ++i) component(lanes, i) = Lanes<W>(-1.0f);
  const std::vector<Motion<D>> before = motions;
  scatter(lanes, moves, bodies, motions.data());
  for (std::size_t body = 0; body < motions.size(); ++body) {
    const bool in_a_lane = body % 2 == 1 && (31 - body) / 2 < W;
    const bool written = in_a_lane && (31 - body) / 2 % 2 == 0;
    EXPECT_EQ(motions[body].velocity[0], written ? -1.0f : before[body].velocity[0]) << body;
    EXPECT_EQ(motions[body].spin[0], written ? -1.0f : before[body].spin[0]) << body;
    EXPECT_EQ(motions[body].delta_rotation[1], before[body].delta_rotation[1]) << body;
  }
  scatter_pose(lanes, kAllLanes<W>, bodies, motions.data());
  for (int lane = 0; lane < W; ++lane)
    EXPECT_EQ(motions[bodies[lane]].delta_rotation[1], -1.0f) << lane;
}

TEST(LaneRecords, PassThroughLanesInBothDimensionsAtEveryWidth) {
  expect_records_pass_through_lanes<2, 1>();
  expect_records_pass_through_lanes<2, 4>();
  expect_records_pass_through_lanes<2, 8>();
  expect_records_pass_through_lanes<2, 16>();
  expect_records_pass_through_lanes<3, 1>();
  expect_records_pass_through_lanes<3, 4>();
  expect_records_pass_through_lanes<3, 8>();
  expect_records_pass_through_lanes<3, 16>();
}

TEST(LaneRecords, SineAndCosineOfLanesAreThoseOfEachAngleToTheBit) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<float> angles = {
      0.0f,   -0.0f,   1.0e-40f,  0.78539816f, -0.78539822f,
      1.0e6f, -3.0e7f, kInfinity, -kInfinity,  std::numeric_limits<float>::quiet_NaN()};
  for (int i = -4000; i <= 4000; ++i) angles.push_back(0.01f * static_cast<float>(i));
  for (int i = 1; i < 4000; ++i) angles.push_back(251.3f * static_cast<float>(i));
  while (angles.size() % 4 != 0) angles.push_back(1.0f);
  for (std::size_t i = 0; i < angles.size(); i += 4) {
    Lanes<4> sine;
    Lanes<4> cosine;
    sin_cos(Lanes<4>::load(&angles[i]), sine, cosine);
    for (int lane = 0; lane < 4; ++lane) {
      float s = 0.0f;
      float c = 0.0f;
      const float angle = angles[i + static_cast<std::size_t>(lane)];
      sin_cos(angle, s, c);
      const float in_lane[] = {sine.raw[lane], cosine.raw[lane]};
      EXPECT_EQ(std::bit_cast<std::uint32_t>(in_lane[0]), std::bit_cast<std::uint32_t>(s)) << angle;
      EXPECT_EQ(std::bit_cast<std::uint32_t>(in_lane[1]), std::bit_cast<std::uint32_t>(c)) << angle;
    }
  }
}

TEST(LaneRecords, AnglesOfLanesAreThoseOfEachPointToTheBit) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  std::vector<float> parts = {0.0f,       -0.0f, 1.0e-40f, 1.0f,      -1.0f,     0.41421356f,
                              2.4142136f, 3.0f,  1.0e30f,  kInfinity, -kInfinity};
  for (int i = 0; i < 61; ++i) parts.push_back(0.037f * static_cast<float>(i * i % 89 - 44));
  for (const float x : parts) {
    for (std::size_t i = 0; i + 4 <= parts.size(); i += 4) {
      const Lanes<4> angles = atan2(Lanes<4>::load(&parts[i]), Lanes<4>(x));
      for (int lane = 0; lane < 4; ++lane) {
        const float y = parts[i + static_cast<std::size_t>(lane)];
        const float angle = angles.raw[lane];
        if (std::isnan(atan2(y, x)) && std::isnan(angle)) continue;
        EXPECT_EQ(std::bit_cast<std::uint32_t>(angle), std::bit_cast<std::uint32_t>(atan2(y, x)))
            << y << " over " << x;
      }
    }
  }
}

/// Boxes in rows that fall on one another and turn; some have a damping, some no rotation.
static std::vector<std::byte> heap_of_boxes(int lanes, int count) {
  World<2> world = make_world(with_gravity<2>({0.6f, 0.2f, 0.0f, 0.0f}));
  EXPECT_TRUE(world.set_lanes(lanes).ok());
  add_ground(world, up<2>());
  for (int i = 0; i < count; ++i) {
    BodyDef<2> body;
    body.position = {{1.05f * static_cast<float>(i % 7), 0.6f + 1.1f * static_cast<float>(i / 7)}};
    body.spin[0] = static_cast<float>(i % 5 - 2);
    body.linear_damping = i % 3 == 0 ? 0.4f : 0.0f;
    body.fixed_rotation = i % 6 == 0;
    add(world, body, box(0.5f, 0.5f));
  }
  step(world, 40);
  std::vector<std::byte> bytes;
  world.encode(bytes);
  return bytes;
}

TEST(LaneRecords, TheWidthThatAStepChoosesChangesNoBit) {
  for (const int count : {1, 3, 60}) {
    const std::vector<std::byte> chosen = heap_of_boxes(0, count);
    for (const int lanes : {1, 4, 8, 16}) EXPECT_EQ(heap_of_boxes(lanes, count), chosen) << lanes;
  }
}

}  // namespace cycloid::solver
