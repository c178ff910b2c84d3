#include "tests/solver/joint_scene.hpp"

namespace cycloid::solver {

/// Joints whose rows a user wrote.

constexpr std::uint32_t kParabola = 4;
constexpr std::uint32_t kBowl = 9;
constexpr std::uint32_t kCarried = 2;

/// b's anchor stays on y = k x^2 / 2 of a, in the plane, with k the first parameter:
///   C = y - k x^2 / 2, gradient (-k x, 1).
static void parabola_rows(const JointFrame<2>& frame, JointRows<2>& rows) {
  const Vec<2> p = rotate_back(frame.rotation_a, frame.offset);
  const float k = frame.joint.parameters[0];
  rows.rows[0] = translation_row(frame, rotate(frame.rotation_a, Vec<2>{{-k * p[0], 1.0f}}));
  rows.rows[0].error = p[1] - 0.5f * k * p[0] * p[0];
  rows.count = 1;
  rows.split = 1;
}

/// b's anchor stays in the bowl y = (x^2 + z^2) / 2 of a; its coordinate is x.
static void bowl_rows(const JointFrame<3>& frame, JointRows<3>& rows) {
  const Vec<3> p = rotate_back(frame.rotation_a, frame.offset);
  rows.rows[0] = translation_row(frame, rotate(frame.rotation_a, Vec<3>{{-p[0], 1.0f, -p[2]}}));
  rows.rows[0].error = p[1] - 0.5f * (p[0] * p[0] + p[2] * p[2]);
  rows.count = 1;
  rows.split = 1;
  rows.has_axis = true;
  rows.axis = translation_row(frame, rotate(frame.rotation_a, Vec<3>{{1.0f, 0.0f, 0.0f}}));
}

/// b's anchor stays at that of a until as many seconds as the first parameter have gone, and then
/// leaves along +x at 1 m/s.
template <int D>
static void carried_rows(const JointFrame<D>& frame, JointRows<D>& rows) {
  append_point_rows(frame, rows);
  rows.split = rows.count;
  const float since_s = frame.time_s - frame.joint.parameters[0];
  if (since_s < 0.0f) return;
  rows.rows[0].error -= since_s;
  rows.rows[0].rate = -1.0f;
}

template <int D>
static JointDef<D> user_joint(Scene<D>& scene, BodyId bead, std::uint32_t user_kind) {
  JointDef<D> def = scene.joint(JointKind::kUser, scene.anchor, bead);
  def.user_kind = user_kind;
  def.parameters = {1.0f, 0.0f, 0.0f, 0.0f};
  return def;
}

// Energy: v^2 / 2 = g (y0 - y), here from y = 0.5 to 0.
TEST(UserConstraint, BeadStaysOnAParabolaAndFallsByItsHeight) {
  for (const Method& method : methods()) {
    Scene<2> scene(method.tuning);
    scene.world.register_constraint(kParabola, &parabola_rows);
    const BodyId bead = scene.add_ball({{1.0f, 0.5f}}, 2.0f, 0.05f);
    scene.create(user_joint(scene, bead, kParabola));
    // Baumgarte at 60 Hz lags the bend by v^2 h^2 k / (2 beta) = 7 mm.
    const float bound = method.tuning.stabilisation == Stabilisation::kBaumgarte ? 0.008f : 0.002f;
    float fastest = 0.0f;
    for (int i = 0; i < 120; ++i) {
      step(scene.world, 1);
      const BodyView<2> now = view(scene.world, bead);
      const float height = 0.5f * now.position[0] * now.position[0];
      ASSERT_NEAR(now.position[1], height, bound) << method.name << " tick " << i;
      fastest = std::max(fastest, length(now.velocity));
    }
    EXPECT_NEAR(fastest, std::sqrt(10.0f), 0.03f * std::sqrt(10.0f)) << method.name;
  }
}

// On the horizontal circle of radius r a bead in the bowl circles at omega^2 = g, at any radius.
TEST(UserConstraint, BeadCirclesInABowlAtTheFrequencyOfGravity) {
  for (const Method& method : methods()) {
    Scene<3> scene(method.tuning.in_substeps(16));
    scene.world.register_constraint(kBowl, &bowl_rows);
    const BodyId bead = scene.add_ball({{0.8f, 0.32f, 0.0f}}, 2.0f, 0.05f);
    scene.create(user_joint(scene, bead, kBowl));
    const float omega = std::sqrt(10.0f);
    ASSERT_TRUE(scene.world.apply_impulse(bead, {{0.0f, 0.0f, 2.0f * 0.8f * omega}}).ok());
    double turned = 0.0;
    double last = 0.0;
    for (int i = 0; i < 300; ++i) {
      step(scene.world, 1);
      const Vec<3> p = view(scene.world, bead).position;
      const float square = p[0] * p[0] + p[2] * p[2];
      ASSERT_NEAR(p[1], 0.5f * square, 0.002f) << method.name << " tick " << i;
      ASSERT_NEAR(std::sqrt(square), 0.8f, 0.025f) << method.name << " tick " << i;
      const double angle = std::atan2(p[2], p[0]);
      turned += std::remainder(angle - last, 6.283185307179586);
      last = angle;
    }
    EXPECT_NEAR(turned, 5.0 * omega, 0.01 * 5.0 * omega) << method.name;
  }
}

TEST(UserConstraint, CoordinateTakesALimit) {
  Scene<3> scene(methods()[0].tuning);
  scene.world.register_constraint(kBowl, &bowl_rows);
  const BodyId bead = scene.add_ball({{0.8f, 0.32f, 0.0f}}, 2.0f, 0.05f);
  JointDef<3> def = user_joint(scene, bead, kBowl);
  def.limit_enabled = true;
  def.lower = 0.3f;
  def.upper = 2.0f;
  scene.create(def);
  step(scene.world, 300);
  EXPECT_NEAR(view(scene.world, bead).position[0], 0.3f, 0.005f);
  EXPECT_NEAR(view(scene.world, bead).position[1], 0.045f, 0.002f);
}

TEST(UserConstraint, IsRefusedBeforeItsFunctionIsRegistered) {
  Scene<2> scene(methods()[0].tuning);
  const BodyId bead = scene.add_ball({{1.0f, 0.5f}}, 2.0f, 0.05f);
  scene.world.register_constraint(kParabola + 1, &parabola_rows);
  const std::uint64_t before = scene.world.digest();
  const Result<JointId> refused = scene.world.create_joint(user_joint(scene, bead, kParabola));
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, Code::kInvalid);
  EXPECT_STREQ(refused.error().field, "user_kind");
  EXPECT_EQ(scene.world.digest(), before);
  scene.world.register_constraint(kParabola, &parabola_rows);
  EXPECT_EQ(scene.world.digest(), before);  // Functions are not state.
  EXPECT_TRUE(scene.world.create_joint(user_joint(scene, bead, kParabola)).ok());
  EXPECT_NE(scene.world.digest(), before);
}

template <int D>
static void check_waking() {
  for (Method method : methods()) {
    method.tuning.sleep_s = 0.5f;
    Scene<D> scene(method.tuning, false);
    scene.world.register_constraint(kCarried, &carried_rows<D>);
    const BodyId bead = scene.add_ball(Vec<D>::zero(), 2.0f, 0.05f);
    JointDef<D> def = user_joint(scene, bead, kCarried);
    def.parameters = {2.0f, 0.0f, 0.0f, 0.0f};
    scene.create(def);
    step(scene.world, 90);
    EXPECT_EQ(scene.world.state().bodies[bead.index].asleep, 1u) << method.name;
    step(scene.world, 210);
    EXPECT_EQ(scene.world.state().bodies[bead.index].asleep, 0u) << method.name;
    EXPECT_NEAR(view(scene.world, bead).position[0], 3.0f, 0.005f) << method.name;
  }
}

TEST(UserConstraint, SleepsUntilItsRowsStateARate) {
  check_waking<2>();
  check_waking<3>();
}

TEST(UserConstraint, ThatMovesWithTimeIsNotAheadOfIt) {
  std::vector<Method> all = methods();
  all.push_back({"split_impulse", Tuning::split_impulse()});
  all.back().tuning.sleep_s = 0.0f;
  for (const Method& method : all) {
    Scene<2> scene(method.tuning, false);
    scene.world.register_constraint(kCarried, &carried_rows<2>);
    const BodyId bead = scene.add_ball({{0.0f, 0.0f}}, 2.0f, 0.05f);
    scene.create(user_joint(scene, bead, kCarried));
    step(scene.world, 60);
    EXPECT_NEAR(view(scene.world, bead).position[0], 0.0f, 2.0e-3f) << method.name;
    step(scene.world, 120);
    EXPECT_NEAR(view(scene.world, bead).position[0], 2.0f, 2.0e-3f) << method.name;
  }
}

/// Leaves the first two parameters as its counts.
static void counted_rows(const JointFrame<2>& frame, JointRows<2>& rows) {
  rows.rows[0] = translation_row(frame, Vec<2>{{0.0f, 1.0f}});
  rows.count = static_cast<int>(frame.joint.parameters[0]);
  rows.split = static_cast<int>(frame.joint.parameters[1]);
}

TEST(UserConstraint, CountsThatCannotBeAreNoRows) {
  const auto height_with = [](float count, float split) {
    Scene<2> scene(Tuning{});
    scene.world.register_constraint(kParabola, &counted_rows);
    const BodyId bead = scene.add_ball({{1.0f, 0.5f}}, 2.0f, 0.05f);
    JointDef<2> def = user_joint(scene, bead, kParabola);
    def.parameters = {count, split, 0.0f, 0.0f};
    scene.create(def);
    step(scene.world, 10);
    return view(scene.world, bead).position[1];
  };
  const float falling = height_with(0.0f, 0.0f);
  EXPECT_NE(height_with(1.0f, 1.0f), falling);
  EXPECT_EQ(height_with(1.0f, 5.0f), falling);
  EXPECT_EQ(height_with(99.0f, 1.0f), falling);
  EXPECT_EQ(height_with(99.0f, 99.0f), falling);
  EXPECT_EQ(height_with(1.0f, -1.0f), falling);
}

TEST(UserConstraint, KindAndParametersAreInTheDigest) {
  std::vector<std::uint64_t> digests;
  for (const float parameter : {1.0f, 2.0f})
    for (const std::uint32_t kind : {kParabola, kParabola + 1}) {
      Scene<2> scene(methods()[0].tuning);
      scene.world.register_constraint(kind, &parabola_rows);
      const BodyId bead = scene.add_ball({{1.0f, 0.5f}}, 2.0f, 0.05f);
      JointDef<2> def = user_joint(scene, bead, kind);
      def.parameters[0] = parameter;
      scene.create(def);
      digests.push_back(scene.world.digest());
    }
  for (std::size_t i = 0; i < digests.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) EXPECT_NE(digests[i], digests[j]) << i << " " << j;
}

TEST(UserConstraint, IsSavedAndEncodedAndAWorldWithoutItsFunctionDoesNotStep) {
  Scene<2> scene(methods()[0].tuning);
  scene.world.register_constraint(kParabola, &parabola_rows);
  const BodyId bead = scene.add_ball({{1.0f, 0.5f}}, 2.0f, 0.05f);
  scene.create(user_joint(scene, bead, kParabola));
  step(scene.world, 20);
  std::vector<std::byte> bytes;
  scene.world.encode(bytes);

  World<2> other = make_world<2>();
  ASSERT_TRUE(other.decode(bytes).ok());
  World<2> third = make_world<2>();
  third.restore(scene.world.state());
  for (World<2>* world : {&other, &third}) {
    const std::uint64_t before = world->digest();
    EXPECT_EQ(before, scene.world.digest());
    const Error error = world->step();
    EXPECT_EQ(error.code, Code::kInvalid);
    EXPECT_STREQ(error.field, "user_kind");
    EXPECT_EQ(world->digest(), before);
    EXPECT_FALSE(world->fault().has_value());
    world->register_constraint(kParabola, &parabola_rows);
  }
  step(scene.world, 40);
  step(other, 40);
  step(third, 40);
  EXPECT_EQ(other.digest(), scene.world.digest());
  EXPECT_EQ(third.digest(), scene.world.digest());
}

}  // namespace cycloid::solver
