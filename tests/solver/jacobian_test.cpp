#include <functional>
#include <random>

#include "solver/motion.hpp"
#include "solver/trig.hpp"
#include "tests/solver/jacobian_fixture.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// The Jacobian of every row against central differences of its error.
///
/// Rotation rows of space are the first order of C and the directions across a slider turn about
/// it, so both are compared where C = 0; an ellipse's distance is exact on the curve, so there.

template <int D>
struct JointPose {
  Vec<D> position_a;
  Vec<D> centre_offset;
  Rotation<D> rotation_a;
  Rotation<D> rotation_b;
};

template <int D>
static JointPose<D> random_pose(std::mt19937& random) {
  JointPose<D> pose;
  pose.position_a = random_vec<D>(random, 2.0f);
  pose.centre_offset = random_vec<D>(random, 2.0f);
  pose.rotation_a = rotation_by(random_vec<Dim<D>::kSpin>(random, 1.5f));
  pose.rotation_b = rotation_by(random_vec<Dim<D>::kSpin>(random, 1.5f));
  return pose;
}

/// One of the 2 (D + spin) freedoms, moved by `eps`; a first, positions before turns.
template <int D>
static JointPose<D> moved(JointPose<D> pose, int freedom, float eps) {
  const bool of_b = freedom >= Dim<D>::kFreedoms;
  const int i = freedom % Dim<D>::kFreedoms;
  if (i < D) {
    if (!of_b) pose.position_a[i] += eps;
    pose.centre_offset[i] += of_b ? eps : -eps;
    return pose;
  }
  Spin<D> turn = Spin<D>::zero();
  turn[i - D] = eps;
  Rotation<D>& rotation = of_b ? pose.rotation_b : pose.rotation_a;
  rotation = compose(rotation_by(turn), rotation);
  return pose;
}

template <int D>
static JointRows<D> rows_at(const WorldState<D>& state, const Joint<D>& joint,
                            const JointPose<D>& pose) {
  JointRows<D> rows;
  rows_of(make_frame(state, joint, pose.position_a, pose.centre_offset, pose.rotation_a,
                     pose.rotation_b, 0.0f),
          rows);
  return rows;
}

/// The wheel's motor turns the angle of b relative to a, which no row's error holds.
template <int D>
static float angle_at(const WorldState<D>& state, const Joint<D>& joint, const JointPose<D>& pose) {
  const Rotation<D> relative = make_frame(state, joint, pose.position_a, pose.centre_offset,
                                          pose.rotation_a, pose.rotation_b, 0.0f)
                                   .relative;
  return atan2(relative[1], relative[0]);
}

template <int D>
static void expect_exact(const WorldState<D>& state, const Joint<D>& joint,
                         const JointPose<D>& pose) {
  const JointRows<D> rows = rows_at(state, joint, pose);
  for (int freedom = 0; freedom < 2 * Dim<D>::kFreedoms; ++freedom) {
    const JointPose<D> forth = moved(pose, freedom, kDifference);
    const JointPose<D> back = moved(pose, freedom, -kDifference);
    const JointRows<D> ahead = rows_at(state, joint, forth);
    const JointRows<D> behind = rows_at(state, joint, back);
    const auto compare = [&](const Row<D>& row, float after, float before, const char* name) {
      const float slope = (after - before) / (2.0f * kDifference);
      EXPECT_NEAR(entry(row, freedom), slope, kSlopeTolerance * std::max(1.0f, std::abs(slope)))
          << name << " by freedom " << freedom << " of kind " << static_cast<int>(joint.kind);
    };
    for (int i = 0; i < rows.count; ++i) {
      const auto r = static_cast<std::size_t>(i);
      compare(rows.rows[r], ahead.rows[r].error, behind.rows[r].error, "row");
    }
    if (rows.has_axis) compare(rows.axis, ahead.axis.error, behind.axis.error, "axis");
    if (rows.has_motor_axis)
      compare(rows.motor_axis, angle_at(state, joint, forth), angle_at(state, joint, back),
              "motor axis");
  }
}

template <int D>
static Joint<D> joint_of(JointKind kind, std::mt19937& random) {
  Joint<D> joint{};
  joint.kind = kind;
  joint.body_a = 0;
  joint.body_b = 1;
  joint.anchor_a = random_vec<D>(random, 0.8f);
  joint.anchor_b = random_vec<D>(random, 0.8f);
  Vec<D> x = Vec<D>::zero();
  x[0] = 1.0f;
  joint.axis = normalized_or(random_vec<D>(random, 1.0f), x);
  joint.reference = rotation_by(random_vec<Dim<D>::kSpin>(random, 1.0f));
  joint.length = 0.7f;
  joint.ratio = -1.7f;
  joint.ground_a = random_vec<D>(random, 1.0f);
  joint.ground_b = random_vec<D>(random, 1.0f);
  joint.ground_a[1] += 6.0f;
  joint.ground_b[1] += 6.0f;
  return joint;
}

/// Turns b to C = 0 of the rotation rows, and moves it to C = 0 of the rows across the axis.
template <int D>
static void satisfy_slider(const Joint<D>& joint, JointPose<D>& pose) {
  pose.rotation_b = compose(pose.rotation_a, joint.reference);
  pose.centre_offset = rotate(pose.rotation_a, joint.anchor_a + 0.9f * joint.axis) -
                       rotate(pose.rotation_b, joint.anchor_b);
}

struct Case {
  JointKind kind;
  int rows_plane;
  int rows_space;  ///< -1: only in the plane.
};

/// The freedoms that each joint takes from the 3 or 6 of a body. A spring or rope takes none.
constexpr Case kCases[] = {
    {JointKind::kDistance, 1, 1}, {JointKind::kRevolute, 2, 3}, {JointKind::kPrismatic, 2, 5},
    {JointKind::kWheel, 1, -1},   {JointKind::kWeld, 3, 6},     {JointKind::kMotor, 3, 6},
    {JointKind::kTarget, 2, 3},   {JointKind::kGear, 1, -1},    {JointKind::kPulley, 1, 1},
    {JointKind::kCurve, 1, -1},
};

template <int D>
static void check_all_kinds() {
  std::mt19937 random(20240607);
  for (const Case& test : kCases) {
    const int expected = D == 2 ? test.rows_plane : test.rows_space;
    if (expected < 0) continue;
    for (int trial = 0; trial < 12; ++trial) {
      WorldState<D> state;
      state.bodies.edit([](auto& bodies) { bodies.resize(2); });
      Joint<D> joint = joint_of<D>(test.kind, random);
      joint.size = {0.9f, 0.9f};
      JointPose<D> pose = random_pose<D>(random);
      if (D == 3) satisfy_slider(joint, pose);
      EXPECT_EQ(rows_at(state, joint, pose).count, expected) << static_cast<int>(test.kind);
      EXPECT_LE(rows_at(state, joint, pose).split, expected);
      expect_exact(state, joint, pose);
    }
  }
}

TEST(Jacobian, OfEveryKindIsTheDerivativeOfItsErrorInThePlane) {
  check_all_kinds<2>();
}

TEST(Jacobian, OfEveryKindIsTheDerivativeOfItsErrorInSpace) {
  check_all_kinds<3>();
}

template <int D>
static void check_coordinates() {
  std::mt19937 random(7);
  for (int trial = 0; trial < 12; ++trial) {
    WorldState<D> state;
    state.bodies.edit([](auto& bodies) { bodies.resize(2); });
    const JointPose<D> pose = random_pose<D>(random);
    Joint<D> spring = joint_of<D>(JointKind::kDistance, random);
    spring.hertz = 2.0f;
    Joint<D> rope = joint_of<D>(JointKind::kDistance, random);
    rope.limit_enabled = 1;
    Joint<D> driven = joint_of<D>(JointKind::kDistance, random);
    driven.motor = MotorKind::kSpeed;
    Joint<D> slack = joint_of<D>(JointKind::kPulley, random);
    slack.limit_enabled = 1;
    for (const Joint<D>& joint : {spring, rope, driven, slack}) {
      const JointRows<D> rows = rows_at(state, joint, pose);
      EXPECT_EQ(rows.count, 0);
      EXPECT_TRUE(rows.has_axis);
      expect_exact(state, joint, pose);
    }
  }
}

TEST(Jacobian, OfTheCoordinateOfSpringsRopesAndSlackPulleysIsExactAnywhere) {
  check_coordinates<2>();
  check_coordinates<3>();
}

TEST(Jacobian, OfARackIsExactAndItsAngleCountsWholeTurns) {
  std::mt19937 random(11);
  WorldState<2> state;
  state.bodies.edit([](auto& bodies) { bodies.resize(2); });
  for (int trial = 0; trial < 12; ++trial) {
    const JointPose<2> pose = random_pose<2>(random);
    Joint<2> joint = joint_of<2>(JointKind::kGear, random);
    expect_exact(state, joint, pose);
    joint.axis = Vec<2>::zero();
    expect_exact(state, joint, pose);
    const float once = rows_at(state, joint, pose).rows[0].error;
    joint.unwrapped = {2.0f * kPi, 0.0f};
    EXPECT_NEAR(rows_at(state, joint, pose).rows[0].error - once, 2.0f * kPi, 1.0e-5f);
  }
}

/// A point of each curve, from its parameter; in the frame of anchor_a.
static Vec<2> point_on(CurveKind kind, const std::array<float, 2>& size, float t) {
  if (kind == CurveKind::kCycloid)
    return {{size[0] * (t + std::sin(t)), -size[0] * (1.0f + std::cos(t))}};
  const float height = kind == CurveKind::kCircle ? size[0] : size[1];
  return {{size[0] * std::cos(t), height * std::sin(t)}};
}

TEST(Jacobian, OfCurvesIsExactOnThemAndTheErrorVanishesThere) {
  std::mt19937 random(13);
  WorldState<2> state;
  state.bodies.edit([](auto& bodies) { bodies.resize(2); });
  for (const CurveKind curve : {CurveKind::kCircle, CurveKind::kEllipse, CurveKind::kCycloid})
    for (int trial = 0; trial < 12; ++trial) {
      Joint<2> joint = joint_of<2>(JointKind::kCurve, random);
      joint.curve = curve;
      joint.size = {1.5f, 0.8f};
      joint.limit_enabled = trial % 2 == 0 ? 1 : 0;
      JointPose<2> pose = random_pose<2>(random);
      const float t = -2.2f + 0.4f * static_cast<float>(trial);
      const Vec<2> at = point_on(curve, joint.size, t);
      pose.centre_offset =
          rotate(pose.rotation_a, joint.anchor_a + at) - rotate(pose.rotation_b, joint.anchor_b);
      const JointRows<2> rows = rows_at(state, joint, pose);
      const Row<2>& row = rows.has_axis ? rows.axis : rows.rows[0];
      EXPECT_EQ(rows.has_axis, trial % 2 == 0);
      EXPECT_NEAR(row.error, 0.0f, 2.0e-6f);
      expect_exact(state, joint, pose);
    }
}

TEST(Jacobian, OfAPolylineIsExactBesideEdgesAndAroundCorners) {
  World<2> world = make_world<2>();
  add_at<2>(world, {{0.0f, 0.0f}}, box(1.0f, 0.5f));
  const WorldState<2>& state = world.state();
  std::mt19937 random(17);
  Joint<2> joint = joint_of<2>(JointKind::kCurve, random);
  joint.curve = CurveKind::kPolyline;
  // Above an edge, below it inside, and outside of a corner.
  const Vec<2> points[] = {{{0.3f, 0.8f}}, {{0.1f, 0.35f}}, {{1.4f, 0.9f}}, {{-1.2f, 0.1f}}};
  const float distances[] = {0.3f, -0.15f, std::sqrt(0.32f), 0.2f};
  for (std::size_t i = 0; i < 4; ++i) {
    JointPose<2> pose = random_pose<2>(random);
    pose.centre_offset =
        rotate(pose.rotation_a, points[i]) - rotate(pose.rotation_b, joint.anchor_b);
    EXPECT_NEAR(rows_at(state, joint, pose).rows[0].error, distances[i], 1.0e-5f) << i;
    expect_exact(state, joint, pose);
  }
}

}  // namespace cycloid::solver
