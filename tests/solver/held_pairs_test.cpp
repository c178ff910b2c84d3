#include "solver/collision/held_pairs.hpp"

#include <cstring>

#include "tests/solver/manifold_3d_fixture.hpp"
#include "tests/solver/space_fixture.hpp"

namespace cycloid::solver {

static Vec<3> drawn_within_cube(std::mt19937& random, float most) {
  std::uniform_real_distribution<float> any(-most, most);
  return {{any(random), any(random), any(random)}};
}

/// Stones and boxes, each of a body of its own, and their poses.
struct Stones {
  WorldState<3> state;
  std::vector<Pose<3>> poses;
};

static Stones stones() {
  Stones made;
  const TestHull stone = ball_hull(16, 0.5f, 3);
  std::vector<Shape<3>> shapes = {stone.shape, stone.shape, solid_box(0.4f, 0.1f, 0.3f),
                                  stone.shape, solid_box(0.2f, 0.3f, 0.2f)};
  made.state.polyhedra = stone.pool;
  for (std::uint32_t i = 0; i < shapes.size(); ++i) {
    shapes[i].body = i;
    Body<3> body{};
    body.kind = BodyKind::kDynamic;
    body.extent = i == 1 ? 0.7f : 0.6f;
    made.state.bodies.edit([&](auto& bodies) { bodies.push_back(body); });
    made.poses.push_back({{{0.9f * static_cast<float>(i), 0.0f, 0.0f}}, identity_rotation<3>()});
  }
  made.state.shapes.edit([&](std::vector<Shape<3>>& items) { items = shapes; });
  made.state.header.tuning.speculative_distance = 0.02f;
  return made;
}

static void move_a_little(std::mt19937& random, float by, std::vector<Pose<3>>& poses) {
  for (Pose<3>& pose : poses) {
    pose.position += drawn_within_cube(random, by);
    const double angle = static_cast<double>(by) * static_cast<double>(random() % 1000) / 500.0;
    pose.rotation =
        normalized_or(compose(turn_about(drawn_within_cube(random, 1.0f), angle), pose.rotation),
                      identity_rotation<3>());
  }
}

static std::vector<PlacedPair<3>> all_pairs(const Stones& made, float margin) {
  std::vector<PlacedPair<3>> pairs;
  const auto count = static_cast<std::uint32_t>(made.poses.size());
  for (std::uint32_t a = 0; a < count; ++a)
    for (std::uint32_t b = a + 1; b < count; ++b)
      pairs.push_back({made.poses[a], made.poses[b], a, b, margin});
  return pairs;
}

static bool are_same_bits(const Manifold<3>& one, const Manifold<3>& other) {
  if (one.point_count != other.point_count) return false;
  if (one.point_count == 0) return true;
  const std::size_t size = one.point_count * sizeof(ManifoldPoint<3>);
  return std::memcmp(&one.normal, &other.normal, sizeof one.normal) == 0 &&
         std::memcmp(one.points.data(), other.points.data(), size) == 0;
}

/// What memories have told in a walk.
struct Told {
  int parted = 0;     ///< As in the tick before.
  int manifolds = 0;  ///< The same.
  int points = 0;
};

/// Bodies wander by so much in each of many ticks; whatever is held from one to the next, each pair
/// is collided to the bits that come of it without a memory.
static Told walk(float by, unsigned seed) {
  std::mt19937 random(seed);
  Stones made = stones();
  HeldPairs<3> before;
  HeldPairs<3> now;
  Told told;
  for (int tick = 0; tick < 3000; ++tick) {
    if (tick % 100 == 0)
      for (Pose<3>& pose : made.poses) pose.position = drawn_within_cube(random, 0.7f);
    move_a_little(random, by, made.poses);
    const float margin = tick % 7 == 0 ? 0.05f : 0.02f + 1.0e-4f * static_cast<float>(tick % 5);
    clear(now);
    PairMemory<3> memory(made.state, before, 0, now);
    for (const PlacedPair<3>& pair : all_pairs(made, margin)) {
      Manifold<3> found;
      memory.collide(pair, found);
      told.points += static_cast<int>(found.point_count);
      EXPECT_TRUE(are_same_bits(found, collide_held(made.state, pair)))
          << "tick " << tick << ", " << pair.shape_a << " and " << pair.shape_b;
    }
    if (testing::Test::HasFailure()) return told;
    for (const PartedPair& is : now.parted)
      for (const PartedPair& was : before.parted)
        if (is.key == was.key && is.gap == was.gap) ++told.parted;
    for (const HeldManifold& is : now.manifolds)
      for (const HeldManifold& was : before.manifolds)
        if (is.key == was.key && std::memcmp(&is.cell, &was.cell, sizeof is.cell) == 0)
          ++told.manifolds;
    before = now;
  }
  return told;
}

TEST(HeldPairs, ShowInNoBitHoweverFarBodiesMove) {
  for (const float by : {1.0e-5f, 1.0e-4f, 1.0e-3f, 1.0e-2f, 0.1f}) {
    SCOPED_TRACE(by);
    const Told told = walk(by, 7);
    ASSERT_FALSE(HasFailure());
    EXPECT_GT(told.points, 1000);
    if (by > 2.0e-4f) continue;
    EXPECT_GT(told.parted, 3000);
    EXPECT_GT(told.manifolds, 3000);
  }
}

TEST(HeldPairs, AreAskedForFromAnyKeyOn) {
  std::mt19937 random(11);
  Stones made = stones();
  for (Pose<3>& pose : made.poses) pose.position = drawn_within_cube(random, 0.6f);
  HeldPairs<3> before;
  const std::vector<PlacedPair<3>> pairs = all_pairs(made, 0.02f);
  PairMemory<3> first(made.state, HeldPairs<3>{}, 0, before);
  Manifold<3> found;
  for (const PlacedPair<3>& pair : pairs) first.collide(pair, found);
  ASSERT_EQ(before.parted.size() + before.manifolds.size(), pairs.size());
  for (std::size_t from = 0; from < pairs.size(); ++from) {
    HeldPairs<3> now;
    const std::uint64_t key = ShapePair{pairs[from].shape_a, pairs[from].shape_b}.key();
    PairMemory<3> memory(made.state, before, key, now);
    for (std::size_t i = from; i < pairs.size(); ++i) {
      memory.collide(pairs[i], found);
      EXPECT_TRUE(are_same_bits(found, collide_held(made.state, pairs[i])));
    }
    EXPECT_EQ(now.parted.size() + now.manifolds.size(), pairs.size() - from);
  }
}

/// Stones that fall onto a broad box and lie there.
static World<3> pile() {
  World<3> world = make_world(with_gravity<3>());
  std::mt19937 random(3);
  BodyDef<3> ground;
  ground.kind = BodyKind::kStatic;
  add(world, ground, box_def({{3.0f, 0.5f, 3.0f}}));
  for (int i = 0; i < 30; ++i) {
    BodyDef<3> stone;
    ShapeDef<3> hull;
    hull.kind = ShapeKind::kHull;
    for (int k = 0; k < 10; ++k) hull.points.push_back(drawn_within_cube(random, 0.3f));
    stone.position = {{0.5f * static_cast<float>(i % 3), 1.0f + 0.4f * static_cast<float>(i / 3),
                       0.1f * static_cast<float>(i % 2)}};
    add(world, stone, hull);
  }
  return world;
}

TEST(HeldPairs, AreNotMissedByAWorldThatIsRestoredInEveryTick) {
  World<3> kept = pile();
  World<3> restored = pile();
  for (int tick = 0; tick < 240; ++tick) {
    ASSERT_TRUE(kept.step().ok());
    ASSERT_TRUE(restored.step().ok());
    const WorldState<3> saved = restored.state();
    restored.restore(saved);
    ASSERT_EQ(kept.digest(), restored.digest()) << "tick " << tick;
  }
}

}  // namespace cycloid::solver
