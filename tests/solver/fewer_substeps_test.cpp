#include <cstring>

#include "tests/solver/joint_scene.hpp"

namespace cycloid::solver {

/// A ball of 1 kg without friction on the ground, and on it one of 1000 kg: more than soft contacts
/// hold up, so it is a loaded island, and it is all that moves.
template <int D>
struct Column {
  World<D> world;
  BodyId light;
  BodyId heavy;
};

struct Asked {
  Tuning tuning;
  float restitution = 0.0f;
  float speed = 0.0f;    ///< Of both along the ground, m/s.
  float spin = 0.0f;     ///< Of the heavy one, rad/s.
  float damping = 0.0f;  ///< 1/s.
};

static Tuning without_sleep(Tuning tuning) {
  tuning.sleep_s = 0.0f;
  return tuning;
}

/// On a ground that it adds.
template <int D>
static std::pair<BodyId, BodyId> add_column(World<D>& world, const Asked& asked) {
  add_ground<D>(world, up<D>());
  BodyDef<D> body;
  body.mass = 1.0f;
  body.position[1] = 0.5f;
  body.velocity[0] = asked.speed;
  body.linear_damping = asked.damping;
  const BodyId light = add(world, body, ball<D>(0.5f));
  body.mass = 1000.0f;
  body.position[1] = 1.5f;
  body.spin[Dim<D>::kSpin - 1] = asked.spin;
  const BodyId heavy = add(world, body, ball<D>(0.5f));
  return {light, heavy};
}

template <int D>
static Column<D> make_column(const Asked& asked) {
  Material material;
  material.friction = 0.0f;
  material.restitution = asked.restitution;
  WorldDef<D> def = with_gravity<D>(material);
  def.tuning = without_sleep(asked.tuning);
  World<D> world = make_world<D>(def);
  const auto [light, heavy] = add_column(world, asked);
  return {std::move(world), light, heavy};
}

template <int D>
static std::uint32_t substeps_after(int ticks, const Asked& asked) {
  Column<D> column = make_column<D>(asked);
  step(column.world, ticks);
  return column.world.statistics().substeps;
}

/// Of both contacts in a tick, as the state has them in one substep of those asked for, N s.
template <int D>
static float impulse_of_tick(const World<D>& world) {
  float sum = 0.0f;
  for (const Contact<D>& contact : world.state().contacts) sum += contact.points[0].normal_impulse;
  return sum * static_cast<float>(world.state().header.tuning.substeps);
}

TEST(FewerSubsteps, HalfAsManyWhereLoadedIslandsHaveAllThatMoves) {
  EXPECT_EQ(substeps_after<2>(30, {}), 2u);
  EXPECT_EQ(substeps_after<3>(30, {}), 2u);
  EXPECT_EQ(substeps_after<2>(30, {Tuning{}.in_substeps(8)}), 4u);
}

TEST(FewerSubsteps, NotWhereItWouldNotBeHalfOrTooFew) {
  for (const std::uint32_t asked : {1u, 2u, 3u, 5u})
    EXPECT_EQ(substeps_after<2>(30, {Tuning{}.in_substeps(asked)}), asked);
}

/// A ball of 1 kg that hangs by a joint, and from it by another, at its own centre, one of 1000 kg:
/// joints between unequal masses, so it is a loaded island, and it is all that moves.
template <int D>
struct Pendulum : Scene<D> {
  static constexpr float kHeight = 6.0f;  ///< Of the heavy one.
  BodyId heavy;

  explicit Pendulum(const Asked& asked) : Scene<D>(without_sleep(asked.tuning)) {
    const BodyId light = this->add_ball(at<D>(20.0f, 8.0f), 1.0f);
    heavy = this->add_ball(at<D>(20.0f, kHeight), 1000.0f);
    JointDef<D> joint = this->joint(JointKind::kRevolute, this->anchor, light);
    joint.anchor_a = at<D>(20.0f, 8.0f);
    this->create(joint);
    joint = this->joint(JointKind::kRevolute, light, heavy);
    joint.anchor_a = at<D>(0.0f, -2.0f);
    this->create(joint);
    turn(asked.spin);
  }
  /// The heavy one, from rest.
  void turn(float spin) {
    Spin<D> about = Spin<D>::zero();
    about[Dim<D>::kSpin - 1] = spin;
    ASSERT_TRUE(this->world.set_velocity(heavy, Vec<D>::zero(), about).ok());
  }
  /// By as much, m, from where it hangs.
  void lower_heavy(float apart) {
    const BodyView<D> now = view(this->world, heavy);
    const Vec<D> lower = now.position - at<D>(0.0f, apart);
    ASSERT_TRUE(this->world.set_pose(heavy, lower, now.rotation).ok());
  }
  std::uint32_t substeps() const { return this->world.statistics().substeps; }
};

template <int D>
static std::uint32_t substeps_of_pendulum(const Asked& asked) {
  Pendulum<D> pendulum(asked);
  step(pendulum.world, 30);
  return pendulum.substeps();
}

TEST(FewerSubsteps, AQuarterWhereJointsHoldAllThatMoves) {
  EXPECT_EQ(substeps_of_pendulum<2>({}), 1u);
  EXPECT_EQ(substeps_of_pendulum<3>({}), 1u);
  EXPECT_EQ(substeps_of_pendulum<2>({Tuning{}.in_substeps(6)}), 3u);
  EXPECT_EQ(substeps_of_pendulum<2>({Tuning{}.in_substeps(8)}), 2u);
}

// 0.025 rad in a substep of 1/60 s, then in one of 1/120.
TEST(FewerSubsteps, AQuarterOnlyWhileNothingTurnsFast) {
  for (const auto& [spin, substeps] : std::vector<std::pair<float, std::uint32_t>>{
           {1.4f, 1u}, {1.6f, 2u}, {2.9f, 2u}, {3.1f, 4u}}) {
    EXPECT_EQ(substeps_of_pendulum<2>({{}, 0.0f, 0.0f, spin}), substeps) << spin;
    EXPECT_EQ(substeps_of_pendulum<3>({{}, 0.0f, 0.0f, spin}), substeps) << spin;
  }
}

TEST(FewerSubsteps, HalfWhereAnIslandHasNoJoints) {
  Pendulum<2> pendulum({});
  add_column<2>(pendulum.world, {});
  step(pendulum.world, 30);
  EXPECT_EQ(pendulum.substeps(), 2u);
}

TEST(FewerSubsteps, UnderNoOtherMethod) {
  EXPECT_EQ(substeps_after<2>(30, {Tuning::soft_step()}), 4u);
  Tuning islands;
  islands.contact_block = ContactBlockRows::kIsland;
  EXPECT_EQ(substeps_after<2>(30, {islands}), 4u);
}

TEST(FewerSubsteps, NotBeforeThereIsALoad) {
  EXPECT_EQ(substeps_after<2>(1, {}), 4u);
}

TEST(FewerSubsteps, NotWhereSweepsAct) {
  EXPECT_EQ(substeps_after<2>(30, {{}, 0.5f}), 4u);
}

// Its contacts stay where they are, of a box they do not.
TEST(FewerSubsteps, AQuarterWhileABallRollsOnWhatJointsHold) {
  for (const bool is_ball : {true, false}) {
    Pendulum<2> pendulum({});
    step(pendulum.world, 30);
    BodyDef<2> body;
    body.position = at<2>(20.0f, 6.5f);
    body.spin[0] = 3.1f;
    add(pendulum.world, body, is_ball ? ball<2>(0.25f) : box(0.25f, 0.25f));
    step(pendulum.world, 1);
    EXPECT_EQ(pendulum.substeps(), is_ball ? 1u : 4u);
  }
}

// 0.025 rad in a substep of 1/120 s.
TEST(FewerSubsteps, NotWhileSomethingTurnsFast) {
  EXPECT_EQ(substeps_after<2>(30, {{}, 0.0f, 0.0f, 2.9f}), 2u);
  EXPECT_EQ(substeps_after<2>(30, {{}, 0.0f, 0.0f, 3.1f}), 4u);
  EXPECT_EQ(substeps_after<3>(30, {{}, 0.0f, 0.0f, 2.9f}), 2u);
  EXPECT_EQ(substeps_after<3>(30, {{}, 0.0f, 0.0f, 3.1f}), 4u);
}

// A joint by 8 cm.
TEST(FewerSubsteps, NotWhereAJointHasParted) {
  for (const auto& [apart, substeps] :
       std::vector<std::pair<float, std::uint32_t>>{{0.07f, 1u}, {0.09f, 4u}}) {
    Pendulum<2> pendulum({});
    step(pendulum.world, 30);
    pendulum.lower_heavy(apart);
    step(pendulum.world, 1);
    EXPECT_EQ(pendulum.substeps(), substeps) << apart;
  }
}

TEST(FewerSubsteps, NotWhileAnythingElseIsTouched) {
  Column<2> column = make_column<2>({});
  step(column.world, 30);
  const BodyId stands = add_at<2>(column.world, {{50.0f, 0.5f}}, ball<2>(0.5f));
  step(column.world, 1);
  EXPECT_EQ(column.world.statistics().substeps, 4u);
  ASSERT_TRUE(column.world.destroy_body(stands).ok());
  step(column.world, 1);
  EXPECT_EQ(column.world.statistics().substeps, 2u);
}

/// A damped rod that turns by 3 rad/s and more, high above all else.
template <int D>
static BodyId add_flying(World<D>& world) {
  BodyDef<D> body;
  body.mass = 1.0f;
  body.position = at<D>(50.0f, 400.0f);
  body.linear_damping = 0.5f;
  body.angular_damping = 0.25f;
  for (float& spin : body.spin.v) spin = 3.0f;
  ShapeDef<D> rod;
  rod.kind = ShapeKind::kCapsule;
  rod.points = {at<D>(-0.4f, -0.2f), at<D>(0.4f, 0.2f)};
  rod.radius = 0.1f;
  return add(world, body, rod);
}

template <int D>
static bool moves_as(const BodyView<D>& a, const BodyView<D>& b) {
  return std::memcmp(&a.position, &b.position, sizeof a.position) == 0 &&
         std::memcmp(&a.rotation, &b.rotation, sizeof a.rotation) == 0 &&
         std::memcmp(&a.velocity, &b.velocity, sizeof a.velocity) == 0 &&
         std::memcmp(&a.spin, &b.spin, sizeof a.spin) == 0;
}

// What nothing touches or holds is moved in all substeps, whatever becomes of the others, and they
// take as few as without it.
template <int D>
static void expect_flight_apart() {
  Column<D> column = make_column<D>({});
  step(column.world, 30);
  World<D> empty = make_world<D>(with_gravity<D>({}));
  const BodyId flies = add_flying(column.world);
  const BodyId alone = add_flying(empty);
  for (int tick = 0; tick < 120; ++tick) {
    step(column.world, 1);
    step(empty, 1);
    ASSERT_EQ(column.world.statistics().substeps, 2u);
    ASSERT_EQ(empty.statistics().substeps, 4u);
    ASSERT_TRUE(moves_as<D>(view(column.world, flies), view(empty, alone))) << tick;
  }
}
TEST(FewerSubsteps, WhatFliesTakesAllOfThem) {
  expect_flight_apart<2>();
  expect_flight_apart<3>();
}

// Whatever that may be: but where it may come down on joints, these have to have closed to half a
// millimetre before.
TEST(FewerSubsteps, AQuarterWhileSomethingFliesAndJointsAreClosed) {
  for (const auto& [apart, substeps] :
       std::vector<std::pair<float, std::uint32_t>>{{0.0f, 1u}, {0.0004f, 1u}, {0.0006f, 4u}}) {
    Pendulum<2> pendulum({});
    const BodyId flies = add_flying(pendulum.world);
    step(pendulum.world, 30);
    pendulum.lower_heavy(apart);
    step(pendulum.world, 1);
    EXPECT_EQ(pendulum.substeps(), substeps) << apart;
    ASSERT_TRUE(pendulum.world.destroy_body(flies).ok());
    pendulum.lower_heavy(apart);
    step(pendulum.world, 1);
    EXPECT_EQ(pendulum.substeps(), 1u) << apart;
  }
}

// What holds is a force, so neither the one change nor the other moves what rests.
template <int D>
static void expect_rest_through_changes() {
  Column<D> column = make_column<D>({});
  step(column.world, 60);
  const float weight = (1001.0f + 1000.0f) * 10.0f / 60.0f;
  for (int change = 0; change < 6; ++change) {
    if (change % 2 == 0) {
      Vec<D> far = Vec<D>::zero();
      far[0] = 50.0f;
      far[1] = 0.5f;
      const BodyId stands = add_at<D>(column.world, far, ball<D>(0.5f));
      step(column.world, 1);
      ASSERT_TRUE(column.world.destroy_body(stands).ok());
    } else {
      step(column.world, 1);
    }
    ASSERT_EQ(column.world.statistics().substeps, change % 2 == 0 ? 4u : 2u);
    EXPECT_NEAR(impulse_of_tick(column.world), weight, 0.01f * weight);
    EXPECT_LT(length(view(column.world, column.light).velocity), 2.0e-3f);
    EXPECT_LT(length(view(column.world, column.heavy).velocity), 2.0e-3f);
  }
}
TEST(FewerSubsteps, WhatRestsStaysAtRestAsTheyChange) {
  expect_rest_through_changes<2>();
  expect_rest_through_changes<3>();
}

template <int D>
static void expect_pendulum_hangs_through_changes() {
  Pendulum<D> pendulum({});
  step(pendulum.world, 60);
  for (const std::uint32_t substeps : {4u, 1u, 4u, 1u, 2u, 1u}) {
    pendulum.turn(substeps == 4 ? 4.0f : substeps == 2 ? 2.0f : 0.0f);
    step(pendulum.world, 1);
    ASSERT_EQ(pendulum.substeps(), substeps);
    EXPECT_LT(length(view(pendulum.world, pendulum.heavy).velocity), 2.0e-3f);
    EXPECT_NEAR(view(pendulum.world, pendulum.heavy).position[1], pendulum.kHeight, 1.0e-3f);
  }
}
TEST(FewerSubsteps, WhatHangsStaysAtRestAsTheyChange) {
  expect_pendulum_hangs_through_changes<2>();
  expect_pendulum_hangs_through_changes<3>();
}

TEST(FewerSubsteps, DampingIsThatOfTheirLength) {
  Column<2> column = make_column<2>({{}, 0.0f, 1.0f, 0.0f, 2.0f});
  step(column.world, 30);
  const float before = view(column.world, column.heavy).velocity[0];
  step(column.world, 30);
  ASSERT_EQ(column.world.statistics().substeps, 2u);
  float left = 1.0f;
  for (int substep = 0; substep < 60; ++substep) left /= 1.0f + 2.0f / 120.0f;
  EXPECT_NEAR(view(column.world, column.heavy).velocity[0] / before, left, 1.0e-4f);
}

}  // namespace cycloid::solver
