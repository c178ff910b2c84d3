#include <cmath>
#include <limits>

#include "solver/constraints/joints/unwrap.hpp"
#include "tests/solver/joint_scene.hpp"

namespace cycloid::solver {

/// Drives of an angle, whose coordinate leaps from pi to -pi: they go the shorter way round and
/// come to rest there.

/// A ball of 1 kg that turns freely about the anchor, in space about z.
template <int D>
static JointDef<D> turning(Scene<D>& scene) {
  const BodyId body = scene.add_ball(Vec<D>::zero(), 1.0f, 0.5f);
  const bool in_plane = Dim<D>::kSpin == 1;
  JointDef<D> def =
      scene.joint(in_plane ? JointKind::kRevolute : JointKind::kHinge, scene.anchor, body);
  def.axis = Vec<D>::zero();
  if (!in_plane) def.axis[D - 1] = 1.0f;
  return def;
}

/// Plays 30 s and asks whether the angle is `angle` but for whole turns, and stays so.
template <int D>
static void expect_at(float angle, Scene<D>& scene, JointId id) {
  step(scene.world, 1800);
  const BodyId body = {scene.state_of(id).body_b, 0};
  const float off = std::remainder(scene.world.joint_angle(id).value() - angle, kPi2);
  EXPECT_NEAR(off, 0.0f, 0.01f) << "to " << angle;
  EXPECT_NEAR(view(scene.world, body).spin[Dim<D>::kSpin - 1], 0.0f, 0.01f) << "to " << angle;
}

template <int D>
static void check_position_motors() {
  for (const Method& method : methods())
    for (const float target : {1.0f, 2.0f, 3.0f, 3.14f, 4.0f, -3.5f, 100.0f})
      for (const float torque : {10.0f, 1000.0f}) {
        SCOPED_TRACE(testing::Message() << method.name << ", " << torque << " N m");
        Scene<D> scene(method.tuning, false);
        JointDef<D> def = turning(scene);
        def.motor = MotorKind::kPosition;
        def.target = target;
        def.motor_max = torque;
        expect_at(target, scene, scene.create(def));
      }
}

TEST(AngleDrives, PositionMotorsComeToRestAtTheirTarget) {
  check_position_motors<2>();
  check_position_motors<3>();
}

template <int D>
static void check_angle_springs() {
  for (const Method& method : methods())
    for (const float target : {2.0f, 3.0f, 4.0f, -9.0f}) {
      SCOPED_TRACE(method.name);
      Scene<D> scene(method.tuning, false);
      JointDef<D> def = turning(scene);
      def.hertz = 2.0f;
      def.damping_ratio = 0.2f;
      def.target = target;
      expect_at(target, scene, scene.create(def));
    }
}

TEST(AngleDrives, SpringsComeToRestAtTheirTarget) {
  check_angle_springs<2>();
  check_angle_springs<3>();
}

TEST(AngleDrives, AMotorJointComesToRestAtItsTarget) {
  for (const Method& method : methods())
    for (const float target : {2.0f, 3.0f, 4.0f, -7.0f}) {
      SCOPED_TRACE(method.name);
      Scene<2> scene(method.tuning, false);
      JointDef<2> def = turning(scene);
      def.kind = JointKind::kMotor;
      def.target = target;
      def.force_max = def.torque_max = 1000.0f;
      const JointId id = scene.create(def);
      step(scene.world, 1800);
      const BodyView<2> body = view(scene.world, def.body_b);
      const float angle = std::atan2(body.rotation[1], body.rotation[0]);
      EXPECT_NEAR(std::remainder(angle - target, kPi2), 0.0f, 0.01f) << "to " << target;
      EXPECT_NEAR(body.spin[0], 0.0f, 0.01f) << "to " << target;
      EXPECT_TRUE(scene.world.destroy_joint(id).ok());
    }
}

// The amplitude takes it round by more than a turn and back again.
TEST(AngleDrives, AMotorFollowsATargetThatGoesRound) {
  Scene<2> scene(Tuning::soft_step(), false);
  JointDef<2> def = turning(scene);
  def.motor = MotorKind::kPosition;
  def.motor_max = 1000.0f;
  def.drive_amplitude = 9.0f;
  def.drive_hertz = 0.2f;
  const JointId id = scene.create(def);
  for (int tick = 1; tick <= 600; ++tick) {
    step(scene.world, 1);
    const float wanted = 9.0f * std::sin(kPi2 * 0.2f * kTick * static_cast<float>(tick));
    const float off = std::remainder(scene.world.joint_angle(id).value() - wanted, kPi2);
    ASSERT_NEAR(off, 0.0f, 0.1f) << "tick " << tick;
  }
}

/// From `begin` to `end`, between which the shorter way leads through a limit.
static void check_longer_way(float begin, float end, float lower, float upper) {
  for (const Method& method : methods()) {
    SCOPED_TRACE(testing::Message() << method.name << " from " << begin);
    Scene<2> scene(method.tuning, false);
    JointDef<2> def = turning(scene);
    def.motor = MotorKind::kPosition;
    def.motor_max = 20.0f;
    def.target = begin;
    def.limit_enabled = true;
    def.lower = lower;
    def.upper = upper;
    const JointId id = scene.create(def);
    expect_at(begin, scene, id);
    ASSERT_TRUE(scene.world.set_target(id, end, 20.0f).ok());
    expect_at(end, scene, id);
  }
}

TEST(AngleDrives, LimitsWithinHalfATurnLeaveTheLongerWay) {
  check_longer_way(-2.9f, 2.9f, -3.0f, 3.0f);
  check_longer_way(2.9f, -2.9f, -3.0f, 3.0f);
}

// What swings past half a turn comes upon the other limit from behind, and may rest against it.
TEST(AngleDrives, ALimitBeyondHalfATurnTurnsNothingForEver) {
  for (const Method& method : methods()) {
    Scene<2> scene(method.tuning, false);
    JointDef<2> def = turning(scene);
    def.motor = MotorKind::kPosition;
    def.motor_max = 20.0f;
    def.target = 2.9f;
    def.limit_enabled = true;
    def.lower = -3.1f;
    def.upper = 3.2f;
    (void)scene.create(def);
    step(scene.world, 1800);
    EXPECT_NEAR(view(scene.world, def.body_b).spin[0], 0.0f, 0.01f) << method.name;
  }
}

TEST(AngleDrives, WhatIsWithinHalfATurnKeepsItsBits) {
  for (const float angle : {0.0f, -0.0f, 1.0f, -3.1f, 0.1f, std::numeric_limits<float>::min()}) {
    EXPECT_EQ(nearest_turn(angle, 0.04f), angle);
    EXPECT_EQ(std::signbit(nearest_turn(angle, 0.0f)), std::signbit(angle));
  }
  EXPECT_EQ(nearest_turn(2.0f, std::numeric_limits<float>::quiet_NaN()), 2.0f);
  EXPECT_NEAR(nearest_turn(4.0f, 0.0f), 4.0f - kPi2, 1.0e-6f);
  EXPECT_NEAR(nearest_turn(-3.0f, 3.0f), kPi2 - 3.0f, 1.0e-6f);
  EXPECT_NEAR(nearest_turn(1.0e6f, 0.0f), std::remainder(1.0e6, 6.283185307179586), 0.07);
}

}  // namespace cycloid::solver
