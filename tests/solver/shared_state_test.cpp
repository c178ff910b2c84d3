#include <thread>

#include "tests/solver/encoding_fixture.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// A pyramid of boxes at rest, 3 contacts to a box as a rule.
World<2> resting_pyramid(int base) {
  WorldDef<2> def = with_gravity<2>();
  def.tuning.sleep_s = 0.0f;
  World<2> world = make_world(def);
  add_ground<2>(world, up<2>());
  for (int row = 0; row < base; ++row)
    for (int i = row; i < base; ++i) {
      const float x = static_cast<float>(2 * i - row);
      add_at<2>(world, {{0.5f * x, 0.5f + static_cast<float>(row)}}, box(0.5f, 0.5f));
    }
  step(world, 120);
  return world;
}

TEST(SavedState, TakesAtMost300BytesForARestingBodyWithThreeContacts) {
  const World<2> world = resting_pyramid(14);
  const std::size_t bodies = world.body_count();
  const std::size_t contacts = world.state().contacts.size();
  EXPECT_GE(contacts, 2 * bodies);
  const std::size_t at_three = sizeof(Body<2>) + 3 * sizeof(Contact<2>);
  EXPECT_LE(at_three, 300u);
  // The rest is what no body has: the header.
  EXPECT_LE(saved_bytes(world.state()),
            bodies * sizeof(Body<2>) + contacts * sizeof(Contact<2>) + 512);
}

TEST(SavedState, IsNotWhatAnEditOfTheWorldMakesOfIt) {
  World<2> world = resting_pyramid(3);
  WorldState<2> saved;
  world.save(saved);
  EXPECT_TRUE(saved.shapes.is_same_as(world.state().shapes));
  const std::vector<std::byte> before = bytes_of(saved);
  ASSERT_TRUE(world.set_filter({1, 0}, 0, {2, 2, 0}).ok());
  add_at<2>(world, {{0.0f, 9.0f}}, ball<2>(0.5f));
  ASSERT_TRUE(world.destroy_body({2, 0}).ok());
  EXPECT_FALSE(saved.shapes.is_same_as(world.state().shapes));
  EXPECT_EQ(bytes_of(saved), before);
  const std::uint64_t digest = digest_state(saved);
  world.restore(saved);
  EXPECT_EQ(world.digest(), digest);
  EXPECT_EQ(bytes_of(world.state()), before);
}

TEST(SavedState, SharesNothingThatTwoWorldsThenEditOnTheirThreads) {
  const World<2> origin = resting_pyramid(3);
  const std::vector<std::byte> before = bytes_of(origin.state());
  const auto play = [&](std::uint64_t& digest) {
    World<2> world = make_world<2>();
    for (int i = 0; i < 50; ++i) {
      world.restore(origin.state());
      add_at<2>(world, {{0.0f, 9.0f}}, ball<2>(0.5f));
      step(world, 1);
    }
    digest = world.digest();
  };
  std::uint64_t digest_a = 0;
  std::uint64_t digest_b = 1;
  std::thread other([&] { play(digest_a); });
  play(digest_b);
  other.join();
  EXPECT_EQ(digest_a, digest_b);
  EXPECT_EQ(bytes_of(origin.state()), before);
}

/// A ball that falls on a shelf, which lies elsewhere in the saved state.
TEST(SavedState, BringsBackStaticBodiesThatWereMovedSince) {
  World<2> world = make_world(with_gravity<2>());
  BodyDef<2> def;
  def.kind = BodyKind::kStatic;
  const BodyId shelf = add(world, def, box(1.0f, 0.1f));
  const BodyId faller = add_at<2>(world, {{0.0f, 2.0f}}, ball<2>(0.5f));
  step(world, 5);
  WorldState<2> saved;
  world.save(saved);
  step(world, 200);
  const std::uint64_t digest = world.digest();
  EXPECT_NEAR(view(world, faller).position[1], 0.6f, 0.02f);
  ASSERT_TRUE(world.set_pose(shelf, {{9.0f, 0.0f}}, identity_rotation<2>()).ok());
  step(world, 1);
  world.restore(saved);
  step(world, 200);
  EXPECT_EQ(world.digest(), digest);
}

TEST(StepMemory, SharedByWorldsOfAllSizesChangesNoBit) {
  const auto memory = make_step_memory<2>();
  const auto make = [](int size) {
    World<2> world = resting_pyramid(size);
    add_at<2>(world, {{0.3f, 12.0f}}, ball<2>(0.7f));
    return world;
  };
  for (const int lanes : {1, 4, 8, 16}) {
    std::vector<World<2>> alone;
    std::vector<World<2>> sharing;
    for (const int size : {6, 1, 3}) {
      alone.push_back(make(size));
      sharing.push_back(make(size));
      ASSERT_TRUE(alone.back().set_lanes(lanes).ok());
      ASSERT_TRUE(sharing.back().set_lanes(lanes).ok());
      sharing.back().use_step_memory(memory);
    }
    for (int tick = 0; tick < 90; ++tick)
      for (std::size_t i = 0; i < alone.size(); ++i) {
        ASSERT_TRUE(alone[i].step().ok());
        ASSERT_TRUE(sharing[i].step().ok());
        ASSERT_EQ(sharing[i].digest(), alone[i].digest()) << "world " << i << ", tick " << tick;
      }
  }
}

TEST(StepMemory, IsForWorldsOnManyThreads) {
  const auto memory = make_step_memory<2>();
  std::vector<std::uint64_t> digests(4);
  std::vector<std::thread> threads;
  for (std::uint64_t& digest : digests)
    threads.emplace_back([&] {
      World<2> world = make_world(with_gravity<2>());
      world.use_step_memory(memory);
      add_ground<2>(world, up<2>());
      for (int i = 0; i < 9; ++i)
        add_at<2>(world, {{0.1f * static_cast<float>(i), 1.0f + static_cast<float>(i)}},
                  box(0.5f, 0.5f));
      step(world, 150);
      digest = world.digest();
    });
  for (std::thread& thread : threads) thread.join();
  for (const std::uint64_t digest : digests) EXPECT_EQ(digest, digests[0]);
}

}  // namespace cycloid::solver
