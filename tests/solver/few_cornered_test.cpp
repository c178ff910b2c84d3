#include <bit>
#include <cstring>
#include <random>
#include <set>
#include <vector>

#include "solver/collision/collide.hpp"
#include "solver/instruction_sets.hpp"
#include "solver/motion.hpp"
#include "solver/shapes.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// Whole numbers of a quarter are drawn as often as any others: then axes tie and edges are flush.
static float drawn_between(std::mt19937& random, float from, float to) {
  if (random() % 2 == 0) return std::uniform_real_distribution<float>(from, to)(random);
  const int quarters = static_cast<int>(4.0f * (to - from));
  return from + 0.25f * static_cast<float>(random() % static_cast<unsigned>(quarters + 1));
}

/// A box, a lozenge, a trapezium, a triangle, a polygon of five corners, a capsule or a ball; some
/// are rounded.
static ShapeDef<2> drawn_few_cornered(std::mt19937& random) {
  const float x = drawn_between(random, 0.25f, 1.5f);
  const float y = drawn_between(random, 0.25f, 1.5f);
  ShapeDef<2> shape = box(x, y);
  switch (random() % 12) {
    case 0:
      shape.points = {{{-x, 0.0f}}, {{0.0f, -y}}, {{x, 0.0f}}, {{0.0f, y}}};
      break;
    case 1:
      shape.points = {{{-x, -y}}, {{x, -y}}, {{0.5f * x, y}}, {{-0.25f * x, y}}};
      break;
    case 2:
      shape.points = {{{-x, -y}}, {{x, -y}}, {{x, y}}, {{0.0f, 1.5f * y}}, {{-x, y}}};
      break;
    case 3:
      shape.points = {{{-x, -y}}, {{x, -y}}, {{0.25f * x, y}}};
      break;
    case 4:
    case 5:
      shape = capsule(x, y);
      break;
    case 6:
    case 7:
      shape = ball<2>(0.5f * x);
      break;
    case 8:
      shape = ball<2>(0.5f * x);
      shape.points = {{{drawn_between(random, -0.5f, 0.5f), 0.0f}}};
      return shape;
    default:
      break;
  }
  if (random() % 4 == 0) shape.radius = 0.1f;
  return shape;
}

static Pose<2> drawn_pose(std::mt19937& random) {
  const Vec<2> at = {{drawn_between(random, -1.5f, 1.5f), drawn_between(random, -1.5f, 1.5f)}};
  const float quarter_turns = 1.57079632679f * static_cast<float>(random() % 4);
  const bool is_straight = random() % 2 == 0;
  const float angle = is_straight ? quarter_turns : drawn_between(random, -3.0f, 3.0f);
  return {at, rotation_by(Spin<2>{{angle}})};
}

struct Crowd {
  std::vector<Shape<2>> shapes;
  std::vector<PlacedPair<2>> pairs;
};

/// Two capsules in one line: no side parts them.
static void append_line(std::mt19937& random, Crowd& made) {
  const auto a = static_cast<std::uint32_t>(made.shapes.size());
  for (int i = 0; i < 2; ++i)
    EXPECT_TRUE(
        append_shapes(capsule(drawn_between(random, 0.25f, 1.5f), 0.25f), 0, made.shapes).ok());
  const Pose<2> pose_a = drawn_pose(random);
  Pose<2> pose_b = pose_a;
  pose_b.position += rotate(pose_a.rotation, Vec<2>{{drawn_between(random, -4.0f, 4.0f), 0.0f}});
  made.pairs.push_back({pose_a, pose_b, a, a + 1, drawn_between(random, 0.0f, 0.5f)});
}

static Crowd crowd(std::mt19937& random, int count) {
  Crowd made;
  for (int i = 0; i < count; ++i) {
    if (random() % 8 == 0) {
      append_line(random, made);
      continue;
    }
    const auto a = static_cast<std::uint32_t>(made.shapes.size());
    for (int shape = 0; shape < 2; ++shape)
      EXPECT_TRUE(append_shapes(drawn_few_cornered(random), 0, made.shapes).ok());
    made.pairs.push_back(
        {drawn_pose(random), drawn_pose(random), a, a + 1, drawn_between(random, 0.0f, 0.5f)});
  }
  return made;
}

static bool one_is_a_ball(const Crowd& crowd, const PlacedPair<2>& pair) {
  return (crowd.shapes[pair.shape_a].kind == ShapeKind::kBall) !=
         (crowd.shapes[pair.shape_b].kind == ShapeKind::kBall);
}

static bool both_are_capsules(const Crowd& crowd, const PlacedPair<2>& pair) {
  return crowd.shapes[pair.shape_a].kind == ShapeKind::kCapsule &&
         crowd.shapes[pair.shape_b].kind == ShapeKind::kCapsule;
}

static void expect_same_bits(const Manifold<2>& expected, const Manifold<2>& found) {
  ASSERT_EQ(expected.point_count, found.point_count);
  if (expected.point_count == 0) return;
  EXPECT_EQ(std::memcmp(&expected.normal, &found.normal, sizeof expected.normal), 0);
  for (std::uint32_t i = 0; i < expected.point_count; ++i)
    EXPECT_EQ(std::memcmp(&expected.points[i], &found.points[i], sizeof expected.points[i]), 0)
        << "point " << i << " at separations " << expected.points[i].separation << " and "
        << found.points[i].separation;
}

static std::vector<int> widths() {
  std::vector<int> widths = {1, 4};
  if (has_avx2_kernels()) widths.push_back(kAvx2Lanes);
  if (has_avx512_kernels()) widths.push_back(kAvx512Lanes);
  return widths;
}

TEST(FewCornered, PairsCollideToTheSameBitsAtEveryWidthAndInEveryCrowd) {
  std::mt19937 random(20261122);
  std::set<std::uint32_t> counts;
  std::set<std::uint32_t> features;
  std::set<std::uint32_t> of_capsules;
  std::set<std::uint32_t> of_balls;
  const WorldState<2> none;
  const HeldPairs<2> before;
  HeldPairs<2> now;
  for (int round = 0; round < 2000; ++round) {
    const int count = 1 + static_cast<int>(random() % kPairGrain);
    const Crowd made = crowd(random, count);
    std::vector<Manifold<2>> expected;
    for (const PlacedPair<2>& pair : made.pairs) {
      expected.push_back(collide(made.shapes[pair.shape_a], pair.pose_a, made.shapes[pair.shape_b],
                                 pair.pose_b, pair.margin, {}));
      counts.insert(expected.back().point_count);
      for (std::uint32_t i = 0; i < expected.back().point_count; ++i)
        (both_are_capsules(made, pair) ? of_capsules
         : one_is_a_ball(made, pair)   ? of_balls
                                       : features)
            .insert(expected.back().points[i].feature);
    }
    for (const int lanes : widths()) {
      std::vector<Manifold<2>> found(made.pairs.size());
      PairMemory<2> memory(none, before, 0, now);
      Collider<2>{made.shapes.data(), {}, lanes}(made.pairs.data(), count, found.data(), memory);
      for (std::size_t i = 0; i < found.size(); ++i) {
        SCOPED_TRACE(testing::Message() << "round " << round << ", pair " << i << " of " << count
                                        << ", lanes " << lanes);
        expect_same_bits(expected[i], found[i]);
        ASSERT_FALSE(HasFailure());
      }
    }
  }
  EXPECT_EQ(counts, (std::set<std::uint32_t>{0, 1, 2}));
  for (std::uint32_t corner = 0; corner < 4; ++corner) {
    EXPECT_TRUE(of_balls.contains(corner)) << corner;
    EXPECT_TRUE(of_balls.contains(16 + corner)) << corner;
  }
  for (std::uint32_t edge_or_corner = 0; edge_or_corner < 16; ++edge_or_corner) {
    const std::uint32_t pair = (edge_or_corner / 4) << 4 | (edge_or_corner % 4) << 1;
    for (const std::uint32_t feature : {pair, pair | 1u, pair | 0x400u})
      EXPECT_TRUE(features.contains(feature)) << feature;
    if (edge_or_corner / 4 > 1 || edge_or_corner % 4 > 1) continue;
    for (const std::uint32_t feature : {pair, pair | 1u, pair | 0x400u})
      EXPECT_TRUE(of_capsules.contains(feature)) << feature;
  }
}

}  // namespace cycloid::solver
