#include "tests/solver/joint_scene_3d.hpp"

namespace cycloid::solver {

/// Hinges, sliders and wheels of space in scenes whose motion is known, under several methods.

// An axis that no coordinate axis is, level, so that gravity acts fully.
constexpr Vec<3> kLevel = {{0.6f, 0.0f, 0.8f}};

/// A dumbbell of 2 kg whose centre is `reach` from a hinge on the anchor at the origin.
static JointDef<3> hinged(Scene<3>& scene, const Vec<3>& centre) {
  const Vec<3> along = normalized_or(centre, up<3>());
  const BodyId bar = add_dumbbell(scene.world, centre, 0.3f * along, 2.0f);
  JointDef<3> def = scene.joint(JointKind::kHinge, scene.anchor, bar);
  def.anchor_b = -centre;
  def.axis = kLevel;
  return def;
}

// T = 2 pi sqrt(I / (m g l)) (1 + A^2 / 16), from six swings.
TEST(Joints3D, AHingedBarSwingsWithThePeriodOfAPhysicalPendulum) {
  for (const Method& method : methods()) {
    Scene<3> scene(method.tuning);
    const JointDef<3> def = hinged(scene, {{0.0f, -0.7f, 0.0f}});
    const JointId id = scene.create(def);
    const float inertia = moment_about(scene.world, def.body_b, kLevel) + 2.0f * 0.49f;
    const float speed = 0.3f;
    const Vec<3> spin = speed * kLevel;
    ASSERT_TRUE(
        scene.world.set_velocity(def.body_b, cross(spin, {{0.0f, -0.7f, 0.0f}}), spin).ok());
    const double omega = std::sqrt(2.0 * 10.0 * 0.7 / inertia);
    const double amplitude = speed / omega;
    const double period = 6.283185307 / omega * (1.0 + amplitude * amplitude / 16.0);
    double before = 0.0;
    int crossings = 0;
    double last = 0.0;
    for (int tick = 1; tick < 1200 && crossings < 12; ++tick) {
      step(scene.world, 1);
      const double now = scene.world.joint_angle(id).value();
      if (tick > 1 && (before < 0.0) != (now < 0.0)) {
        ++crossings;
        last = (tick - 1 + before / (before - now)) / 60.0;
      }
      before = now;
      ASSERT_LT(scene.error(id), 1.0e-3f) << method.name;
    }
    ASSERT_EQ(crossings, 12) << method.name;
    EXPECT_NEAR(last / 6.0, period, 0.01 * period) << method.name;
  }
}

TEST(Joints3D, AHingesMotorReachesItsSpeedByItsTorqueAndHoldsBelowIt) {
  for (const Method& method : methods()) {
    // Its velocities are those of chords.
    const float most = std::string_view(method.name) == "xpbd" ? 0.03f : 0.01f;
    Scene<3> scene(method.tuning, false);
    JointDef<3> def = hinged(scene, {{0.0f, -0.7f, 0.0f}});
    def.motor = MotorKind::kSpeed;
    def.motor_speed = 1.5f;
    def.motor_max = 3.0f;
    const JointId id = scene.create(def);
    const float inertia = moment_about(scene.world, def.body_b, kLevel) + 2.0f * 0.49f;
    step(scene.world, 15);
    EXPECT_NEAR(dot(view(scene.world, def.body_b).spin, kLevel), 0.25f * 3.0f / inertia, most)
        << method.name;
    step(scene.world, 60);
    EXPECT_NEAR(dot(view(scene.world, def.body_b).spin, kLevel), 1.5f, most) << method.name;
    // A load below the motor's torque changes nothing; one above it wins by the difference.
    turn(scene.world, def.body_b, -2.5f * kLevel, 60);
    EXPECT_NEAR(dot(view(scene.world, def.body_b).spin, kLevel), 1.5f, most) << method.name;
    turn(scene.world, def.body_b, -4.0f * kLevel, 15);
    EXPECT_NEAR(dot(view(scene.world, def.body_b).spin, kLevel), 1.5f - 0.25f / inertia, most)
        << method.name;
    EXPECT_LT(scene.error(id), 2.0e-3f) << method.name;
  }
}

TEST(Joints3D, AHingesLimitsHoldABarAtTheirAngle) {
  for (const Method& method : methods())
    for (const float side : {-1.0f, 1.0f}) {
      Scene<3> scene(method.tuning);
      // Level at first: it falls about the axis until the limit on that side.
      JointDef<3> def = hinged(scene, (-0.7f * side) * cross(up<3>(), kLevel));
      def.limit_enabled = true;
      def.lower = -0.8f;
      def.upper = 0.3f;
      const JointId id = scene.create(def);
      step(scene.world, 400);
      const float held = side > 0.0f ? def.upper : def.lower;
      EXPECT_NEAR(scene.world.joint_angle(id).value(), held, 0.002f) << method.name;
      EXPECT_LT(length(view(scene.world, def.body_b).spin), 0.01f) << method.name;
    }
}

TEST(Joints3D, AHingesSpringAndPositionMotorHoldTheirTarget) {
  for (const Method& method : methods())
    for (const bool motor : {false, true}) {
      Scene<3> scene(method.tuning, false);
      JointDef<3> def = hinged(scene, {{0.0f, -0.7f, 0.0f}});
      def.hertz = 2.0f;
      def.damping_ratio = 1.0f;
      def.target = 2.5f;
      if (motor) def.motor = MotorKind::kPosition, def.motor_max = 500.0f;
      const JointId id = scene.create(def);
      step(scene.world, 180);
      EXPECT_NEAR(scene.world.joint_angle(id).value(), 2.5f, 0.003f) << method.name;
      if (!motor) continue;
      ASSERT_TRUE(scene.world.set_target(id, -1.0f, 500.0f).ok());
      step(scene.world, 180);
      EXPECT_NEAR(scene.world.joint_angle(id).value(), -1.0f, 0.003f) << method.name;
    }
}

// Balls, whose moments do not turn with them: then every impulse and its opposite is kept exactly.
TEST(Joints3D, AFreePairOnADrivenHingeKeepsItsMomenta) {
  for (const Method& method : methods()) {
    // Where positions are corrected by themselves, no velocity answers for the moment of it.
    const bool by_position = method.tuning.position_sweeps > 0;
    Scene<3> scene(method.tuning, false);
    const BodyId a = scene.add_ball({{-0.5f, 0.1f, 0.2f}}, 2.0f);
    const BodyId b = scene.add_ball({{0.5f, -0.1f, 0.0f}}, 0.5f);
    JointDef<3> def = scene.joint(JointKind::kHinge, a, b);
    def.anchor_a = {{0.5f, -0.1f, -0.1f}};
    def.anchor_b = {{-0.5f, 0.1f, 0.1f}};
    def.axis = kLevel;
    def.motor = MotorKind::kSpeed;
    def.motor_speed = 3.0f;
    def.motor_max = 0.5f;
    const JointId id = scene.create(def);
    ASSERT_TRUE(scene.world.set_velocity(a, {{0.3f, -0.2f, 0.1f}}, {{0.5f, 0.2f, -0.3f}}).ok());
    const std::array<double, 6> before = momenta_in_space(scene.world);
    step(scene.world, 600);
    const std::array<double, 6> after = momenta_in_space(scene.world);
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(after[i], before[i],
                  i < 3         ? 1.0e-4
                  : by_position ? 0.1
                                : 1.0e-4)
          << method.name << " " << i;
    const Vec<3> axis = rotate(view(scene.world, a).rotation, kLevel);
    EXPECT_NEAR(dot(view(scene.world, b).spin - view(scene.world, a).spin, axis), 3.0f, 0.02f)
        << method.name;
    EXPECT_LT(scene.error(id), 5.0e-3f) << method.name;
  }
}

TEST(Joints3D, ASliderStopsAtItsLimitsAndItsMotorsHoldIt) {
  for (const Method& method : methods()) {
    Scene<3> scene(method.tuning);
    const Vec<3> axis = {{0.48f, 0.6f, 0.64f}};
    const BodyId bar = add_dumbbell(scene.world, Vec<3>::zero(), {{0.0f, 0.3f, 0.1f}}, 2.0f);
    JointDef<3> def = scene.joint(JointKind::kPrismatic, scene.anchor, bar);
    def.axis = axis;
    def.limit_enabled = true;
    def.lower = -0.4f;
    def.upper = 0.5f;
    const JointId id = scene.create(def);
    step(scene.world, 120);
    EXPECT_NEAR(scene.rows(id).axis.error, -0.4f, 0.002f) << method.name;
    ASSERT_TRUE(scene.world.set_motor(id, true, 0.5f, 40.0f).ok());
    step(scene.world, 60);
    EXPECT_NEAR(scene.rows(id).axis.error, 0.1f, 0.01f) << method.name;
    EXPECT_NEAR(dot(view(scene.world, bar).velocity, axis), 0.5f, 0.002f) << method.name;
    step(scene.world, 120);
    EXPECT_NEAR(scene.rows(id).axis.error, 0.5f, 0.002f) << method.name;
    ASSERT_TRUE(scene.world.set_target(id, 0.2f, 400.0f).ok());
    step(scene.world, 120);
    EXPECT_NEAR(scene.rows(id).axis.error, 0.2f, 0.002f) << method.name;
    EXPECT_LT(scene.error(id), 0.002f) << method.name;
    EXPECT_LT(length(view(scene.world, bar).spin), 1.0e-3f) << method.name;
  }
}

/// A wheel below the origin, its suspension upright and its axle along x.
static JointDef<3> wheel(Scene<3>& scene, BodyId a, float mass) {
  const BodyId b = scene.add_ball({{0.0f, -1.0f, 0.0f}}, mass);
  JointDef<3> def = scene.joint(JointKind::kWheel, a, b);
  def.anchor_a = {{0.0f, -1.0f, 0.0f}};
  def.axis = up<3>();
  def.axle = {{1.0f, 0.0f, 0.0f}};
  return def;
}

// k = m omega^2, so the sag m g / k is g / omega^2 at any mass.
TEST(Joints3D, AWheelsSuspensionSagsByItsWeightOverItsStiffness) {
  for (const Method& method : methods())
    for (const float mass : {1.0f, 200.0f}) {
      Scene<3> scene(method.tuning);
      JointDef<3> def = wheel(scene, scene.anchor, mass);
      def.hertz = 2.0f;
      def.damping_ratio = 0.8f;
      const JointId id = scene.create(def);
      step(scene.world, 300);
      const float sag = 10.0f / ((kPi2 * 2.0f) * (kPi2 * 2.0f));
      EXPECT_NEAR(-1.0f - view(scene.world, def.body_b).position[1], sag, 0.01f * sag)
          << method.name;
      ASSERT_TRUE(scene.world.set_limits(id, true, -0.02f, 0.1f).ok());
      step(scene.world, 120);
      EXPECT_NEAR(view(scene.world, def.body_b).position[1], -1.02f, 0.001f) << method.name;
    }
}

TEST(Joints3D, SteeringTurnsAWheelsAxleByItsAngleWhileItsMotorSpinsIt) {
  for (const Method& method : methods()) {
    Scene<3> scene(method.tuning, false);
    JointDef<3> def = wheel(scene, scene.anchor, 2.0f);
    def.motor = MotorKind::kSpeed;
    def.motor_speed = 8.0f;
    def.motor_max = 0.2f;
    def.hertz = 4.0f;
    def.damping_ratio = 1.0f;
    const JointId id = scene.create(def);
    step(scene.world, 60);  // I = 0.05, so alpha = 4.
    EXPECT_NEAR(view(scene.world, def.body_b).spin[0], 4.0f, 0.02f) << method.name;
    for (const float angle : {0.5f, -0.7f, 1.6f, 0.0f}) {
      ASSERT_TRUE(scene.world.set_steering(id, angle).ok());
      step(scene.world, 90);
      const Vec<3> axle = carried(scene.world, scene.state_of(id), def.axle);
      // About +y, x turns towards -z.
      EXPECT_NEAR(std::atan2(-axle[2], axle[0]), angle, 0.002f) << method.name;
      EXPECT_NEAR(axle[1], 0.0f, 0.002f) << method.name;
      EXPECT_NEAR(view(scene.world, def.body_b).position[1], -1.0f, 1.0e-3f) << method.name;
    }
    EXPECT_NEAR(view(scene.world, def.body_b).spin[0], 8.0f, 0.05f) << method.name;
  }
}

}  // namespace cycloid::solver
