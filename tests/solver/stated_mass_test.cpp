#include <gtest/gtest.h>

#include <array>

#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// A body whose mass is stated, and what the densities of its shapes do to it then.

/// Of a body of 4 kg: two balls of half a metre, at -1 and 1 m, of these densities.
template <int D>
static Body<D> two_balls(float density_left, float density_right) {
  World<D> world = make_world(with_gravity<D>());
  std::array<ShapeDef<D>, 2> balls;
  for (ShapeDef<D>& ball : balls) ball.radius = 0.5f;
  balls[0].points = {at<D>(-1.0f, 0.0f)};
  balls[0].density = density_left;
  balls[1].points = {at<D>(1.0f, 0.0f)};
  balls[1].density = density_right;
  BodyDef<D> def;
  def.mass = 4.0f;
  const Result<BodyId> id = world.create_body(def, balls);
  EXPECT_TRUE(id.ok()) << id.error().field;
  return world.state().bodies[id.value().index];
}

template <int D>
static void check_shares() {
  const Body<D> even = two_balls<D>(1.0f, 1.0f);
  EXPECT_EQ(even.mass, 4.0f);
  EXPECT_NEAR(even.local_center[0], 0.0f, 1.0e-6f);
  EXPECT_NEAR(two_balls<D>(1.0f, 3.0f).local_center[0], 0.5f, 1.0e-6f);
  EXPECT_NEAR(two_balls<D>(0.0f, 3.0f).local_center[0], 1.0f, 1.0e-6f);
  for (const float density : {0.0f, 7.0f}) {
    const Body<D> same = two_balls<D>(density, density);
    EXPECT_NEAR(same.local_center[0], 0.0f, 1.0e-6f) << density;
    for (std::size_t i = 0; i < std::size(even.inverse_inertia.m); ++i)
      EXPECT_NEAR(same.inverse_inertia.m[i], even.inverse_inertia.m[i], 1.0e-6f) << density;
  }
}

TEST(StatedMass, IsSharedOutByDensityAndWhereNoneIsSaidByVolume) {
  check_shares<2>();
  check_shares<3>();
}

}  // namespace cycloid::solver
