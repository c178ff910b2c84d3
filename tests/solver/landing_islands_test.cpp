#include <algorithm>

#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// Products of blocks in the last tick: by how much its rows are more than those of the sweeps.
template <int D>
static std::uint64_t products_of(const World<D>& world) {
  const Statistics& of = world.statistics();
  const Tuning& tuning = world.state().header.tuning;
  return of.rows - std::uint64_t{of.rows_per_sweep} * of.substeps *
                       (tuning.sweeps + tuning.relax_sweeps + tuning.position_sweeps);
}

/// The sum of them over some ticks.
template <int D>
static std::uint64_t products_in(int ticks, World<D>& world) {
  std::uint64_t sum = 0;
  for (int i = 0; i < ticks; ++i) {
    step(world, 1);
    sum += products_of(world);
  }
  return sum;
}

template <int D>
static World<D> make_world_of(WorldDef<D> def, ContactBlockRows islands) {
  def.tuning.sleep_s = 0.0f;
  def.tuning.contact_block = islands;
  return make_world<D>(def);
}

/// A ball of 1 m.
template <int D>
static BodyId add_ball(World<D>& world, float mass, Vec<D> position, Vec<D> velocity) {
  BodyDef<D> body;
  body.mass = mass;
  body.position = position;
  body.velocity = velocity;
  return add(world, body, ball<D>(0.5f));
}

/// Balls of 1 and 1000 kg over one another, that move to the right at `speed`, and one that flies:
/// else they would be all that moves. @returns the heavy one.
template <int D>
static BodyId add_heavy_on_light(World<D>& world, float speed) {
  add_ball<D>(world, 1.0f, at<D>(20.0f, 100.0f), at<D>(0.0f, 0.0f));
  add_ball<D>(world, 1.0f, at<D>(0.0f, 0.5f), at<D>(speed, 0.0f));
  return add_ball<D>(world, 1000.0f, at<D>(0.0f, 1.5f), at<D>(speed, 0.0f));
}

/// What a third ball of 100 kg does that comes down on those.
template <int D>
static void expect_blow_left_to_sweeps() {
  World<D> world = make_world_of<D>(with_gravity<D>(), ContactBlockRows::kLoadedIsland);
  add_ground<D>(world, up<D>());
  add_heavy_on_light<D>(world, 0.0f);
  add_ball<D>(world, 100.0f, at<D>(0.0f, 3.5f), at<D>(0.0f, 0.0f));
  EXPECT_GT(products_in(20, world), 0u) << "what rests is solved at once";
  for (int tick = 0; tick < 60 && world.statistics().contacts == 2; ++tick)
    ASSERT_EQ(products_in(1, world), 0u);
  ASSERT_EQ(world.statistics().contacts, 3u) << "the ball has come";
  EXPECT_EQ(products_of(world), 0u);
  EXPECT_GT(products_in(30, world), 0u) << "sweeps have stopped it";
}

TEST(LandingIslands, AreLeftToTheSweepsUntilTheyRest) {
  expect_blow_left_to_sweeps<2>();
  expect_blow_left_to_sweeps<3>();
}

template <int D>
static void expect_solved_on_moving_ground() {
  constexpr float kSpeed = 5.0f;
  World<D> world = make_world_of<D>(with_gravity<D>(), ContactBlockRows::kLoadedIsland);
  BodyDef<D> ground;
  ground.kind = BodyKind::kKinematic;
  ground.position = at<D>(0.0f, -10.0f);
  ground.velocity = at<D>(kSpeed, 0.0f);
  add(world, ground, ball<D>(10.0f));
  add_heavy_on_light<D>(world, kSpeed);
  EXPECT_GT(products_in(20, world), 0u);
}

TEST(LandingIslands, AreNoneWhereTheGroundMovesWithThem) {
  expect_solved_on_moving_ground<2>();
  expect_solved_on_moving_ground<3>();
}

template <int D>
static void expect_swept_without_ground() {
  for (const ContactBlockRows islands :
       {ContactBlockRows::kLoadedIsland, ContactBlockRows::kIsland}) {
    World<D> world = make_world_of<D>({}, islands);
    add_ball<D>(world, 1.0f, at<D>(0.0f, 0.0f), at<D>(0.0f, 0.0f));
    add_ball<D>(world, 1000.0f, at<D>(0.0f, 1.02f), at<D>(0.0f, -0.2f));
    add_ball<D>(world, 1.0f, at<D>(20.0f, 100.0f), at<D>(0.0f, 0.0f));
    const std::uint64_t products = products_in(30, world);
    if (islands == ContactBlockRows::kIsland)
      EXPECT_GT(products, 0u);
    else
      EXPECT_EQ(products, 0u) << "nothing holds them up, so nothing weighs on them";
  }
}

TEST(LandingIslands, AreThoseThatTouchNoGround) {
  expect_swept_without_ground<2>();
  expect_swept_without_ground<3>();
}

template <int D>
static void expect_solved_with_a_joint() {
  World<D> world = make_world_of<D>(with_gravity<D>(), ContactBlockRows::kLoadedIsland);
  add_ground<D>(world, up<D>());
  JointDef<D> rod;
  rod.kind = JointKind::kDistance;
  rod.body_a = add_heavy_on_light<D>(world, 3.0f);
  rod.body_b = add_ball<D>(world, 1.0f, at<D>(2.0f, 1.5f), at<D>(3.0f, 0.0f));
  rod.length = 2.0f;
  ASSERT_TRUE(world.create_joint(rod).ok());
  step(world, 2);
  EXPECT_GT(products_in(2, world), 0u) << "sweeps would part it";
}

TEST(LandingIslands, WithAJointAreSolvedWhileTheyMove) {
  expect_solved_with_a_joint<2>();
  expect_solved_with_a_joint<3>();
}

/// Balls of 1 and 100 kg that fall into a trough of two slopes, from 2.5 to 14 m above its bottom.
template <int D>
static World<D> make_falling_heap() {
  World<D> world = make_world_of<D>(with_gravity<D>(), ContactBlockRows::kLoadedIsland);
  for (const float side : {-1.0f, 1.0f}) {
    Vec<D> normal = up<D>();
    normal[0] = 0.6f * side;
    normal[1] = 0.8f;
    add_ground<D>(world, normal);
  }
  std::uint32_t bits = 0x2f9b47d1u;
  for (int i = 0; i < 48; ++i) {
    bits = bits * 1664525u + 1013904223u;
    const float mass = (bits >> 31) != 0 ? 100.0f : 1.0f;
    const float aside = 0.05f * static_cast<float>((bits >> 20) % 8) - 0.2f;
    Vec<D> position = at<D>(1.05f * static_cast<float>(i % 4) - 1.5f + aside,
                            2.5f + 1.05f * static_cast<float>(i / 4));
    if (D == 3) position[D - 1] = aside;
    add_ball<D>(world, mass, position, Vec<D>::zero());
  }
  return world;
}

/// The greatest speed while it lands, m/s. Nothing falls further than 14 m: 17 m/s.
template <int D>
static float fastest_in_falling_heap() {
  World<D> world = make_falling_heap<D>();
  float fastest = 0.0f;
  for (int tick = 0; tick < 240; ++tick) {
    step(world, 1);
    for (const Body<D>& body : world.state().bodies)
      fastest = std::max(fastest, length(body.velocity));
  }
  return fastest;
}

TEST(LandingIslands, OfUnequalMassesThrowNothingAbout) {
  EXPECT_LT(fastest_in_falling_heap<2>(), 25.0f);
  EXPECT_LT(fastest_in_falling_heap<3>(), 25.0f);
}

}  // namespace cycloid::solver
