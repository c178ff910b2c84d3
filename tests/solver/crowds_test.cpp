#include <cstddef>
#include <vector>

#include "tests/solver/space_fixture.hpp"

namespace cycloid::solver {

/// Crowds, in which a shape meets so many others that every box is looked at in every tick: what a
/// world keeps of them is what a world finds that was read from its state.

static ShapeDef<2> square() {
  return box(0.25f, 0.25f);
}
static ShapeDef<3> cube() {
  return box_def({{0.25f, 0.25f, 0.25f}});
}

/// Boxes that pass through one another, on the ground.
template <int D>
static World<D> crowd(int count, ShapeDef<D> shape) {
  World<D> world = make_world(with_gravity<D>());
  add_ground(world, up<D>());
  shape.filter.group = -1;
  for (int i = 0; i < count; ++i) add_at(world, at<D>(0.0f, 0.25f), shape);
  return world;
}

template <int D>
static void expect_like_restored(int count, const ShapeDef<D>& shape) {
  SCOPED_TRACE(testing::Message() << count << " boxes, " << D);
  World<D> world = crowd<D>(count, shape);
  World<D> restored = make_world(with_gravity<D>());
  std::vector<std::byte> state;
  for (int tick = 0; tick < 60; ++tick) {
    world.encode(state);
    ASSERT_TRUE(restored.decode(state).ok());
    step(world, 1);
    step(restored, 1);
    ASSERT_EQ(world.statistics().contacts, restored.statistics().contacts) << "tick " << tick;
    ASSERT_EQ(world.contact_events().size(), restored.contact_events().size()) << "tick " << tick;
    ASSERT_EQ(world.digest(), restored.digest()) << "tick " << tick;
  }
  EXPECT_EQ(world.statistics().asleep, static_cast<std::uint32_t>(count));
  EXPECT_EQ(world.statistics().contacts, static_cast<std::uint32_t>(count));
}

TEST(Crowds, KeepTheirContactsWhenTheLastFallsAsleep) {
  for (const int count : {20, 100}) {
    expect_like_restored<2>(count, square());
    expect_like_restored<3>(count, cube());
  }
}

}  // namespace cycloid::solver
