#include <algorithm>
#include <cmath>

#include "tests/solver/joint_scene.hpp"

namespace cycloid::solver {

/// Drives and limits of bodies that are small beside the arm at which a joint holds them: what a
/// drive asks of the joint turns them far more than it does itself.

static std::vector<Method> methods_at_arms() {
  std::vector<Method> all = methods();
  all.push_back({"soft_loaded", Tuning::soft_loaded()});
  all.back().tuning.sleep_s = 0.0f;
  return all;
}

/// A ball of 1 kg and `radius` [m] whose anchor is 1 m to its left, where it turns about z.
template <int D>
static JointDef<D> swinging(float radius, Scene<D>& scene) {
  Vec<D> place = Vec<D>::zero();
  place[0] = 1.0f;
  const bool in_plane = Dim<D>::kSpin == 1;
  JointDef<D> def = scene.joint(in_plane ? JointKind::kRevolute : JointKind::kHinge, scene.anchor,
                                scene.add_ball(place, 1.0f, radius));
  def.anchor_b = -place;
  def.axis = Vec<D>::zero();
  if (!in_plane) def.axis[D - 1] = 1.0f;
  return def;
}

/// Over two seconds after three, how far the spin of b is from `spin` at most, rad/s, and the joint
/// from holding, m.
struct Worst {
  float spin;
  float gap;
};
template <int D>
static Worst play(float spin, JointId id, Scene<D>& scene) {
  const BodyId body = {scene.state_of(id).body_b, 0};
  step(scene.world, 180);
  Worst worst{};
  for (int tick = 0; tick < 120; ++tick) {
    step(scene.world, 1);
    const float now = view(scene.world, body).spin[Dim<D>::kSpin - 1];
    worst.spin = std::max(worst.spin, std::abs(now - spin));
    worst.gap = std::max(worst.gap, scene.world.joint_separation(id).value());
  }
  return worst;
}

template <int D>
static void check_motors() {
  for (const Method& method : methods_at_arms())
    for (const float radius : {0.1f, 0.3f})
      for (const float torque : {20.0f, 1000.0f}) {
        SCOPED_TRACE(testing::Message() << method.name << ", " << radius << " m, " << torque);
        Scene<D> scene(method.tuning, false);
        JointDef<D> def = swinging(radius, scene);
        def.motor = MotorKind::kSpeed;
        def.motor_speed = 1.0f;
        def.motor_max = torque;
        const Worst worst = play(1.0f, scene.create(def), scene);
        EXPECT_LT(worst.spin, 0.01f);
        EXPECT_LT(worst.gap, 0.001f);
      }
}

TEST(LongArms, AMotorHoldsItsSpeedAndThePinItsPoint) {
  check_motors<2>();
  check_motors<3>();
}

template <int D>
static void check_limits() {
  for (const Method& method : methods_at_arms())
    for (const float radius : {0.1f, 0.25f}) {
      SCOPED_TRACE(testing::Message() << method.name << ", " << radius << " m");
      Scene<D> scene(method.tuning);
      JointDef<D> def = swinging(radius, scene);
      def.limit_enabled = true;
      def.lower = 0.3f;
      def.upper = 0.3f;
      const JointId id = scene.create(def);
      const Worst worst = play(0.0f, id, scene);
      EXPECT_LT(worst.spin, 0.01f);
      EXPECT_LT(worst.gap, 0.02f);
      EXPECT_NEAR(scene.world.joint_angle(id).value(), 0.3f, 0.02f);
    }
}

TEST(LongArms, LimitsThatMeetHoldAnArmStill) {
  check_limits<2>();
  check_limits<3>();
}

/// A door that opens half a turn, and is pushed on: its angle leaps from pi to -pi there.
template <int D>
static void check_half_turns(float upper) {
  for (const Method& method : methods_at_arms()) {
    SCOPED_TRACE(testing::Message() << method.name << ", to " << upper);
    Scene<D> scene(method.tuning, false);
    JointDef<D> def = swinging(0.5f, scene);
    def.limit_enabled = true;
    def.upper = upper;
    const JointId id = scene.create(def);
    const BodyId body = {scene.state_of(id).body_b, 0};
    twist(scene.world, body, 3.0f, 300);
    const float off = std::remainder(scene.world.joint_angle(id).value() - upper, kPi2);
    EXPECT_NEAR(off, 0.0f, 0.03f);
    twist(scene.world, body, 0.0f, 120);
    EXPECT_NEAR(view(scene.world, body).spin[Dim<D>::kSpin - 1], 0.0f, 0.05f);
  }
}

TEST(AngleLimits, HoldAtHalfATurnAndBeyond) {
  for (const float upper : {3.0f, 3.14159265f, 3.2f}) {
    check_half_turns<2>(upper);
    check_half_turns<3>(upper);
  }
}

}  // namespace cycloid::solver
