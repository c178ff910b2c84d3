#include <random>

#include "solver/trig.hpp"
#include "tests/solver/jacobian_fixture.hpp"
#include "tests/solver/joint_scene_3d.hpp"

namespace cycloid::solver {

/// Rows of hinges, wheels and cone-twists: Jacobians against central differences of the errors, and
/// swing and twist where they are nearly undefined.

/// Bodies 0 and 1 of a state, as a joint sees them.
struct JointedPair {
  WorldState<3> state;
  Joint<3> joint{};
  std::array<Vec<3>, 2> position;
  std::array<Rotation<3>, 2> rotation;

  JointedPair() {
    state.bodies.edit([](auto& bodies) { bodies.resize(2); });
  }
  JointFrame<3> frame() const {
    return make_frame(state, joint, position[0], position[1] - position[0], rotation[0],
                      rotation[1], 0.0f);
  }
  JointRows<3> rows() const {
    JointRows<3> rows;
    rows_of(frame(), rows);
    return rows;
  }
  /// Freedom 0 to 5 of a, then of b, moved by `eps`; positions before turns.
  JointedPair moved(int freedom, float eps) const {
    JointedPair pair = *this;
    const auto body = static_cast<std::size_t>(freedom / 6);
    const int i = freedom % 6;
    if (i < 3) {
      pair.position[body][i] += eps;
      return pair;
    }
    Vec<3> turn = Vec<3>::zero();
    turn[i - 3] = eps;
    pair.rotation[body] = compose(rotation_by(turn), pair.rotation[body]);
    return pair;
  }
};

static JointedPair random_pair(JointKind kind, std::mt19937& random) {
  JointedPair pair;
  pair.joint.kind = kind;
  pair.joint.body_b = 1;
  pair.joint.anchor_a = random_vec<3>(random, 0.8f);
  pair.joint.anchor_b = random_vec<3>(random, 0.8f);
  pair.joint.axis = normalized_or(random_vec<3>(random, 1.0f), up<3>());
  Vec<3> across[2];
  tangents(pair.joint.axis, across);
  pair.joint.axle = normalized_or(across[0] + 0.4f * across[1], across[0]);
  pair.joint.steering = 0.5f;
  pair.joint.reference = rotation_by(random_vec<3>(random, 1.0f));
  pair.joint.limit_enabled = 1;
  for (std::size_t i = 0; i < 2; ++i) {
    pair.position[i] = random_vec<3>(random, 2.0f);
    pair.rotation[i] = rotation_by(random_vec<3>(random, 1.5f));
  }
  return pair;
}

/// `error_of` gives the C of which `row` is to be the derivative.
template <class ErrorOf>
static void expect_derivative(const JointedPair& pair, const Row<3>& row, ErrorOf&& error_of,
                              const char* name) {
  for (int freedom = 0; freedom < 12; ++freedom) {
    const float slope =
        (error_of(pair.moved(freedom, kDifference)) - error_of(pair.moved(freedom, -kDifference))) /
        (2.0f * kDifference);
    EXPECT_NEAR(entry(row, freedom), slope, kSlopeTolerance * std::max(1.0f, std::abs(slope)))
        << name << " by freedom " << freedom << " of kind " << static_cast<int>(pair.joint.kind);
  }
}

static void expect_exact(const JointedPair& pair) {
  const JointRows<3> rows = pair.rows();
  for (std::size_t r = 0; r < static_cast<std::size_t>(rows.count); ++r)
    expect_derivative(
        pair, rows.rows[r], [&](const JointedPair& at) { return at.rows().rows[r].error; }, "row");
  if (rows.has_axis)
    expect_derivative(
        pair, rows.axis, [](const JointedPair& at) { return at.rows().axis.error; }, "axis");
  if (rows.has_cone_axis)
    expect_derivative(
        pair, rows.cone_axis, [](const JointedPair& at) { return at.rows().cone_axis.error; },
        "cone");
}

/// A pose whose twist and swing are far from where they jump.
static bool is_smooth(const JointedPair& pair) {
  const JointRows<3> rows = pair.rows();
  if (!rows.has_axis || rows.has_motor_axis) return true;
  const AxisPair axes = axis_pair(pair.frame(), pair.joint.axis);
  const float swing = angle_between(axes.of_a, axes.of_b);
  return std::abs(rows.axis.error) < 3.0f && swing > 0.2f && swing < 2.6f;
}

// At any pose, not only where the equalities hold: their directions are fixed in body a.
TEST(Joints3D, JacobianOfHingeWheelConeTwistAndSliderIsTheDerivativeOfTheErrorAnywhere) {
  std::mt19937 random(20240607);
  const std::pair<JointKind, int> kinds[] = {
      {JointKind::kHinge, 5}, {JointKind::kWheel, 4}, {JointKind::kConeTwist, 3}};
  for (const auto& [kind, count] : kinds)
    for (int trial = 0; trial < 40; ++trial) {
      const JointedPair pair = random_pair(kind, random);
      if (!is_smooth(pair)) continue;
      const JointRows<3> rows = pair.rows();
      EXPECT_EQ(rows.count, count);
      EXPECT_EQ(rows.split, count);
      EXPECT_TRUE(rows.has_axis);
      EXPECT_EQ(rows.has_cone_axis, kind == JointKind::kConeTwist);
      expect_exact(pair);
    }
  for (int trial = 0; trial < 12; ++trial) {
    const JointedPair pair = random_pair(JointKind::kPrismatic, random);
    const JointRows<3> rows = pair.rows();
    for (std::size_t r = 0; r < 2; ++r)
      expect_derivative(
          pair, rows.rows[r], [&](const JointedPair& at) { return at.rows().rows[r].error; },
          "row");
  }
}

// The angle that a wheel's motor turns: about the steered axle, from the steered rest.
TEST(Joints3D, JacobianOfAWheelsMotorIsTheDerivativeOfItsAngleWhereTheAxlesMeet) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 12; ++trial) {
    JointedPair pair = random_pair(JointKind::kWheel, random);
    const Joint<3>& joint = pair.joint;
    const Rotation<3> steered = rotation_by(joint.steering * joint.axis);
    const Rotation<3> spun = rotation_by((0.2f * static_cast<float>(trial) - 1.0f) * joint.axle);
    pair.rotation[1] = compose(pair.rotation[0], compose(compose(steered, spun), joint.reference));
    const JointRows<3> rows = pair.rows();
    EXPECT_NEAR(rows.rows[2].error, 0.0f, 1.0e-6f);
    EXPECT_NEAR(rows.rows[3].error, 0.0f, 1.0e-6f);
    ASSERT_TRUE(rows.has_motor_axis);
    const auto angle_of = [&](const JointedPair& at) {
      const Rotation<3> since =
          compose(conjugate(at.rotation[0]), compose(at.rotation[1], conjugate(joint.reference)));
      return twist_angle(compose(conjugate(steered), since), joint.axle);
    };
    EXPECT_NEAR(angle_of(pair), 0.2f * static_cast<float>(trial) - 1.0f, 1.0e-5f);
    expect_derivative(pair, rows.motor_axis, angle_of, "motor axis");
  }
}

/// b swung by `swing` about a direction across x, which is the axis, after a twist of 0.7 rad.
static JointedPair swung(float swing, float azimuth) {
  JointedPair pair;
  pair.joint.kind = JointKind::kConeTwist;
  pair.joint.body_b = 1;
  pair.joint.limit_enabled = 1;
  pair.joint.axis = {{1.0f, 0.0f, 0.0f}};
  pair.joint.reference = identity_rotation<3>();
  pair.position = {Vec<3>::zero(), Vec<3>::zero()};
  pair.rotation[0] = identity_rotation<3>();
  const Vec<3> about = {{0.0f, std::cos(azimuth), std::sin(azimuth)}};
  pair.rotation[1] = compose(rotation_by(swing * about), rotation_by({{0.7f, 0.0f, 0.0f}}));
  return pair;
}

TEST(Joints3D, SwingAndTwistAreFiniteAndKeepTheirSignsFromNoSwingToTheOppositeWay) {
  for (const float azimuth : {0.0f, 0.9f, 2.5f, 4.0f})
    for (const float swing : {0.0f, 1.0e-8f, 1.0e-4f, 0.5f, 1.5f, 2.5f, 3.1f, 3.1415925f, 3.18f}) {
      const JointRows<3> rows = swung(swing, azimuth).rows();
      const float expected = swing > kPi ? 2.0f * kPi - swing : swing;
      EXPECT_NEAR(rows.cone_axis.error, expected, 1.0e-6f) << swing;
      EXPECT_NEAR(length(rows.cone_axis.angular_b), 1.0f, 1.0e-5f) << swing;
      for (const float value : rows.axis.angular_b.v) EXPECT_TRUE(std::isfinite(value)) << swing;
      // Within 0.014 rad of the opposite way there is no twist, and no row of it.
      const bool has_twist = std::abs(swing - kPi) > 0.0142f;
      EXPECT_NEAR(rows.axis.error, has_twist ? 0.7f : 0.0f, 1.0e-4f) << swing;
      EXPECT_EQ(length(rows.axis.angular_b) > 0.0f, has_twist) << swing;
    }
}

TEST(Joints3D, AHingesAngleCoversAWholeTurnAndJumpsOnlyAtHalfOfIt) {
  const Vec<3> axis = normalized_or(Vec<3>{{0.3f, -0.5f, 0.8f}}, up<3>());
  for (int i = -31; i <= 31; ++i) {
    const float angle = 0.1f * static_cast<float>(i);
    const Rotation<3> q = rotation_by(angle * axis);
    EXPECT_NEAR(twist_angle(q, axis), angle, 2.0e-6f);
    EXPECT_NEAR(twist_angle(-q, axis), angle, 2.0e-6f);
  }
  EXPECT_FLOAT_EQ(twist_angle({{1.0f, 0.0f, 0.0f, 0.0f}}, {{1.0f, 0.0f, 0.0f}}), kPi);
  EXPECT_FLOAT_EQ(twist_angle({{-1.0f, 0.0f, 0.0f, 0.0f}}, {{1.0f, 0.0f, 0.0f}}), kPi);
}

}  // namespace cycloid::solver
