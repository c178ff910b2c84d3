#include "tests/solver/joint_scene_3d.hpp"

namespace cycloid::solver {

/// Cone-twist joints: swing and twist held, friction and springs, under several methods.

constexpr Vec<3> kAlong = {{0.6f, 0.8f, 0.0f}};

/// A dumbbell of 2 kg along `kAlong`, held to the anchor at the origin `reach` from its centre.
static JointDef<3> shoulder(Scene<3>& scene, float reach) {
  const Vec<3> centre = reach * kAlong;
  const BodyId arm = add_dumbbell(scene.world, centre, 0.3f * kAlong, 2.0f);
  JointDef<3> def = scene.joint(JointKind::kConeTwist, scene.anchor, arm);
  def.anchor_b = -centre;
  def.axis = kAlong;
  return def;
}

static float swing_of(const Scene<3>& scene, JointId id) {
  return angle_between(kAlong, carried(scene.world, scene.state_of(id), kAlong));
}

TEST(Joints3D, GravitySwingsABodyToItsConeAndItRestsThereInEveryDirection) {
  for (const Method& method : methods())
    for (int i = 0; i < 8; ++i) {
      Scene<3> scene(method.tuning);
      Vec<3> across[2];
      tangents(kAlong, across);
      const float azimuth = kPi2 * static_cast<float>(i) / 8.0f;
      const Vec<3> down = std::cos(azimuth) * across[0] + std::sin(azimuth) * across[1];
      ASSERT_TRUE(scene.world.set_gravity(10.0f * down).ok());
      JointDef<3> def = shoulder(scene, 0.7f);
      def.limit_enabled = true;
      def.cone = 0.2f + 0.15f * static_cast<float>(i);
      def.lower = -0.3f;
      def.upper = 0.3f;
      const JointId id = scene.create(def);
      step(scene.world, 300);
      EXPECT_NEAR(swing_of(scene, id), def.cone, 0.01f) << method.name << " " << i;
      // Nothing holds the twist between its limits; XPBD's rounding turns it slowly.
      const bool rounds = std::string_view(method.name) == "xpbd";
      EXPECT_NEAR(twist_of(scene.world, scene.state_of(id)), 0.0f, rounds ? 0.303f : 0.01f)
          << method.name;
      EXPECT_LT(length(view(scene.world, def.body_b).spin), rounds ? 0.2f : 0.02f)
          << method.name << " " << i;
      const Vec<3> axis = carried(scene.world, scene.state_of(id), kAlong);
      EXPECT_NEAR(dot(axis, down), std::sin(def.cone), 0.01f) << method.name << " " << i;
      EXPECT_LT(scene.world.joint_separation(id).value(), 0.002f) << method.name;
    }
}

TEST(Joints3D, TwistStopsAtItsLimitsUnderATorqueBothWays) {
  for (const Method& method : methods()) {
    Scene<3> scene(method.tuning, false);
    JointDef<3> def = shoulder(scene, 0.4f);
    def.limit_enabled = true;
    def.cone = 0.5f;
    def.lower = -0.7f;
    def.upper = 0.4f;
    const JointId id = scene.create(def);
    turn(scene.world, def.body_b, 2.0f * kAlong, 120);
    EXPECT_NEAR(twist_of(scene.world, scene.state_of(id)), 0.4f, 0.003f) << method.name;
    turn(scene.world, def.body_b, -2.0f * kAlong, 120);
    EXPECT_NEAR(twist_of(scene.world, scene.state_of(id)), -0.7f, 0.003f) << method.name;
    EXPECT_LT(swing_of(scene, id), 0.01f) << method.name;
  }
}

// Swung to the edge of the cone, where the axes of swing and twist are no longer at right angles.
TEST(Joints3D, SwingAndTwistAreHeldTogether) {
  for (const Method& method : methods()) {
    Scene<3> scene(method.tuning);
    JointDef<3> def = shoulder(scene, 0.7f);
    def.limit_enabled = true;
    def.cone = 1.2f;
    def.lower = -0.5f;
    def.upper = 0.5f;
    const JointId id = scene.create(def);
    for (int i = 0; i < 400; ++i) {
      const Vec<3> axis = carried(scene.world, scene.state_of(id), kAlong);
      turn(scene.world, def.body_b, -1.0f * axis, 1);
    }
    EXPECT_NEAR(swing_of(scene, id), 1.2f, 0.01f) << method.name;
    EXPECT_NEAR(twist_of(scene.world, scene.state_of(id)), -0.5f, 0.01f) << method.name;
  }
}

TEST(Joints3D, FrictionHoldsBelowItsTorqueAndYieldsTheRestAbove) {
  for (const Method& method : methods())
    for (const bool limits : {false, true}) {
      Scene<3> scene(method.tuning, false);
      JointDef<3> def = shoulder(scene, 0.0f);
      def.torque_max = 1.0f;
      def.limit_enabled = limits;
      def.cone = 3.0f;
      def.lower = -3.0f;
      def.upper = 3.0f;
      const JointId id = scene.create(def);
      // Bounded by length: 0.7 on each of two axes is below 1, 0.8 on each is not.
      const Vec<3> about = normalized_or(cross(kAlong, {{0.0f, 0.0f, 1.0f}}), kAlong);
      const Vec<3> other = cross(kAlong, about);
      turn(scene.world, def.body_b, 0.7f * (about + other), 60);
      EXPECT_LT(length(view(scene.world, def.body_b).spin), 1.0e-4f) << method.name;
      EXPECT_LT(swing_of(scene, id), 1.0e-4f) << method.name;
      const float torque = 1.8f;
      turn(scene.world, def.body_b, torque * about, 15);
      const float inertia = moment_about(scene.world, def.body_b, about);
      EXPECT_NEAR(dot(view(scene.world, def.body_b).spin, about), 0.25f * 0.8f / inertia,
                  0.02f * 0.25f * 0.8f / inertia)
          << method.name;
      step(scene.world, 30);  // Left alone it stops, and stays.
      EXPECT_LT(length(view(scene.world, def.body_b).spin), 1.0e-4f) << method.name;
      turn(scene.world, def.body_b, 0.8f * (about + other), 15);
      EXPECT_GT(length(view(scene.world, def.body_b).spin), 0.05f) << method.name;
    }
}

TEST(Joints3D, AnAngularSpringReturnsToThePoseOfCreationWithinItsTorqueAndItsLimits) {
  for (const Method& method : methods()) {
    Scene<3> scene(method.tuning, false);
    JointDef<3> def = shoulder(scene, 0.4f);
    def.angular_hertz = 2.0f;
    def.angular_damping_ratio = 1.0f;
    const JointId id = scene.create(def);
    turn(scene.world, def.body_b, {{1.0f, -2.0f, 3.0f}}, 10);
    EXPECT_GT(swing_of(scene, id), 0.02f) << method.name;
    step(scene.world, 180);
    EXPECT_LT(swing_of(scene, id), 0.002f) << method.name;
    EXPECT_NEAR(twist_of(scene.world, scene.state_of(id)), 0.0f, 0.002f) << method.name;
    // A limit that leaves the pose of creation out is the stronger.
    ASSERT_TRUE(scene.world.set_limits(id, true, 0.2f, 0.5f).ok());
    step(scene.world, 240);
    EXPECT_NEAR(twist_of(scene.world, scene.state_of(id)), 0.2f, 0.003f) << method.name;
  }
  // With a bound, what is heavier than it falls.
  Scene<3> scene(Tuning::soft_step());
  JointDef<3> def = shoulder(scene, 0.7f);
  def.angular_hertz = 10.0f;
  def.angular_damping_ratio = 1.0f;
  def.torque_max = 1.0f;
  const JointId id = scene.create(def);
  step(scene.world, 20);
  EXPECT_GT(swing_of(scene, id), 0.2f);
}

static float spin_energy_of(const World<3>& world, BodyId id) {
  const Body<3>& body = world.state().bodies[id.index];
  return 0.5f * dot(body.spin, world_inertia(body.inertia, body.rotation) * body.spin);
}

// A cone of pi is none: the body turns through the opposite way as if nothing were there.
TEST(Joints3D, WithoutAConeABodySwingsThroughTheOppositeWayUnhindered) {
  for (const Method& method : methods()) {
    Scene<3> scene(method.tuning, false);
    JointDef<3> def = shoulder(scene, 0.0f);
    def.limit_enabled = true;
    def.cone = 3.14159265f;
    def.lower = -0.5f;
    def.upper = 0.5f;
    const JointId id = scene.create(def);
    const Vec<3> spin = {{0.0f, 0.0f, 4.0f}};
    ASSERT_TRUE(scene.world.set_velocity(def.body_b, Vec<3>::zero(), spin).ok());
    float widest = 0.0f;
    for (int tick = 0; tick < 300; ++tick) {
      step(scene.world, 1);
      widest = std::max(widest, swing_of(scene, id));
      ASSERT_LT(length(view(scene.world, def.body_b).spin - spin), 0.04f) << method.name << tick;
    }
    EXPECT_GT(widest, 3.1f);
    // Past it at a small distance, the twist leaps to its limit; that may cost spin, not give it.
    ASSERT_TRUE(scene.world.set_velocity(def.body_b, Vec<3>::zero(), spin + 0.1f * kAlong).ok());
    if (std::string_view(method.name) == "xpbd") continue;  // It turns what it corrects into speed.
    const float most = 1.05f * spin_energy_of(scene.world, def.body_b);
    for (int tick = 0; tick < 600; ++tick) {
      step(scene.world, 1);
      ASSERT_LT(spin_energy_of(scene.world, def.body_b), most) << method.name << tick;
    }
  }
}

}  // namespace cycloid::solver
