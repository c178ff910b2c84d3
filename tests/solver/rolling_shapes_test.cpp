#include "tests/solver/space_fixture.hpp"

namespace cycloid::solver {

/// Shapes that are round about the axis they roll about, though not about their centre of mass: the
/// surface below them stays where it is, however far they turn within a tick.

static constexpr float kRadius_m = 0.2f;

static BodyDef<3> rolls_at(float speed_m_s) {
  BodyDef<3> def;
  def.position = {{0.0f, kRadius_m, 0.0f}};
  def.velocity = {{speed_m_s, 0.0f, 0.0f}};
  def.spin = {{0.0f, 0.0f, -speed_m_s / kRadius_m}};
  return def;
}

static void expect_to_roll(World<3>& world, BodyId id, float speed_m_s) {
  for (int tick = 0; tick < 120; ++tick) {
    step(world, 1);
    const BodyView<3> body = view(world, id);
    ASSERT_NEAR(body.position[1], kRadius_m, 0.01f) << "tick " << tick;
    ASSERT_NEAR(body.velocity[0], speed_m_s, 0.03f * speed_m_s) << "tick " << tick;
  }
}

TEST(RollingShapes, CapsulesKeepTheirHeightAndSpeed) {
  for (const float speed_m_s : {1.0f, 5.0f, 15.0f, 25.0f}) {
    SCOPED_TRACE(speed_m_s);
    World<3> world = make_world(with_gravity<3>());
    add_ground(world, up<3>());
    const BodyId id = add(world, rolls_at(speed_m_s),
                          capsule_def({{0.0f, 0.0f, -0.4f}}, {{0.0f, 0.0f, 0.4f}}, kRadius_m));
    expect_to_roll(world, id, speed_m_s);
  }
}

TEST(RollingShapes, DumbbellsOfBallsKeepTheirHeightAndSpeed) {
  for (const float speed_m_s : {1.0f, 5.0f, 15.0f, 25.0f}) {
    SCOPED_TRACE(speed_m_s);
    World<3> world = make_world(with_gravity<3>());
    add_ground(world, up<3>());
    ShapeDef<3> balls[2] = {ball<3>(kRadius_m), ball<3>(kRadius_m)};
    balls[0].points = {{{0.0f, 0.0f, -0.5f}}};
    balls[1].points = {{{0.0f, 0.0f, 0.5f}}};
    const Result<BodyId> id = world.create_body(rolls_at(speed_m_s), balls);
    ASSERT_TRUE(id.ok()) << id.error().field;
    expect_to_roll(world, id.value(), speed_m_s);
  }
}

TEST(RollingShapes, CapsulesThatSpinOnTheSpotStayThere) {
  World<3> world = make_world(with_gravity<3>({.friction = 0.0f}));
  add_ground(world, up<3>());
  BodyDef<3> def = rolls_at(0.0f);
  def.spin[2] = 60.0f;
  const BodyId id =
      add(world, def, capsule_def({{0.0f, 0.0f, -0.4f}}, {{0.0f, 0.0f, 0.4f}}, kRadius_m));
  for (int tick = 0; tick < 120; ++tick) {
    step(world, 1);
    ASSERT_NEAR(view(world, id).position[1], kRadius_m, 0.005f) << "tick " << tick;
  }
  EXPECT_NEAR(view(world, id).spin[2], 60.0f, 0.6f);
}

}  // namespace cycloid::solver
