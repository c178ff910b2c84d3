#include "tests/solver/space_fixture.hpp"

namespace cycloid::solver {

/// What a body that nothing touches keeps, in double, from its state.
struct FreeMotion {
  double moments[3];  ///< Principal, of the body's axes: the bodies here are boxes.
  double spin[3];     ///< Body frame, rad/s.

  double energy() const {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) sum += 0.5 * moments[i] * spin[i] * spin[i];
    return sum;
  }
  double momentum_square() const {
    double sum = 0.0;
    for (int i = 0; i < 3; ++i) sum += moments[i] * moments[i] * spin[i] * spin[i];
    return sum;
  }
};

static FreeMotion motion_of(const World<3>& world, BodyId id) {
  const Body<3>& body = world.state().bodies[id.index];
  const Vec<3> spin = rotate_back(body.rotation, body.spin);
  FreeMotion motion{};
  for (int i = 0; i < 3; ++i) {
    motion.moments[i] = static_cast<double>(body.inertia.m[4 * i]);
    motion.spin[i] = static_cast<double>(spin[i]);
  }
  return motion;
}

/// The complete elliptic integral of the first kind, by the arithmetic-geometric mean.
static double elliptic_k(double m) {
  double a = 1.0;
  double b = std::sqrt(1.0 - m);
  for (int i = 0; i < 40; ++i) {
    const double mean = 0.5 * (a + b);
    b = std::sqrt(a * b);
    a = mean;
  }
  return std::acos(-1.0) / (2.0 * a);
}

/// Half a period of the spin about the middle axis, s: from flip to flip. Moments ascend.
/// Source: Landau and Lifshitz, "Mechanics", section 37.
static double flip_time(const FreeMotion& free) {
  const double* i = free.moments;
  const double l2 = free.momentum_square();
  const double e2 = 2.0 * free.energy();
  double rate_square = (i[2] - i[1]) * (l2 - e2 * i[0]) / (i[0] * i[1] * i[2]);
  double m = (i[1] - i[0]) * (e2 * i[2] - l2) / ((i[2] - i[1]) * (l2 - e2 * i[0]));
  if (l2 < e2 * i[1]) {
    rate_square = (i[1] - i[0]) * (e2 * i[2] - l2) / (i[0] * i[1] * i[2]);
    m = 1.0 / m;
  }
  return 2.0 * elliptic_k(m) / std::sqrt(rate_square);
}

/// Times at which the body's spin about its middle axis changes sign, s.
static std::vector<double> flips_of(World<3>& world, BodyId id, int ticks) {
  std::vector<double> times;
  double before = motion_of(world, id).spin[1];
  for (int tick = 1; tick <= ticks; ++tick) {
    EXPECT_TRUE(world.step().ok());
    const double now = motion_of(world, id).spin[1];
    if (before * now < 0.0)
      times.push_back((tick - 1 + before / (before - now)) * static_cast<double>(world.tick_s()));
    before = now;
  }
  return times;
}

TEST(IntermediateAxis, FlipsWithThePeriodOfEulersEquations) {
  // Near the separatrix the period answers to the logarithm of the disturbance, which rounding
  // walks off: a hundredth of the spin keeps 2e-6 of the energy away from it.
  const std::pair<float, double> cases[] = {{0.01f, 0.1}, {0.1f, 0.002}};
  for (const auto& [disturbance, tolerance] : cases) {
    World<3> world = make_world(WorldDef<3>{});
    BodyDef<3> def;
    def.spin = {{disturbance, 5.0f, disturbance}};
    const BodyId id = add(world, def, box_def({{1.0f, 0.6f, 0.2f}}));
    const FreeMotion start = motion_of(world, id);
    const std::vector<double> flips = flips_of(world, id, 3600);
    ASSERT_GE(flips.size(), 5u) << disturbance;
    const double expected = flip_time(start);
    const double measured = (flips.back() - flips.front()) / static_cast<double>(flips.size() - 1);
    EXPECT_NEAR(measured / expected, 1.0, tolerance) << disturbance;
    const FreeMotion end = motion_of(world, id);
    EXPECT_NEAR(end.energy() / start.energy(), 1.0, 1e-3) << disturbance;
    EXPECT_NEAR(std::sqrt(end.momentum_square() / start.momentum_square()), 1.0, 1e-3);
  }
}

TEST(LongRod, SpinningFastKeepsItsEnergy) {
  World<3> world = make_world(WorldDef<3>{});
  BodyDef<3> def;
  def.spin = {{100.0f, 1.0f, 0.5f}};
  // Moments 1 : 100 : 100, where the explicit gyroscopic term diverges within a second.
  const BodyId id = add(world, def, box_def({{1.0f, 0.0709f, 0.0709f}}));
  const FreeMotion start = motion_of(world, id);
  EXPECT_NEAR(start.moments[1] / start.moments[0], 100.0, 1.0);
  step(world, 3600);
  const FreeMotion end = motion_of(world, id);
  EXPECT_NEAR(end.energy() / start.energy(), 1.0, 1e-3);
  EXPECT_NEAR(std::sqrt(end.momentum_square() / start.momentum_square()), 1.0, 1e-3);
}

// Across its length a needle has a large momentum and, about its length, a small moment: simple
// iteration of the midpoint diverges there, and the needle spins up a hundredfold.
TEST(Needle, SpinningAcrossItsLengthKeepsItsEnergy) {
  const Vec<3> spins[] = {{{5.0f, 0.0f, 50.0f}}, {{1.0f, 100.0f, 3.0f}}};
  for (const Vec<3>& spin : spins)
    for (const float thickness : {0.02f, 0.005f}) {
      World<3> world = make_world(WorldDef<3>{});
      BodyDef<3> def;
      def.spin = spin;
      const BodyId id = add(world, def, box_def({{0.5f, thickness, 0.02f}}));
      const FreeMotion start = motion_of(world, id);
      step(world, 3600);
      const FreeMotion end = motion_of(world, id);
      EXPECT_NEAR(end.energy() / start.energy(), 1.0, 5e-3) << thickness;
      EXPECT_NEAR(std::sqrt(end.momentum_square() / start.momentum_square()), 1.0, 1e-3);
    }
}

// From the lightest body there may be to a long one of the heaviest: moments of 1e-16 to 1e22 kg
// m^2, whose third power no float holds.
TEST(Brick, OfAnySizeKeepsItsEnergy) {
  for (float size = 2.0e-4f; size < 3.0e5f; size *= 4.0f) {
    WorldDef<3> world_def;
    world_def.tuning.sleep_s = 0.0f;
    World<3> world = make_world(world_def);
    BodyDef<3> def;
    def.mass = clamp(1000.0f * size * size * size, 1.0e-9f, 1.0e12f);
    def.spin = {{2.0f, 1.4f, -0.6f}};
    const BodyId id = add(world, def, box_def({{size, 0.5f * size, 0.75f * size}}));
    const FreeMotion start = motion_of(world, id);
    step(world, 120);
    const FreeMotion end = motion_of(world, id);
    EXPECT_NEAR(end.energy() / start.energy(), 1.0, 1e-3) << size;
    EXPECT_NEAR(std::sqrt(end.momentum_square() / start.momentum_square()), 1.0, 1e-3) << size;
  }
}

// Of two metres and a tenth to half of a millimetre: their moments are a million to a hundred
// million to one, and the drop is 0.8 m, which is 4 m/s.
TEST(Wire, DroppedOnAPlaneStaysDown) {
  for (const float thin : {5.0e-4f, 2.0e-4f, 1.0e-4f})
    for (const ShapeDef<3>& shape :
         {box_def({{1.0f, thin, thin}}), capsule_def({{-1.0f, 0, 0}}, {{1.0f, 0, 0}}, thin)}) {
      World<3> world = make_world(with_gravity<3>());
      add_ground<3>(world, up<3>());
      BodyDef<3> def;
      def.position = {{0.0f, 0.8f, 0.0f}};
      def.rotation = normalized_or(Rotation<3>{{0.18f, 0.37f, 0.1f, 0.73f}}, def.rotation);
      ShapeDef<3> heavy = shape;
      heavy.density = 1000.0f;
      const BodyId id = add(world, def, heavy);
      for (int tick = 0; tick < 300; ++tick) {
        step(world, 1);
        const BodyView<3> now = view(world, id);
        ASSERT_LT(now.position[1], 0.81f) << thin << " tick " << tick;
        ASSERT_LT(length(now.velocity), 5.0f) << thin << " tick " << tick;
      }
    }
}

/// A flat square plate on a mass-less stem, on a ball joint at the origin.
struct Top {
  static constexpr double kArm = 0.5;  ///< m from the pivot to the plate.
  World<3> world = make_world(with_gravity<3>());
  BodyId plate;
  double mass;
  double along;   ///< Moment about the stem, kg m^2.
  double across;  ///< About the pivot.

  Top(const Rotation<3>& rotation, const Vec<3>& spin) {
    BodyDef<3> frame;
    frame.kind = BodyKind::kStatic;
    const BodyId pivot = world.create_body(frame, {}).value();
    BodyDef<3> def;
    def.rotation = rotation;
    def.position = rotate(rotation, Vec<3>{{0.0f, static_cast<float>(kArm), 0.0f}});
    def.spin = spin;
    def.velocity = cross(spin, def.position);
    plate = add(world, def, box_def({{0.4f, 0.05f, 0.4f}}));
    JointDef<3> joint;
    joint.body_a = pivot;
    joint.body_b = plate;
    joint.anchor_b = {{0.0f, -static_cast<float>(kArm), 0.0f}};
    EXPECT_TRUE(world.create_joint(joint).ok());
    const Body<3>& body = world.state().bodies[plate.index];
    mass = static_cast<double>(body.mass);
    along = static_cast<double>(body.inertia.m[4]);
    across = static_cast<double>(body.inertia.m[0]) + mass * kArm * kArm;
  }
  Vec<3> stem() const { return rotate(view(world, plate).rotation, up<3>()); }
  double tilt() const { return std::acos(static_cast<double>(stem()[1])); }
};

static Rotation<3> tilted(double angle) {
  return {{0.0f, 0.0f, -static_cast<float>(std::sin(0.5 * angle)),
           static_cast<float>(std::cos(0.5 * angle))}};
}

// Upright it is stable iff w^2 > 4 I1 m g l / I3^2.
TEST(SleepingTop, StandsAboveTheCriticalRateAndFallsBelow) {
  const Top measures(identity_rotation<3>(), Vec<3>::zero());
  const double critical =
      std::sqrt(4.0 * measures.across * measures.mass * 10.0 * Top::kArm) / measures.along;
  for (const double factor : {0.8, 1.2}) {
    const Rotation<3> rotation = tilted(0.01);
    const Vec<3> stem = rotate(rotation, up<3>());
    Top top(rotation, static_cast<float>(factor * critical) * stem);
    double highest = 0.0;
    for (int tick = 0; tick < 600; ++tick) {
      ASSERT_TRUE(top.world.step().ok());
      highest = std::max(highest, top.tilt());
    }
    if (factor > 1.0)
      EXPECT_LT(highest, 0.05);
    else
      EXPECT_GT(highest, 0.3);
  }
}

TEST(Top, PrecessesSteadilyAtTheRateOfTheory) {
  constexpr double kTilt = 0.5;
  constexpr double kRate = 80.0;  // About the stem, rad/s.
  const Top measures(identity_rotation<3>(), Vec<3>::zero());
  // I1 cos(tilt) P^2 - I3 w3 P + m g l = 0: the slow root.
  const double a = measures.across * std::cos(kTilt);
  const double b = measures.along * kRate;
  const double c = measures.mass * 10.0 * Top::kArm;
  const double precession = (b - std::sqrt(b * b - 4.0 * a * c)) / (2.0 * a);
  const Rotation<3> rotation = tilted(kTilt);
  const Vec<3> stem = rotate(rotation, up<3>());
  const auto about_stem = static_cast<float>(kRate - precession * std::cos(kTilt));
  Top top(rotation, about_stem * stem + static_cast<float>(precession) * up<3>());
  double azimuth = 0.0;
  Vec<3> before = top.stem();
  const int ticks = 300;
  for (int tick = 0; tick < ticks; ++tick) {
    ASSERT_TRUE(top.world.step().ok());
    const Vec<3> now = top.stem();
    // About +y from z to x.
    azimuth += std::atan2(static_cast<double>(before[2] * now[0] - before[0] * now[2]),
                          static_cast<double>(before[0] * now[0] + before[2] * now[2]));
    before = now;
    EXPECT_NEAR(top.tilt(), kTilt, 0.01);
  }
  EXPECT_NEAR(azimuth / (precession * ticks / 60.0), 1.0, 0.01);
}

}  // namespace cycloid::solver
