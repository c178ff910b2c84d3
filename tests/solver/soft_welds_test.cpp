#include <algorithm>

#include "tests/solver/joint_scene.hpp"

namespace cycloid::solver {

/// Welds and ball joints of which one half is a spring and the other rigid: the spring has its
/// frequency on the mass that both halves leave it, wherever the anchor is.

/// How the arm and the inertia of a ball stand to one another: m r^2 is 2, 32 and 200 times I.
constexpr float kArms[] = {0.25f, 1.0f, 2.5f};

constexpr float kSpringOmega = kPi2 * 3.0f;  ///< Of the springs here, rad/s.

/// A ball beside the static body, on an arm of that length.
template <int D>
static JointDef<D> arm_joint(Scene<D>& scene, JointKind kind, float arm, float mass) {
  const BodyId ball = scene.add_ball(at<D>(arm, 0.0f), mass);
  JointDef<D> def = scene.joint(kind, scene.anchor, ball);
  def.anchor_b = at<D>(-arm, 0.0f);
  return def;
}

template <int D>
static void check_sag_of_the_point(const Method& method, float arm, float mass) {
  Scene<D> scene(method.tuning);
  JointDef<D> def = arm_joint(scene, JointKind::kWeld, arm, mass);
  def.hertz = 3.0f;
  def.damping_ratio = 1.0f;
  scene.create(def);
  step(scene.world, 180);
  const float sag = 10.0f / (kSpringOmega * kSpringOmega);
  const BodyView<D> ball = view(scene.world, def.body_b);
  EXPECT_NEAR(-ball.position[1], sag, 0.02f * sag) << method.name << " arm " << arm << " in " << D;
  EXPECT_NEAR(ball.position[0], arm, 0.002f) << method.name << " arm " << arm << " in " << D;
  EXPECT_LT(length(ball.velocity), 0.001f) << method.name << " arm " << arm << " in " << D;
}

// The rotation is rigid, so the ball hangs on the spring as a mass does: by g / omega^2.
TEST(SoftWeld, OfThePointSagsByGravityOverFrequencySquaredAtAnyArm) {
  for (const Method& method : methods())
    for (const float arm : kArms)
      for (const float mass : {1.0f, 200.0f}) {
        check_sag_of_the_point<2>(method, arm, mass);
        check_sag_of_the_point<3>(method, arm, mass);
      }
}

template <int D>
static void check_sag_of_the_rotation(JointKind kind, const Method& method, float arm) {
  Scene<D> scene(method.tuning);
  JointDef<D> def = arm_joint(scene, kind, arm, 2.0f);
  def.axis = at<D>(1.0f, 0.0f);
  def.angular_hertz = 3.0f;
  def.angular_damping_ratio = 1.0f;
  scene.create(def);
  step(scene.world, 180);
  const float inertia = ball_inertia<D>(2.0f, 0.25f) + 2.0f * arm * arm;
  // XPBD holds the point only once the spring has acted, which so knows its load a substep late.
  const bool is_late = method.tuning.stabilisation == Stabilisation::kXpbd;
  const float turn = kSpringOmega * kTick / static_cast<float>(method.tuning.substeps);
  const float late = is_late ? turn * (2.0f + turn) : 0.0f;
  const float angle = (1.0f + late) * 2.0f * 10.0f * arm / (inertia * kSpringOmega * kSpringOmega);
  const BodyView<D> ball = view(scene.world, def.body_b);
  const float drop = arm * std::sin(angle);
  EXPECT_NEAR(-ball.position[1], drop, 0.02f * drop)
      << method.name << " arm " << arm << " kind " << static_cast<int>(kind) << " in " << D;
  EXPECT_LT(length(ball.velocity), 0.001f) << method.name << " arm " << arm << " in " << D;
}

// The point is rigid, so the ball turns about it: by its torque m g r over (I + m r^2) omega^2.
TEST(SoftWeld, OfTheRotationGivesWayByTorqueOverInertiaAboutTheAnchor) {
  for (const Method& method : methods())
    for (const float arm : kArms) {
      check_sag_of_the_rotation<2>(JointKind::kWeld, method, arm);
      check_sag_of_the_rotation<3>(JointKind::kWeld, method, arm);
      check_sag_of_the_rotation<3>(JointKind::kConeTwist, method, arm);
    }
}

/// Seconds between two passages of rest in one direction, and the share of a peak that the next one
/// on the same side has.
struct ArmSwing {
  double period_s = 0.0;
  double decay = 0.0;
};

/// @param ball  Has been pushed away from rest along axis 1. @pre it swings five times at least.
template <int D>
static ArmSwing follow_swing(World<D>& world, BodyId ball) {
  std::vector<double> crossings;
  std::vector<double> peaks;
  double before = 0.0;
  double peak = 0.0;
  for (int tick = 1; tick <= 200; ++tick) {
    step(world, 1);
    const double y = view(world, ball).position[1];
    if (tick > 1 && (y < 0.0) != (before < 0.0)) {
      crossings.push_back((tick - 1 + before / (before - y)) * static_cast<double>(kTick));
      peaks.push_back(peak);
      peak = 0.0;
    }
    peak = std::max(peak, std::abs(y));
    before = y;
  }
  EXPECT_GE(crossings.size(), 8u);
  if (crossings.size() < 8) return {};
  return {(crossings[6] - crossings[0]) / 3.0, std::sqrt(peaks[5] / peaks[1])};
}

/// Implicit Euler adds at most omega h / 2 to the ratio of damping, so h is small here.
template <int D>
static void check_swing(const Method& method, bool of_rotation, float arm) {
  Scene<D> scene(method.tuning.in_substeps(64), false);
  JointDef<D> def = arm_joint(scene, JointKind::kWeld, arm, 2.0f);
  (of_rotation ? def.angular_hertz : def.hertz) = 2.0f;
  (of_rotation ? def.angular_damping_ratio : def.damping_ratio) = 0.1f;
  scene.create(def);
  ASSERT_TRUE(scene.world.apply_impulse(def.body_b, at<D>(0.0f, 0.5f)).ok());
  const ArmSwing swing = follow_swing(scene.world, def.body_b);
  const double root = std::sqrt(1.0 - 0.1 * 0.1);
  EXPECT_NEAR(swing.period_s, 0.5 / root, 0.02 * 0.5) << method.name << " arm " << arm;
  const double decay = std::exp(-static_cast<double>(kPi2) * 0.1 / root);
  EXPECT_NEAR(swing.decay, decay, 0.03 * decay) << method.name << " arm " << arm;
}

TEST(SoftWeld, SwingsAtItsFrequencyAndDecrementAtAnyArm) {
  for (const Method& method : methods())
    for (const float arm : kArms)
      for (const bool of_rotation : {false, true}) {
        check_swing<2>(method, of_rotation, arm);
        check_swing<3>(method, of_rotation, arm);
      }
}

// A stiff spring at the end of a long arm, of which the rigid half yields in soft sweeps.
TEST(SoftWeld, ThatIsStiffComesToRestAtAnyArm) {
  for (const Method& method : methods())
    for (const float arm : kArms)
      for (const float hertz : {15.0f, 60.0f, 1000.0f})
        for (const bool of_rotation : {false, true}) {
          Scene<3> scene(method.tuning);
          JointDef<3> def = arm_joint(scene, JointKind::kWeld, arm, 2.0f);
          (of_rotation ? def.angular_hertz : def.hertz) = hertz;
          (of_rotation ? def.angular_damping_ratio : def.damping_ratio) = 1.0f;
          scene.create(def);
          ASSERT_TRUE(scene.world.apply_impulse(def.body_b, {{0.0f, 2.0f, 2.0f}}).ok());
          step(scene.world, 180);
          const BodyView<3> ball = view(scene.world, def.body_b);
          EXPECT_LT(length(ball.velocity), 0.01f) << method.name << " arm " << arm << " " << hertz;
          EXPECT_NEAR(ball.position[1], 0.0f, 0.005f) << method.name << " arm " << arm;
        }
}

}  // namespace cycloid::solver
