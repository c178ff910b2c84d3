#include "tests/solver/space_fixture.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

static ShapeDef<2> brick(World<2>&) {
  return box(0.5f, 0.5f);
}
static ShapeDef<3> brick(World<3>&) {
  return box_def({{0.5f, 0.5f, 0.5f}});
}

/// Small pyramids in a row, 12 contacts each or nearly so, and a ball that falls between two of
/// them.
template <int D>
static World<D> row_of_pyramids() {
  constexpr int kPyramids = 12;
  WorldDef<D> def = with_gravity<D>();
  def.tuning.sleep_s = 0.0f;
  World<D> world = make_world(def);
  add_ground<D>(world, up<D>());
  const auto at = [](float x, float y) {
    Vec<D> position = Vec<D>::zero();
    position[0] = x;
    position[1] = y;
    return position;
  };
  for (int pyramid = 0; pyramid < kPyramids; ++pyramid)
    for (int row = 0; row < 3; ++row)
      for (int i = row; i < 3; ++i) {
        const auto x = 4.0f * static_cast<float>(pyramid) + static_cast<float>(i);
        const auto y = static_cast<float>(row);
        add_at<D>(world, at(x - 0.5f * y, 0.5f + y), brick(world));
      }
  add_at<D>(world, at(7.0f, 4.0f), ball<D>(0.8f));
  return world;
}

/// Steps both and compares them. @returns the lots of `divided` in each tick.
template <int D>
static std::vector<std::uint32_t> lots_of(World<D>& divided, World<D>& whole, int ticks) {
  std::vector<std::uint32_t> lots;
  for (int tick = 0; tick < ticks; ++tick) {
    EXPECT_TRUE(divided.step().ok());
    EXPECT_TRUE(whole.step().ok());
    EXPECT_EQ(divided.digest(), whole.digest()) << "tick " << tick;
    EXPECT_EQ(whole.statistics().lots, 1u);
    EXPECT_EQ(divided.statistics().colors, whole.statistics().colors);
    lots.push_back(divided.statistics().lots);
  }
  return lots;
}

template <int D>
static void expect_that_lots_do_not_show() {
  for (const int workers : {1, 3})
    for (const int lanes : {1, 4, 16}) {
      World<D> divided = row_of_pyramids<D>();
      World<D> whole = row_of_pyramids<D>();
      divided.set_lot_contacts(20);
      ASSERT_TRUE(divided.set_workers(workers).ok());
      ASSERT_TRUE(divided.set_lanes(lanes).ok());
      const std::vector<std::uint32_t> lots = lots_of(divided, whole, 90);
      // Two pyramids to a lot and the ball alone, until it joins two of them.
      EXPECT_EQ(lots[5], 7u);
      EXPECT_GE(lots[89], 4u);
    }
}

TEST(Lots, DoNotShowInThePlane) {
  expect_that_lots_do_not_show<2>();
}

TEST(Lots, DoNotShowInSpace) {
  expect_that_lots_do_not_show<3>();
}

TEST(Lots, AreOneWhereAllIsOneHeap) {
  World<2> divided = row_of_pyramids<2>();
  World<2> whole = row_of_pyramids<2>();
  for (World<2>* world : {&divided, &whole})
    add_at<2>(*world, {{23.0f, 3.6f}}, box(24.0f, 0.5f));  // A beam on all of them.
  divided.set_lot_contacts(20);
  EXPECT_EQ(lots_of(divided, whole, 60)[59], 1u);
}

// A body without mass that moves may touch several lots, which would see it at the end of the tick.
TEST(Lots, AreOneBesideWhatMovesWithoutMass) {
  World<2> divided = row_of_pyramids<2>();
  World<2> whole = row_of_pyramids<2>();
  for (World<2>* world : {&divided, &whole}) {
    BodyDef<2> def;
    def.kind = BodyKind::kKinematic;
    def.position = {{-3.0f, 0.5f}};
    def.velocity = {{3.0f, 0.0f}};
    add(*world, def, box(0.5f, 0.4f));
  }
  divided.set_lot_contacts(20);
  EXPECT_EQ(lots_of(divided, whole, 60)[59], 1u);
}

// Which islands are solved at once is asked of all contacts, so that tick is not divided.
TEST(Lots, AreOneWhileAContactIsLoaded) {
  World<2> divided = row_of_pyramids<2>();
  World<2> whole = row_of_pyramids<2>();
  ShapeDef<2> heavy = box(0.5f, 0.5f);
  heavy.density = 500.0f;
  for (World<2>* world : {&divided, &whole}) add_at<2>(*world, {{21.0f, 5.0f}}, heavy);
  divided.set_lot_contacts(20);
  const std::vector<std::uint32_t> lots = lots_of(divided, whole, 90);
  EXPECT_GT(lots[5], 1u);  // It falls.
  EXPECT_EQ(lots[89], 1u);
}

TEST(Lots, AreOneWhereNobodyAsksForThemInASmallWorld) {
  World<2> world = row_of_pyramids<2>();
  step(world, 3);
  EXPECT_EQ(world.statistics().lots, 1u);
}

}  // namespace cycloid::solver
