#include <algorithm>
#include <random>

#include "solver/collision/box_set.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

static Bounds<2> random_box(std::mt19937& random) {
  Bounds<2> box;
  for (int i = 0; i < 2; ++i) {
    box.lower[i] = static_cast<float>(random() % 1000) * 0.1f;
    box.upper[i] = box.lower[i] + static_cast<float>(random() % 100) * 0.05f;
  }
  return box;
}

// Boxes come, change and go, few enough for rows alone and so many that a tree is made: what
// overlaps is found, each once, and nothing else.
TEST(BoxSet, FindsWhatBruteForceFindsWhateverComesAndGoes) {
  Workers workers(2);
  for (const std::uint32_t ids : {5u, 60u, 3000u}) {
    std::mt19937 random(ids);
    BoxSet<2> set;
    TreeRoom<2> room;
    std::vector<Bounds<2>> boxes(ids);
    std::vector<bool> present(ids, false);
    for (int round = 0; round < 60; ++round) {
      for (std::uint32_t change = 0; change < 1 + ids / 8; ++change) {
        const auto id = static_cast<std::uint32_t>(random() % ids);
        if (random() % 4 == 0) {
          set.remove(id);
          present[id] = false;
        } else {
          boxes[id] = random_box(random);
          set.put(id, boxes[id]);
          present[id] = true;
        }
      }
      set.settle(workers, room);
      EXPECT_EQ(set.size(), std::count(present.begin(), present.end(), true));
      for (int i = 0; i < 20; ++i) {
        const Bounds<2> where = random_box(random);
        std::vector<std::uint32_t> found;
        set.query(where, [&](std::uint32_t id) { found.push_back(id); });
        std::sort(found.begin(), found.end());
        std::vector<std::uint32_t> expected;
        for (std::uint32_t id = 0; id < ids; ++id)
          if (present[id] && overlaps(boxes[id], where)) expected.push_back(id);
        ASSERT_EQ(found, expected) << ids << " ids, round " << round;
      }
    }
  }
}

/// Balls and boxes that fly about between four walls, close enough to meet all the time.
static World<2> hall(int movers, float half) {
  World<2> world = make_world(WorldDef<2>{});
  BodyDef<2> wall;
  wall.kind = BodyKind::kStatic;
  for (int i = 0; i < 4; ++i) {
    const float side = i % 2 == 0 ? -half - 0.5f : half + 0.5f;
    wall.position = i < 2 ? Vec<2>{{side, 0.0f}} : Vec<2>{{0.0f, side}};
    add(world, wall, i < 2 ? box(0.5f, half + 1.0f) : box(half + 1.0f, 0.5f));
  }
  std::mt19937 random(9);
  const auto within_half = [&](float bound) {
    return bound * (static_cast<float>(random() % 2001) * 0.001f - 1.0f);
  };
  for (int i = 0; i < movers; ++i) {
    BodyDef<2> def;
    def.position = {{within_half(half - 1.0f), within_half(half - 1.0f)}};
    def.velocity = {{within_half(12.0f), within_half(12.0f)}};
    add(world, def, i % 2 == 0 ? ball<2>(0.3f) : box(0.3f, 0.2f));
  }
  return world;
}

/// Steps both, one of them restored before each tick; the other goes on with what it has kept.
static void expect_same(World<2>& keeps, World<2>& forgets, int ticks) {
  for (int tick = 0; tick < ticks; ++tick) {
    const WorldState<2> saved = forgets.state();
    forgets.restore(saved);
    ASSERT_TRUE(keeps.step().ok());
    ASSERT_TRUE(forgets.step().ok());
    ASSERT_EQ(keeps.statistics().pairs, forgets.statistics().pairs) << "tick " << tick;
    ASSERT_EQ(keeps.digest(), forgets.digest()) << "tick " << tick;
  }
}

// So many that the boxes lie in a tree, and so fast that it is made anew again and again.
TEST(PairCache, OfManyFastBodiesShowsNeitherInPairsNorInBits) {
  World<2> keeps = hall(700, 20.0f);
  World<2> forgets = hall(700, 20.0f);
  ASSERT_TRUE(keeps.set_workers(3).ok());
  expect_same(keeps, forgets, 40);
  EXPECT_GT(keeps.statistics().pairs, 300u);
}

// So many candidates that threads merge them by ranges of their keys: from the first tick on, where
// there are none yet, and with fresh ones in every range.
TEST(PairCache, MergedByRangesShowsNeitherInPairsNorInBits) {
  constexpr std::uint32_t kSharedMin = 4096;
  for (const int workers : {2, 5}) {
    World<2> keeps = hall(3000, 18.0f);
    World<2> forgets = hall(3000, 18.0f);
    ASSERT_TRUE(keeps.set_workers(workers).ok());
    expect_same(keeps, forgets, 8);
    EXPECT_GT(keeps.statistics().pairs, kSharedMin);
  }
}

// In a crowd all look in each tick; when it has parted, candidates are kept again.
TEST(PairCache, OfACrowdThatPartsShowsNeitherInPairsNorInBits) {
  constexpr std::uint32_t kCrowd = 120;
  World<2> keeps = hall(0, 30.0f);
  World<2> forgets = hall(0, 30.0f);
  for (World<2>* world : {&keeps, &forgets})
    for (std::uint32_t i = 0; i < kCrowd; ++i) {
      BodyDef<2> def;
      def.position = {{0.001f * static_cast<float>(i), 0.0f}};
      add(*world, def, ball<2>(0.4f));
    }
  expect_same(keeps, forgets, 1);
  EXPECT_EQ(keeps.statistics().pairs, kCrowd * (kCrowd - 1) / 2);
  expect_same(keeps, forgets, 120);
  EXPECT_LT(keeps.statistics().pairs, kCrowd * 8);
}

}  // namespace cycloid::solver
