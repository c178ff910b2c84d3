#include "solver/trig.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// How far a ball that has come to rest on the ground overlaps it, m.
template <int D>
static float overlap_at_rest(ContactBlockRows islands, float slop) {
  constexpr float kRadius = 0.5f;
  WorldDef<D> def = with_gravity<D>();
  def.tuning.sleep_s = 0.0f;
  def.tuning.contact_block = islands;
  def.tuning.slop = slop;
  World<D> world = make_world<D>(def);
  add_ground<D>(world, up<D>());
  BodyDef<D> body;
  body.position = at<D>(0.0f, kRadius);
  const BodyId resting = add(world, body, ball<D>(kRadius));
  step(world, 120);
  return kRadius - dot(world.state().bodies[resting.index].position, up<D>());
}

/// What a spring against the ground, of twice the frequency, gives way by under the ball: g / w^2.
template <int D>
static float sag_of_ball() {
  const float omega = 2.0f * kPi * 2.0f * Tuning{}.contact_hertz;
  return sqrt(dot(with_gravity<D>().gravity, with_gravity<D>().gravity)) / (omega * omega);
}

template <int D>
static void expect_overlaps() {
  const float sag = sag_of_ball<D>();
  const float rounding = 1.0e-2f * sag;
  const float deep = 10.0f * sag;
  EXPECT_NEAR(overlap_at_rest<D>(ContactBlockRows::kNone, deep), sag, rounding);
  EXPECT_NEAR(overlap_at_rest<D>(ContactBlockRows::kLoadedIsland, deep), 0.5f * sag, rounding);
}

TEST(StiffOverlap, IsHalfOfWhatSpringsGiveWayBy) {
  expect_overlaps<2>();
  expect_overlaps<3>();
}

/// Beyond the slop d every spring is the same: overlap o carries a load by which it alone would
/// give way by o + d.
template <int D>
static void expect_end_at_slop() {
  const float sag = sag_of_ball<D>();
  const float overlap = overlap_at_rest<D>(ContactBlockRows::kLoadedIsland, 0.25f * sag);
  EXPECT_NEAR(overlap, 0.75f * sag, 1.0e-2f * sag);
}

TEST(StiffOverlap, EndsAtTheSlop) {
  expect_end_at_slop<2>();
  expect_end_at_slop<3>();
}

}  // namespace cycloid::solver
