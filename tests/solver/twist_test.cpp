#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

constexpr float kGravity = 10.0f;
constexpr float kRadius = 0.5f;

struct TwistSetting {
  const char* name;
  Tuning tuning;
};

static std::vector<TwistSetting> twist_settings() {
  std::vector<TwistSetting> all = {{"soft_step", Tuning::soft_step()},
                                   {"pgs", Tuning::pgs()},
                                   {"split_impulse", Tuning::split_impulse()},
                                   {"pgs_ngs_block", Tuning::pgs_ngs_block()},
                                   {"tgs_ngs", Tuning::tgs_ngs()}};
  for (TwistSetting& setting : all) setting.tuning.sleep_s = 0.0f;
  return all;
}

template <int D>
static World<D> ground_of(const Tuning& tuning, const Material& material) {
  WorldDef<D> def = with_gravity<D>(material);
  def.tuning = tuning;
  World<D> world = make_world(def);
  add_ground<D>(world, up<D>());
  return world;
}

static BodyId add_spinning(World<3>& world, const Vec<3>& velocity, const Vec<3>& spin) {
  BodyDef<3> def;
  def.position = {{0.0f, kRadius, 0.0f}};
  def.velocity = velocity;
  def.spin = spin;
  return add(world, def, ball<3>(kRadius));
}

/// The spin about the vertical that is left after so many seconds.
static float spin_after(const TwistSetting& setting, float twist, float spin, float seconds) {
  World<3> world = ground_of<3>(setting.tuning, {0.6f, 0.0f, 0.0f, twist});
  const BodyId id = add_spinning(world, Vec<3>::zero(), {{0.0f, spin, 0.0f}});
  step(world, static_cast<int>(std::lround(60.0f * seconds)));
  return view(world, id).spin[1];
}

// I w' = -twist r m g with I = 2/5 m r^2: it stops after t = 2/5 r w0 / (twist g).
TEST(Twist, StopsASpinningBallAtItsTime) {
  const float twist = 0.02f;
  const float spin = 20.0f;
  const float stops = 0.4f * kRadius * spin / (twist * kGravity);  // 20 s.
  for (const TwistSetting& setting : twist_settings()) {
    EXPECT_NEAR(spin_after(setting, twist, spin, 0.5f * stops), 0.5f * spin, 0.01f * spin)
        << setting.name;
    EXPECT_GT(spin_after(setting, twist, spin, 0.99f * stops), 0.0f) << setting.name;
    EXPECT_LT(std::abs(spin_after(setting, twist, spin, 1.01f * stops)), 1.0e-3f) << setting.name;
  }
}

TEST(Twist, WithoutResistanceABallSpinsOn) {
  for (const TwistSetting& setting : twist_settings())
    EXPECT_NEAR(spin_after(setting, 0.0f, 20.0f, 10.0f), 20.0f, 0.02f) << setting.name;
}

// Rolling resistance is about axes across the normal, twist about the normal: each leaves the
// other's motion alone.
TEST(Twist, AndRollingDoNotMix) {
  for (const TwistSetting& setting : twist_settings()) {
    const float resistance = 0.02f;
    World<3> rolls = ground_of<3>(setting.tuning, {0.6f, 0.0f, resistance, 0.0f});
    World<3> twists = ground_of<3>(setting.tuning, {0.6f, 0.0f, 0.0f, resistance});
    const Vec<3> velocity = {{3.0f, 0.0f, 0.0f}};
    const Vec<3> spin = {{0.0f, 4.0f, -3.0f / kRadius}};
    const BodyId rolling = add_spinning(rolls, velocity, spin);
    const BodyId twisting = add_spinning(twists, velocity, spin);
    step(rolls, 120);
    step(twists, 120);
    // m a = f and I a / r = c r N - f r: a = 5/7 c g.
    const float slowed = 5.0f / 7.0f * resistance * kGravity * 2.0f;
    EXPECT_NEAR(3.0f - view(rolls, rolling).velocity[0], slowed, 0.01f * slowed) << setting.name;
    EXPECT_NEAR(view(rolls, rolling).spin[1], 4.0f, 0.004f) << setting.name;
    EXPECT_NEAR(view(twists, twisting).velocity[0], 3.0f, 0.003f) << setting.name;
    const float twisted = 2.5f * resistance * kGravity / kRadius * 2.0f;
    EXPECT_NEAR(4.0f - view(twists, twisting).spin[1], twisted, 0.01f * twisted) << setting.name;
  }
}

TEST(Twist, OnASlopingPlaneIsAboutItsNormal) {
  Vec<3> normal = {{-0.6f, 0.8f, 0.0f}};
  WorldDef<3> def = with_gravity<3>({10.0f, 0.0f, 10.0f, 0.02f});
  def.gravity = -kGravity * normal;
  def.tuning.sleep_s = 0.0f;
  World<3> world = make_world(def);
  add_ground<3>(world, normal);
  BodyDef<3> ball_def;
  ball_def.position = kRadius * normal;
  ball_def.spin = 8.0f * normal;
  const BodyId id = add(world, ball_def, ball<3>(kRadius));
  step(world, 60);
  const Vec<3> spin = view(world, id).spin;
  EXPECT_NEAR(dot(spin, normal), 8.0f - 2.5f * 0.02f * kGravity / kRadius, 0.01f);
  EXPECT_NEAR(length(spin - dot(spin, normal) * normal), 0.0f, 1.0e-3f);
}

// The materials' larger one counts, and the plane ignores it.
TEST(Twist, MixesByTheLargerAndIsNothingInThePlane) {
  WorldDef<3> def = with_gravity<3>({0.6f, 0.0f, 0.0f, 0.05f});
  def.materials.push_back({0.6f, 0.0f, 0.0f, 0.02f});
  def.tuning.sleep_s = 0.0f;
  World<3> world = make_world(def);
  add_ground<3>(world, up<3>());
  BodyDef<3> body;
  body.position = {{0.0f, kRadius, 0.0f}};
  body.spin = {{0.0f, 20.0f, 0.0f}};
  ShapeDef<3> shape = ball<3>(kRadius);
  shape.material = 1;
  const BodyId id = add(world, body, shape);
  step(world, 60);
  EXPECT_EQ(world.statistics().rows_per_sweep, 6u);
  EXPECT_NEAR(view(world, id).spin[1], 20.0f - 2.5f * 0.05f * kGravity / kRadius, 0.03f);

  const auto planar = [](float twist) {
    World<2> plane = ground_of<2>(Tuning::soft_step(), {0.6f, 0.0f, 0.0f, twist});
    BodyDef<2> disc;
    disc.position = {{0.0f, kRadius}};
    disc.spin = {{-6.0f}};
    const BodyId disc_id = add(plane, disc, ball<2>(kRadius));
    step(plane, 60);
    EXPECT_EQ(plane.statistics().rows_per_sweep, 2u);
    return view(plane, disc_id);
  };
  EXPECT_EQ(planar(0.0f).spin[0], planar(5.0f).spin[0]);
  EXPECT_EQ(planar(0.0f).position[0], planar(5.0f).position[0]);
}

/// A capsule on its side that spins about the vertical: moments 3.9 times apart.
static ShapeDef<3> lying_capsule() {
  ShapeDef<3> shape;
  shape.kind = ShapeKind::kCapsule;
  shape.points = {{{-0.4f, 0.0f, 0.0f}}, {{0.4f, 0.0f, 0.0f}}};
  shape.radius = 0.2f;
  return shape;
}

static float moment_about_own_axis(const World<3>& world, BodyId id, int axis) {
  return world.state().bodies[id.index].inertia.m[4 * axis];
}

// Frictionless, so that only the twist slows it: I_y w' = -twist r m g.
TEST(Twist, SlowsALyingCapsuleByItsOwnMoment) {
  for (const TwistSetting& setting : twist_settings()) {
    World<3> world = ground_of<3>(setting.tuning, {0.0f, 0.0f, 0.0f, 0.1f});
    BodyDef<3> def;
    def.position = {{0.0f, 0.2f, 0.0f}};
    def.spin = {{0.0f, 10.0f, 0.0f}};
    const BodyId id = add(world, def, lying_capsule());
    const float mass = 1.0f / world.state().bodies[id.index].inverse_mass;
    const float slows = 0.1f * 0.2f * mass * kGravity / moment_about_own_axis(world, id, 1);
    step(world, 60);
    EXPECT_NEAR(10.0f - view(world, id).spin[1], slows, 0.01f * slows) << setting.name;
  }
}

// m a = f, I_x a / r = c r N - f r: a = c g / (1 + I_x / (m r^2)). It rolls about its long axis, at
// 30 degrees to the axes of the world.
TEST(Twist, RollingResistanceOfACapsuleTakesItsMomentAboutItsAxis) {
  for (TwistSetting setting : twist_settings()) {
    // One sweep of Gauss-Seidel rocks a capsule on its two points, with resistance or without.
    setting.tuning.sweeps = std::max(setting.tuning.sweeps, 2u);
    const float c = 0.05f;
    World<3> world = ground_of<3>(setting.tuning, {1.0f, 0.0f, c, 0.0f});
    BodyDef<3> def;
    const float half_angle = 0.26179939f;
    def.position = {{0.0f, 0.2f, 0.0f}};
    def.rotation = {{0.0f, std::sin(half_angle), 0.0f, std::cos(half_angle)}};
    const Vec<3> axis = rotate(def.rotation, Vec<3>{{1.0f, 0.0f, 0.0f}});
    const Vec<3> along = cross(axis, up<3>());
    def.spin = 5.0f * axis;
    def.velocity = spin_cross(def.spin, Vec<3>{{0.0f, 0.2f, 0.0f}});
    const BodyId id = add(world, def, lying_capsule());
    const float mass = 1.0f / world.state().bodies[id.index].inverse_mass;
    const float share = 1.0f / (1.0f + moment_about_own_axis(world, id, 0) / (mass * 0.04f));
    step(world, 20);
    const float before = dot(view(world, id).velocity, along);
    step(world, 40);
    const Vec<3> velocity = view(world, id).velocity;
    const float expected = share * c * kGravity * 40.0f / 60.0f;
    EXPECT_NEAR(std::abs(before) - std::abs(dot(velocity, along)), expected, 0.02f * expected)
        << setting.name;
    EXPECT_NEAR(dot(velocity, axis), 0.0f, 0.01f) << setting.name;
    step(world, 300);
    EXPECT_LT(length(view(world, id).velocity), 1.0e-3f) << setting.name;
  }
}

TEST(Twist, RefusesWhatIsNoResistance) {
  WorldDef<3> def;
  for (const float bad : {-0.1f, NAN, INFINITY}) {
    def.materials = {{0.6f, 0.0f, 0.0f, bad}};
    const Result<World<3>> world = World<3>::create(def);
    ASSERT_FALSE(world.ok());
    EXPECT_STREQ(world.error().field, "twist_resistance");
  }
}

}  // namespace cycloid::solver
