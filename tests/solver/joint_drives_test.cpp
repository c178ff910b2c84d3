#include "tests/solver/joint_scene.hpp"

namespace cycloid::solver {

/// Motors, position motors and driven targets, and drives that contradict one another.

template <int D>
static JointDef<D> slider(Scene<D>& scene, BodyId body) {
  JointDef<D> def = scene.joint(JointKind::kPrismatic, scene.anchor, body);
  def.axis = up<D>();
  return def;
}

// The speed rises by max / m until it is reached, and does not pass it.
template <int D>
static void check_speed_motor(JointKind kind) {
  for (const Method& method : methods()) {
    Scene<D> scene(method.tuning, false);
    const Vec<D> start = kind == JointKind::kDistance ? at<D>(0.0f, 1.0f) : Vec<D>::zero();
    const BodyId body = scene.add_ball(start, 2.0f);
    JointDef<D> def = slider(scene, body);
    def.kind = kind;
    def.motor = MotorKind::kSpeed;
    def.motor_speed = 1.5f;
    def.motor_max = 4.0f;
    const JointId id = scene.create(def);
    step(scene.world, 30);
    EXPECT_NEAR(view(scene.world, body).velocity[1], 1.0f, 0.01f) << method.name;
    step(scene.world, 30);
    EXPECT_NEAR(view(scene.world, body).velocity[1], 1.5f, 1.0e-3f) << method.name;
    EXPECT_NEAR(scene.state_of(id).motor_impulse, 0.0f, 1.0e-3f) << method.name;
    const float v0 = view(scene.world, body).velocity[1];
    push(scene.world, body, -6.0f * up<D>(), 30);  // 2 N more than the motor has.
    EXPECT_NEAR(view(scene.world, body).velocity[1] - v0, -0.5f, 0.01f) << method.name;
  }
}

TEST(SpeedMotor, RisesByItsForceReachesItsSpeedAndYieldsBeyondItsForce) {
  check_speed_motor<2>(JointKind::kPrismatic);
  check_speed_motor<3>(JointKind::kPrismatic);
  check_speed_motor<2>(JointKind::kDistance);
  check_speed_motor<3>(JointKind::kDistance);
}

TEST(SpeedMotor, OfAWheelTurnsItAndLeavesItsSuspensionAlone) {
  for (const Method& method : methods()) {
    Scene<2> scene(method.tuning, false);
    const BodyId wheel = scene.add_ball({{0.0f, 0.0f}}, 2.0f);
    JointDef<2> def = slider(scene, wheel);
    def.kind = JointKind::kWheel;
    def.motor = MotorKind::kSpeed;
    def.motor_speed = -8.0f;
    def.motor_max = 0.25f;
    scene.create(def);
    step(scene.world, 60);  // I = 1/16, so alpha = 4.
    EXPECT_NEAR(view(scene.world, wheel).spin[0], -4.0f, 0.01f) << method.name;
    step(scene.world, 90);
    EXPECT_NEAR(view(scene.world, wheel).spin[0], -8.0f, 0.01f) << method.name;
    EXPECT_EQ(view(scene.world, wheel).velocity[1], 0.0f) << method.name;
  }
}

// A position motor without a frequency of its own is a spring at the joints' stiffness, 15 Hz at a
// substep of 1/60 s and 60 Hz at 1/240 s: it sags by g / omega^2, 1.1 mm at most.
template <int D>
static void check_position_motor() {
  for (const Method& method : methods()) {
    Scene<D> scene(method.tuning);
    const BodyId body = scene.add_ball(at<D>(0.0f, 0.0f), 2.0f);
    JointDef<D> def = slider(scene, body);
    def.motor = MotorKind::kPosition;
    def.target = 0.5f;
    def.motor_max = 200.0f;
    const JointId id = scene.create(def);
    step(scene.world, 180);
    EXPECT_NEAR(view(scene.world, body).position[1], 0.5f, 0.0015f) << method.name;
    EXPECT_NEAR(view(scene.world, body).velocity[1], 0.0f, 1.0e-3f) << method.name;

    ASSERT_TRUE(scene.world.set_target(id, 0.5f, 15.0f).ok());  // 5 N less than the weight.
    step(scene.world, 60);
    EXPECT_NEAR(view(scene.world, body).velocity[1], -2.5f, 0.05f) << method.name;
  }
}

TEST(PositionMotor, HoldsAgainstGravityWithinItsForce) {
  check_position_motor<2>();
  check_position_motor<3>();
}

template <int D>
static void check_motor_of_a_distance() {
  for (const Method& method : methods()) {
    Scene<D> scene(method.tuning, false);
    const BodyId body = scene.add_ball(at<D>(0.0f, 1.0f), 2.0f);
    JointDef<D> def = scene.joint(JointKind::kDistance, scene.anchor, body);
    def.length = 1.0f;
    def.motor = MotorKind::kPosition;
    def.target = 2.0f;
    def.motor_max = 1000.0f;
    const JointId id = scene.create(def);
    step(scene.world, 180);
    EXPECT_NEAR(scene.world.joint_separation(id).value(), 2.0f, 0.001f) << method.name;
    ASSERT_TRUE(scene.world.set_target(id, 0.5f, 1000.0f).ok());
    step(scene.world, 180);
    EXPECT_NEAR(scene.world.joint_separation(id).value(), 0.5f, 0.001f) << method.name;
  }
}

TEST(PositionMotor, OfADistanceHoldsItsTargetAndNotTheLengthOfItsSpring) {
  check_motor_of_a_distance<2>();
  check_motor_of_a_distance<3>();
}

TEST(PositionMotor, HoldsAnAngleAgainstAnUnbalancedWeight) {
  for (const Method& method : methods()) {
    Scene<2> scene(method.tuning);
    const BodyId body = scene.add_ball({{0.1f, 0.0f}}, 2.0f);
    JointDef<2> def = scene.joint(JointKind::kRevolute, scene.anchor, body);
    def.anchor_b = {{-0.1f, 0.0f}};
    def.motor = MotorKind::kPosition;
    def.target = 0.8f;
    def.motor_max = 50.0f;
    const JointId id = scene.create(def);
    step(scene.world, 300);
    // Sag: torque / (I omega^2) with the row's own I = 1/16 and omega = 94 at least: 2.5 mrad.
    EXPECT_NEAR(scene.world.joint_angle(id).value(), 0.8f, 0.004f) << method.name;
  }
}

/// The largest lag behind target + A sin(2 pi f t) after two seconds of a world of that tick.
static double drive_error(const Method& method, float tick_s, std::uint64_t begin = 0) {
  WorldDef<2> world_def;
  world_def.tick_s = tick_s;
  world_def.tuning = method.tuning;
  World<2> world = make_world(world_def);
  BodyDef<2> fixed;
  fixed.kind = BodyKind::kStatic;
  JointDef<2> def;
  def.kind = JointKind::kPrismatic;
  def.body_a = world.create_body(fixed, {}).value();
  def.body_b = add_at<2>(world, {{0.0f, 0.0f}}, ball<2>(0.3f));
  def.axis = {{1.0f, 0.0f}};
  def.motor = MotorKind::kPosition;
  def.motor_max = 1.0e4f;
  def.target = 0.2f;
  def.drive_amplitude = 0.5f;
  def.drive_hertz = 1.0f;
  EXPECT_TRUE(world.create_joint(def).ok());
  WorldState<2> state;
  world.save(state);
  state.header.tick = begin;
  world.restore(state);
  double worst = 0.0;
  const int ticks_per_s = static_cast<int>(std::lround(1.0f / tick_s));
  for (int tick = 1; tick <= 4 * ticks_per_s; ++tick) {
    step(world, 1);
    if (tick < 2 * ticks_per_s) continue;
    const double t = double{tick_s} * static_cast<double>(world.tick());
    const double wanted = 0.2 + 0.5 * std::sin(6.283185307179586 * t);
    worst = std::max(worst, std::abs(view(world, def.body_b).position[0] - wanted));
  }
  return worst;
}

TEST(PositionMotor, FollowsASineAsWellAfterTenDays) {
  constexpr std::uint64_t kTenDays = 60ull * 3600 * 240;
  for (const Method& method : methods()) {
    const double begin = drive_error(method, 1.0f / 60.0f);
    EXPECT_NEAR(drive_error(method, 1.0f / 60.0f, kTenDays), begin, 0.01 * begin) << method.name;
  }
}

TEST(PositionMotor, FollowsASineWithAnErrorThatHalvesWithTheStep) {
  for (const Method& method : methods()) {
    const double coarse = drive_error(method, 1.0f / 60.0f);
    const double fine = drive_error(method, 1.0f / 120.0f);
    // Ahead by one substep: A omega h.
    const double h = 1.0 / (60.0 * method.tuning.substeps);
    EXPECT_LT(coarse, 1.05 * 0.5 * 6.283185307179586 * h) << method.name;
    EXPECT_LT(fine, 0.6 * coarse) << method.name << " " << coarse << " " << fine;
  }
}

TEST(Drives, ALimitWinsOverAMotorWhoseImpulseStaysAtItsBound) {
  for (const Method& method : methods()) {
    Scene<2> scene(method.tuning, false);
    const BodyId body = scene.add_ball({{0.0f, 0.0f}}, 2.0f);
    JointDef<2> def = slider(scene, body);
    def.motor = MotorKind::kSpeed;
    def.motor_speed = 3.0f;
    def.motor_max = 8.0f;
    def.limit_enabled = true;
    def.lower = -1.0f;
    def.upper = 0.7f;
    const JointId id = scene.create(def);
    for (int i = 0; i < 300; ++i) {
      step(scene.world, 1);
      ASSERT_LT(view(scene.world, body).position[1], 0.705f) << method.name << " tick " << i;
    }
    EXPECT_NEAR(view(scene.world, body).position[1], 0.7f, 0.005f) << method.name;
    EXPECT_NEAR(view(scene.world, body).velocity[1], 0.0f, 1.0e-3f) << method.name;
    const float h = kTick / static_cast<float>(method.tuning.substeps);
    EXPECT_NEAR(scene.state_of(id).motor_impulse, 8.0f * h, 1.0e-4f * h) << method.name;
    if (method.tuning.stabilisation == Stabilisation::kXpbd) continue;  // Limits are projected.
    EXPECT_NEAR(scene.state_of(id).upper_impulse, 8.0f * h, 0.01f * 8.0f * h) << method.name;
  }
}

TEST(Drives, TwoMotorsThatFightStayBounded) {
  for (const Method& method : methods()) {
    Scene<2> scene(method.tuning);
    const BodyId body = scene.add_ball({{0.0f, 0.0f}}, 2.0f);
    for (const float speed : {10.0f, -10.0f}) {
      JointDef<2> def = scene.joint(JointKind::kRevolute, scene.anchor, body);
      def.motor = MotorKind::kSpeed;
      def.motor_speed = speed;
      def.motor_max = 100.0f;
      scene.create(def);
    }
    for (int i = 0; i < 600; ++i) {
      step(scene.world, 1);
      ASSERT_LE(std::abs(view(scene.world, body).spin[0]), 10.01f) << method.name << " " << i;
    }
    EXPECT_LT(length(view(scene.world, body).position), 0.005f) << method.name;
    const float bound = 100.0f * kTick;
    for (const Joint<2>& joint : scene.world.state().joints)
      EXPECT_LE(std::abs(joint.motor_impulse), bound) << method.name;
  }
}

TEST(Drives, GearsThatContradictOneAnotherStayBoundedAndComeToRest) {
  for (const Method& method : methods()) {
    Scene<2> scene(method.tuning, false);
    BodyId wheels[2];
    for (int i = 0; i < 2; ++i) {
      const float x = i == 0 ? -1.0f : 1.0f;
      wheels[i] = scene.add_ball({{x, 0.0f}}, 2.0f);
      JointDef<2> pin = scene.joint(JointKind::kRevolute, scene.anchor, wheels[i]);
      pin.anchor_a = {{x, 0.0f}};
      scene.create(pin);
    }
    for (const float ratio : {1.0f, 2.0f, -1.0f}) {
      JointDef<2> gear = scene.joint(JointKind::kGear, wheels[0], wheels[1]);
      gear.ratio = ratio;
      scene.create(gear);
    }
    Spin<2> kick = {{1.0f}};
    ASSERT_TRUE(scene.world.apply_angular_impulse(wheels[0], kick).ok());  // To 16 rad/s.
    for (int i = 0; i < 300; ++i) {
      step(scene.world, 1);
      for (const BodyId wheel : wheels)
        ASSERT_LT(std::abs(view(scene.world, wheel).spin[0]), 16.01f) << method.name << " " << i;
    }
    for (const BodyId wheel : wheels)
      EXPECT_NEAR(view(scene.world, wheel).spin[0], 0.0f, 0.01f) << method.name;
  }
}

TEST(Drives, PulleysThatContradictOneAnotherStayBounded) {
  for (const Method& method : methods()) {
    Scene<2> scene(method.tuning);
    const BodyId a = scene.add_ball({{-1.0f, -2.0f}}, 3.0f);
    const BodyId b = scene.add_ball({{1.0f, -2.0f}}, 2.0f);
    for (const float ratio : {1.0f, 3.0f}) {
      JointDef<2> def = scene.joint(JointKind::kPulley, a, b);
      def.ground_a = {{-1.0f, 0.0f}};
      def.ground_b = {{1.0f, 0.0f}};
      def.ratio = ratio;
      def.length = 0.0f;
      scene.create(def);
    }
    for (int i = 0; i < 600; ++i) {
      step(scene.world, 1);
      for (const BodyId id : {a, b}) {
        ASSERT_LT(length(view(scene.world, id).velocity), 5.0f) << method.name << " tick " << i;
        ASSERT_LT(length(view(scene.world, id).position), 5.0f) << method.name << " tick " << i;
      }
    }
  }
}

}  // namespace cycloid::solver
