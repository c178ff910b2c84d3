#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// Rows that cannot act are not built, and rolling resistance.

struct RowSetting {
  const char* name;
  Tuning tuning;
};

static std::vector<RowSetting> row_settings() {
  std::vector<RowSetting> all = {{"soft_step", Tuning::soft_step()},
                                 {"pgs", Tuning::pgs()},
                                 {"split_impulse", Tuning::split_impulse()},
                                 {"pgs_ngs", Tuning::pgs_ngs()},
                                 {"tgs_ngs", Tuning::tgs_ngs()},
                                 {"xpbd", Tuning::xpbd()}};
  for (RowSetting& setting : all) setting.tuning.sleep_s = 0.0f;
  return all;
}

static std::vector<RowSetting> row_velocity_settings() {
  std::vector<RowSetting> all = row_settings();
  all.pop_back();
  return all;
}

template <int D>
static World<D> world_with(const Tuning& tuning, Material material) {
  WorldDef<D> def = with_gravity<D>(material);
  def.tuning = tuning;
  return make_world(def);
}

/// Three balls dropped on one another, each `aside` of the one below.
template <int D>
static World<D> balls(const Tuning& tuning, float friction, BodyKind kind, bool fixed,
                      float aside) {
  World<D> world = world_with<D>(tuning, {friction, 0.0f});
  add_ground<D>(world, up<D>());
  for (int i = 0; i < 3; ++i) {
    BodyDef<D> def;
    def.kind = kind;
    def.mass = 1.0f + static_cast<float>(i);
    def.position[0] = aside * static_cast<float>(i);
    def.position[1] = 0.6f + 1.05f * static_cast<float>(i);
    def.fixed_rotation = fixed;
    add(world, def, ball<D>(0.5f));
  }
  return world;
}

/// What is compared: all but the fixed and the particles also aside, where arms that are not quite
/// along the normal turn a ball that can.
template <int D>
static void check_reduction(const RowSetting& setting, float aside) {
  constexpr auto kTangents = static_cast<std::uint32_t>(Dim<D>::kTangents);
  World<D> bare = balls<D>(setting.tuning, 0.0f, BodyKind::kDynamic, false, aside);
  World<D> rubbed = balls<D>(setting.tuning, 1.0e-12f, BodyKind::kDynamic, false, aside);
  World<D> fixed = balls<D>(setting.tuning, 0.0f, BodyKind::kDynamic, true, aside);
  World<D> particles = balls<D>(setting.tuning, 0.0f, BodyKind::kParticle, false, aside);
  for (int tick = 0; tick < 40; ++tick) {
    for (World<D>* world : {&bare, &rubbed, &fixed, &particles}) step(*world, 1);
    const std::uint32_t contacts = bare.statistics().contacts;
    EXPECT_EQ(bare.statistics().rows_per_sweep, contacts);
    EXPECT_EQ(bare.statistics().turning_rows_per_sweep, contacts);
    EXPECT_EQ(rubbed.statistics().rows_per_sweep, contacts * (1 + kTangents));
    EXPECT_EQ(fixed.statistics().rows_per_sweep, fixed.statistics().contacts);
    EXPECT_EQ(fixed.statistics().turning_rows_per_sweep, 0u);
    EXPECT_EQ(particles.statistics().turning_rows_per_sweep, 0u);
  }
  EXPECT_GT(bare.statistics().contacts, 1u) << setting.name;
  for (std::uint32_t i = 1; i <= 3; ++i) {
    const Vec<D> whole = bare.state().bodies[i].position;
    EXPECT_LT(length(rubbed.state().bodies[i].position - whole), 1.0e-4f) << setting.name;
    EXPECT_LT(length(fixed.state().bodies[i].position - particles.state().bodies[i].position),
              1.0e-6f)
        << setting.name;
    if (aside > 0.0f) continue;
    EXPECT_LT(length(fixed.state().bodies[i].position - whole), 1.0e-4f) << setting.name;
  }
}

TEST(ReducedRows, AreNotBuiltAndChangeNothing) {
  for (const RowSetting& setting : row_settings())
    for (const float aside : {0.0f, 0.05f}) {
      check_reduction<2>(setting, aside);
      check_reduction<3>(setting, aside);
    }
}

// m a = f and I a / r = c r N - f r, so a = c g / (1 + I / (m r^2)): 5/7 of c g, a disc 2/3.
template <int D>
static void check_rolling(const std::vector<RowSetting>& of) {
  for (const RowSetting& setting : of) {
    const float c = 0.1f;
    World<D> world = world_with<D>(setting.tuning, {1.0f, 0.0f, c});
    add_ground<D>(world, up<D>());
    BodyDef<D> def;
    def.position[1] = 0.5f;
    def.velocity[0] = 3.0f;
    def.spin[Dim<D>::kSpin - 1] = -6.0f;
    const BodyId id = add(world, def, ball<D>(0.5f));
    step(world, 30);
    const float v0 = view(world, id).velocity[0];
    step(world, 60);
    const BodyView<D> now = view(world, id);
    const float expected = (D == 2 ? 2.0f / 3.0f : 5.0f / 7.0f) * c * 10.0f;
    EXPECT_NEAR(v0 - now.velocity[0], expected, 0.02f * expected) << setting.name << " in " << D;
    EXPECT_NEAR(now.velocity[0], -0.5f * now.spin[Dim<D>::kSpin - 1], 0.01f) << setting.name;
    step(world, 400);
    EXPECT_NEAR(length(view(world, id).velocity), 0.0f, 1.0e-3f) << setting.name << " in " << D;
  }
}

TEST(RollingResistance, SlowsABallByItsShareOfGravityUntilItRests) {
  check_rolling<2>(row_velocity_settings());
  check_rolling<3>(row_velocity_settings());
}

TEST(RollingResistance, SlowsABallUnderXpbdToo) {
  check_rolling<2>({row_settings().back()});
  check_rolling<3>({row_settings().back()});
}

template <int D>
static void check_slope(const std::vector<RowSetting>& of) {
  for (const RowSetting& setting : of)
    for (const float c : {0.24f, 0.27f}) {
      const float theta = 0.25f;  // tan = 0.2553
      Vec<D> normal = Vec<D>::zero();
      normal[0] = -std::sin(theta);
      normal[1] = std::cos(theta);
      World<D> world = world_with<D>(setting.tuning, {1.0f, 0.0f, c});
      add_ground<D>(world, normal);
      const BodyId id = add_at<D>(world, 0.5f * normal, ball<D>(0.5f));
      step(world, 30);
      const float v0 = length(view(world, id).velocity);
      step(world, 60);
      const float share = D == 2 ? 2.0f / 3.0f : 5.0f / 7.0f;
      const float rolls = share * 10.0f * (std::sin(theta) - c * std::cos(theta));
      EXPECT_NEAR(length(view(world, id).velocity) - v0, std::max(rolls, 0.0f), 0.01f)
          << setting.name << " c " << c << " in " << D;
    }
}

TEST(RollingResistance, HoldsABallOnASlopeBelowItsAngle) {
  check_slope<2>(row_velocity_settings());
  check_slope<3>(row_velocity_settings());
}

TEST(RollingResistance, HoldsABallOnASlopeUnderXpbdToo) {
  check_slope<2>({row_settings().back()});
  check_slope<3>({row_settings().back()});
}

/// A marble that has rolled on and turned about the normal for half a second.
template <int D>
static BodyView<D> marble_on(float ground_radius) {
  World<D> world = world_with<D>(Tuning{}, {1.0f, 0.0f, 0.05f, 0.05f});
  if (ground_radius > 0.0f) {
    BodyDef<D> ground;
    ground.kind = BodyKind::kStatic;
    ground.position[1] = -ground_radius;
    add(world, ground, ball<D>(ground_radius));
  } else {
    add_ground<D>(world, up<D>());
  }
  BodyDef<D> def;
  def.position[1] = 0.125f;
  def.velocity[0] = 2.0f;
  def.spin[Dim<D>::kSpin - 1] = -16.0f;
  if (D == 3) def.spin[1] = 30.0f;
  const BodyId id = add(world, def, ball<D>(0.125f));
  step(world, 30);
  return view(world, id);
}

// By the larger radius it would be stopped dead.
TEST(RollingResistance, SlowsAMarbleOnALargeBallAsOnAPlane) {
  EXPECT_NEAR(marble_on<2>(1000.0f).velocity[0], marble_on<2>(0.0f).velocity[0], 0.005f);
  EXPECT_NEAR(marble_on<3>(1000.0f).velocity[0], marble_on<3>(0.0f).velocity[0], 0.005f);
  EXPECT_NEAR(marble_on<3>(1000.0f).spin[1], marble_on<3>(0.0f).spin[1], 0.05f);
}

// Without resistance a ball that rolls without slip goes on as it is.
template <int D>
static void check_even_roll(const RowSetting& setting) {
  World<D> world = world_with<D>(setting.tuning, {1.0f, 0.0f, 0.0f});
  add_ground<D>(world, up<D>());
  BodyDef<D> def;
  def.position[1] = 0.5f;
  def.velocity[0] = 3.0f;
  def.spin[Dim<D>::kSpin - 1] = -6.0f;
  const BodyId id = add(world, def, ball<D>(0.5f));
  for (int i = 0; i < 300; ++i) {
    step(world, 1);
    ASSERT_NEAR(view(world, id).velocity[0], 3.0f, 0.02f) << setting.name << " tick " << i;
    ASSERT_NEAR(view(world, id).position[1], 0.5f, 0.01f) << setting.name << " tick " << i;
  }
}

TEST(Rolling, WithoutResistanceKeepsItsSpeed) {
  for (const RowSetting& setting : row_velocity_settings()) {
    check_even_roll<2>(setting);
    check_even_roll<3>(setting);
  }
}

TEST(Rolling, WithoutResistanceKeepsItsSpeedUnderXpbdToo) {
  check_even_roll<2>(row_settings().back());
  check_even_roll<3>(row_settings().back());
}

}  // namespace cycloid::solver
