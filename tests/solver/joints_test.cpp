#include "tests/solver/joint_scene.hpp"

namespace cycloid::solver {

/// Each kind of joint in a scene whose motion is known, under several methods.

template <int D>
static void check_equalities_hold(JointKind kind) {
  for (const Method& method : methods()) {
    Scene<D> scene(method.tuning);
    const BodyId bob = scene.add_ball(at<D>(0.0f, -1.0f), 2.0f);
    JointDef<D> def = scene.joint(kind, scene.anchor, bob);
    def.anchor_b = at<D>(0.0f, 1.0f);
    def.axis = at<D>(0.6f, 0.8f);
    if (kind == JointKind::kDistance) def.anchor_b = Vec<D>::zero();
    if (kind == JointKind::kPrismatic || kind == JointKind::kWheel) {
      // Held at its centre: on a lever, the blow of a limit also turns the soft rows of a joint.
      def.anchor_a = at<D>(0.0f, -1.0f);
      def.anchor_b = Vec<D>::zero();
      def.limit_enabled = true;
      def.lower = -0.5f;
      def.upper = 0.5f;
    }
    def.curve = CurveKind::kCircle;
    def.size = {1.0f, 1.0f};
    if (kind == JointKind::kCurve) def.anchor_b = Vec<D>::zero();
    const JointId id = scene.create(def);
    // Slow enough for the error that Baumgarte leaves on a bend, v^2 h^2 / (2 beta r) = 0.7 mm.
    ASSERT_TRUE(scene.world.apply_impulse(bob, at<D>(2.0f, 0.0f)).ok());
    for (int i = 0; i < 600; ++i) {
      step(scene.world, 1);
      ASSERT_LT(scene.error(id), 0.005f)
          << method.name << " tick " << i << " of kind " << static_cast<int>(kind);
      if (!def.limit_enabled) continue;
      ASSERT_GT(scene.rows(id).axis.error, def.lower - 0.005f) << method.name;
      ASSERT_LT(scene.rows(id).axis.error, def.upper + 0.005f) << method.name;
    }
  }
}

TEST(Joints, EqualitiesStayWithinTheSlopForTenSeconds) {
  for (const JointKind kind : {JointKind::kDistance, JointKind::kRevolute, JointKind::kPrismatic,
                               JointKind::kWheel, JointKind::kWeld, JointKind::kCurve})
    check_equalities_hold<2>(kind);
  for (const JointKind kind :
       {JointKind::kDistance, JointKind::kRevolute, JointKind::kPrismatic, JointKind::kWeld})
    check_equalities_hold<3>(kind);
}

template <int D>
static void check_free_turn(JointKind kind) {
  for (const Method& method : methods()) {
    Scene<D> scene(method.tuning, false);
    const BodyId wheel = scene.add_ball(at<D>(1.0f, 0.0f), 2.0f);
    JointDef<D> def = scene.joint(kind, scene.anchor, wheel);
    def.anchor_a = at<D>(1.0f, 0.0f);
    def.axis = at<D>(0.0f, 1.0f);
    const JointId id = scene.create(def);
    twist(scene.world, wheel, 0.1f, 60);
    const float expected = 0.1f / ball_inertia<D>(2.0f, 0.25f);
    EXPECT_NEAR(view(scene.world, wheel).spin[Dim<D>::kSpin - 1], expected, 0.01f * expected)
        << method.name;
    EXPECT_LT(scene.error(id), 1.0e-4f);
  }
}

TEST(Joints, WhatTurnsFreelyTurnsByItsInertia) {
  check_free_turn<2>(JointKind::kRevolute);
  check_free_turn<3>(JointKind::kRevolute);
  check_free_turn<2>(JointKind::kWheel);
}

template <int D>
static void check_free_slide(JointKind kind) {
  for (const Method& method : methods()) {
    Scene<D> scene(method.tuning, false);
    const BodyId slider = scene.add_ball(at<D>(1.0f, 0.0f), 2.0f);
    JointDef<D> def = scene.joint(kind, scene.anchor, slider);
    def.anchor_a = at<D>(1.0f, 0.0f);
    def.axis = at<D>(0.6f, 0.8f);
    const JointId id = scene.create(def);
    push(scene.world, slider, at<D>(3.0f, -1.0f), 60);  // 1 N along the axis.
    EXPECT_NEAR(dot(view(scene.world, slider).velocity, def.axis), 0.5f, 0.005f) << method.name;
    EXPECT_LT(scene.error(id), 0.001f) << method.name;
    EXPECT_NEAR(length(view(scene.world, slider).spin), 0.0f, 1.0e-4f) << method.name;
  }
}

TEST(Joints, WhatSlidesFreelySlidesByItsMass) {
  check_free_slide<2>(JointKind::kPrismatic);
  check_free_slide<3>(JointKind::kPrismatic);
  check_free_slide<2>(JointKind::kWheel);
}

// At rest the spring carries the weight: k = m omega^2, so it sags by g / omega^2 at any mass.
TEST(Joints, SuspensionAndSoftWeldSagByGravityOverFrequencySquared) {
  for (const Method& method : methods())
    for (const float mass : {1.0f, 200.0f})
      for (const JointKind kind : {JointKind::kWheel, JointKind::kWeld, JointKind::kPrismatic}) {
        Scene<2> scene(method.tuning);
        const BodyId wheel = scene.add_ball({{0.0f, -1.0f}}, mass);
        JointDef<2> def = scene.joint(kind, scene.anchor, wheel);
        def.anchor_a = {{0.0f, -1.0f}};
        def.axis = up<2>();
        def.hertz = 2.0f;
        def.damping_ratio = 0.8f;
        scene.create(def);
        step(scene.world, 300);
        const float sag = 10.0f / ((kPi2 * 2.0f) * (kPi2 * 2.0f));
        EXPECT_NEAR(-1.0f - view(scene.world, wheel).position[1], sag, 0.01f * sag)
            << method.name << " kind " << static_cast<int>(kind) << " mass " << mass;
        EXPECT_NEAR(length(view(scene.world, wheel).velocity), 0.0f, 1.0e-3f) << method.name;
      }
}

TEST(Joints, WeldedCantileverStaysLevel) {
  for (const Method& method : methods()) {
    Scene<2> scene(method.tuning);
    const BodyId beam = add_at<2>(scene.world, {{1.0f, 0.0f}}, box(1.0f, 0.1f));
    JointDef<2> def = scene.joint(JointKind::kWeld, scene.anchor, beam);
    def.anchor_b = {{-1.0f, 0.0f}};
    scene.create(def);
    step(scene.world, 600);
    EXPECT_NEAR(view(scene.world, beam).position[1], 0.0f, 0.005f) << method.name;
    EXPECT_NEAR(view(scene.world, beam).rotation[1], 0.0f, 0.005f) << method.name;
  }
}

TEST(Joints, MotorJointHoldsBelowItsBoundsAndYieldsByTheRest) {
  for (const Method& method : methods()) {
    Scene<2> scene(method.tuning, false);
    const BodyId sledge = scene.add_ball({{0.0f, 0.0f}}, 2.0f);
    JointDef<2> def = scene.joint(JointKind::kMotor, scene.anchor, sledge);
    def.force_max = 6.0f;
    def.torque_max = 0.2f;
    scene.create(def);
    push(scene.world, sledge, {{4.0f, 3.0f}}, 60);
    EXPECT_LT(length(view(scene.world, sledge).position), 0.002f) << method.name;
    twist(scene.world, sledge, 0.19f, 60);
    EXPECT_LT(std::abs(view(scene.world, sledge).rotation[1]), 0.01f) << method.name;

    const float v0 = view(scene.world, sledge).velocity[0];
    push(scene.world, sledge, {{10.0f, 0.0f}}, 60);
    EXPECT_NEAR(view(scene.world, sledge).velocity[0] - v0, 2.0f, 0.02f) << method.name;
  }
}

TEST(Joints, MotorJointTurnsByTheTorqueBeyondItsBound) {
  for (const Method& method : methods()) {
    Scene<2> scene(method.tuning, false);
    const BodyId sledge = scene.add_ball({{0.0f, 0.0f}}, 2.0f);
    JointDef<2> def = scene.joint(JointKind::kMotor, scene.anchor, sledge);
    def.force_max = 6.0f;
    def.torque_max = 0.2f;
    scene.create(def);
    twist(scene.world, sledge, 0.25f, 30);
    const float expected = 0.5f * 0.05f / ball_inertia<2>(2.0f, 0.25f);
    EXPECT_NEAR(view(scene.world, sledge).spin[0], expected, 0.02f * expected) << method.name;
  }
}

template <int D>
static void check_target() {
  for (const Method& method : methods()) {
    Scene<D> scene(method.tuning);
    const BodyId held = scene.add_ball(at<D>(0.0f, 0.0f), 2.0f);
    JointDef<D> def = scene.joint(JointKind::kTarget, scene.anchor, held);
    def.hertz = 4.0f;
    def.damping_ratio = 1.0f;
    def.force_max = 1000.0f;
    const JointId id = scene.create(def);
    step(scene.world, 180);
    const float sag = 10.0f / ((kPi2 * 4.0f) * (kPi2 * 4.0f));
    EXPECT_NEAR(-view(scene.world, held).position[1], sag, 0.02f * sag) << method.name;

    ASSERT_TRUE(scene.world.destroy_joint(id).ok());
    def.force_max = 12.0f;  // Of a weight of 20 N.
    scene.create(def);
    step(scene.world, 60);
    const float v0 = view(scene.world, held).velocity[1];
    step(scene.world, 60);
    EXPECT_NEAR(view(scene.world, held).velocity[1] - v0, -4.0f, 0.04f) << method.name;
  }
}

TEST(Joints, TargetHoldsByItsSpringAndNeverPullsHarderThanItsForce) {
  check_target<2>();
  check_target<3>();
}

/// |C| of a spring without its damping decays by the log decrement 2 pi zeta / sqrt(1 - zeta^2) a
/// period. Implicit Euler adds at most omega h to zeta, so h is small here.
template <int D>
static void check_spring(const Method& method, float mass) {
  Scene<D> scene(method.tuning.in_substeps(64), false);
  const BodyId bob = scene.add_ball(at<D>(1.3f, 0.0f), mass);
  JointDef<D> def = scene.joint(JointKind::kDistance, scene.anchor, bob);
  def.hertz = 0.5f;
  def.damping_ratio = 0.1f;
  scene.create(def);
  std::vector<double> crossings;
  std::vector<double> peaks;
  double before = 0.3;
  double peak = 0.0;
  for (int tick = 1; tick <= 600; ++tick) {
    step(scene.world, 1);
    const double x = view(scene.world, bob).position[0] - 1.0f;
    if ((x < 0.0) != (before < 0.0)) {
      crossings.push_back((tick - 1 + before / (before - x)) * kTick);
      peaks.push_back(peak);
      peak = 0.0;
    }
    peak = std::max(peak, std::abs(x));
    before = x;
  }
  ASSERT_GE(crossings.size(), 8u) << method.name;
  const double zeta = 0.1;
  const double period = 2.0 / std::sqrt(1.0 - zeta * zeta);
  EXPECT_NEAR(crossings[6] - crossings[0], 3.0 * period, 0.02 * 3.0 * period) << method.name;
  const double decrement = kPi2 * zeta / std::sqrt(1.0 - zeta * zeta);
  EXPECT_NEAR(std::log(peaks[1] / peaks[5]) / 2.0, decrement, 0.02 * decrement) << method.name;
}

TEST(Joints, DistanceSpringHasItsFrequencyAndDecrementAtAnyMass) {
  for (const Method& method : methods())
    for (const float mass : {1.0f, 1000.0f}) {
      check_spring<2>(method, mass);
      check_spring<3>(method, mass);
    }
}

template <int D>
static void check_rope() {
  for (const Method& method : methods()) {
    Scene<D> scene(method.tuning);
    const BodyId bob = scene.add_ball(at<D>(0.0f, -1.0f), 3.0f);
    JointDef<D> def = scene.joint(JointKind::kDistance, scene.anchor, bob);
    def.limit_enabled = true;
    def.upper = 2.0f;
    const JointId id = scene.create(def);
    step(scene.world, 24);  // 0.8 m of fall in 0.4 s.
    EXPECT_NEAR(view(scene.world, bob).velocity[1], -4.0f, 1.0e-4f) << method.name;
    EXPECT_EQ(scene.state_of(id).upper_impulse, 0.0f) << method.name;
    for (int i = 0; i < 300; ++i) {
      step(scene.world, 1);
      ASSERT_GT(view(scene.world, bob).position[1], -2.005f) << method.name;
    }
    EXPECT_NEAR(view(scene.world, bob).position[1], -2.0f, 0.005f) << method.name;
    EXPECT_NEAR(view(scene.world, bob).velocity[1], 0.0f, 1.0e-3f) << method.name;
  }
}

TEST(Joints, RopeIsSlackUntilItsLengthAndThenHolds) {
  check_rope<2>();
  check_rope<3>();
}

// A weight on a rod, a pulley or a wire, which limits then make slack.
TEST(Joints, ImpulsesOfAnEqualityThatIsSwitchedOffAreForgotten) {
  for (const Method& method : methods())
    for (const JointKind kind : {JointKind::kDistance, JointKind::kPulley, JointKind::kCurve}) {
      Scene<2> scene(method.tuning);
      const BodyId bob = scene.add_ball({{0.0f, -1.0f}}, 2.0f);
      JointDef<2> def = scene.joint(kind, scene.anchor, bob);
      def.ground_a = {{0.0f, 1.0f}};
      def.length = kind == JointKind::kPulley ? 2.0f : 1.0f;
      def.size = {1.0f, 1.0f};
      const JointId id = scene.create(def);
      step(scene.world, 30);
      const bool is_projected = method.tuning.stabilisation == Stabilisation::kXpbd;
      EXPECT_EQ(scene.state_of(id).impulse[0] == 0.0f, is_projected) << method.name;
      ASSERT_TRUE(scene.world.set_limits(id, true, -9.0f, 9.0f).ok());
      step(scene.world, 1);
      EXPECT_EQ(scene.state_of(id).impulse[0], 0.0f)
          << method.name << " kind " << static_cast<int>(kind);
    }
}

/// A disc on a pin at `arm` from its centre falls against its limits, then is pulled to the others.
static void check_revolute_limits(const Method& method, float arm) {
  Scene<2> scene(method.tuning);
  const BodyId bob = scene.add_ball({{arm, 0.0f}}, 2.0f);
  JointDef<2> def = scene.joint(JointKind::kRevolute, scene.anchor, bob);
  def.anchor_b = {{-arm, 0.0f}};
  def.limit_enabled = true;
  def.lower = -0.6f;
  def.upper = 0.4f;
  const JointId id = scene.create(def);
  bool was_inside = false;
  float lowest = 0.0f;
  for (int i = 0; i < 300; ++i) {
    step(scene.world, 1);
    const float angle = scene.world.joint_angle(id).value();
    lowest = std::min(lowest, angle);
    if (angle < -0.45f) continue;
    was_inside = true;
    EXPECT_EQ(scene.state_of(id).lower_impulse, 0.0f) << method.name;
    EXPECT_EQ(scene.state_of(id).upper_impulse, 0.0f) << method.name;
  }
  EXPECT_TRUE(was_inside);
  EXPECT_GT(lowest, -0.605f) << method.name;
  EXPECT_NEAR(scene.world.joint_angle(id).value(), -0.6f, 0.005f) << method.name;
  ASSERT_TRUE(scene.world.set_gravity({{0.0f, 10.0f}}).ok());
  step(scene.world, 300);
  EXPECT_NEAR(scene.world.joint_angle(id).value(), 0.4f, 0.005f) << method.name;
}

TEST(Joints, RevoluteLimitsHoldAndPushNothingInside) {
  for (const Method& method : methods()) check_revolute_limits(method, 0.1f);
}

// The arm's m r^2 is 32 times the disc's own inertia, on which the limit's row is solved.
TEST(Joints, RevoluteLimitsHoldAtTheEndOfALongArm) {
  for (const Method& method : methods()) check_revolute_limits(method, 1.0f);
}

}  // namespace cycloid::solver
