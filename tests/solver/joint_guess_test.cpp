#include <gtest/gtest.h>

#include "solver/constraints/joint_solve.hpp"
#include "solver/constraints/pin_kernels.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

static constexpr float kMost = 720.0f;
static constexpr float kArm = 0.5f;
static constexpr float kInverseInertia = 4.0f;
/// The force along its arm with which a joint's guess is at its bound, as an impulse, N s.
static constexpr float kBound = kMost / (kArm * kInverseInertia);

/// A pin at an arm of b along x, whose force `along` it does nothing to how b turns now.
static JointRow<2> row_with(float along, float limit) {
  JointRow<2> row{};
  row.mass_b = {1.0f, {{kInverseInertia}}};
  row.rows.split = row.rows.count = 2;
  for (int i = 0; i < 2; ++i) {
    Row<2>& equality = row.rows.rows[static_cast<std::size_t>(i)];
    equality.linear_b[i] = 1.0f;
    equality.linear_a[i] = -1.0f;
    equality.angular_b = {{i == 0 ? 0.0f : kArm}};
  }
  row.rows.has_axis = true;
  row.rows.axis.angular_b = {{1.0f}};
  row.impulse[0] = along;
  row.lower_impulse = limit;
  return row;
}

TEST(JointGuess, IsKeptWhereItIsStable) {
  JointRow<2> row = row_with(0.99f * kBound, 0.1f);
  Motion<2> a{};
  Motion<2> b{};
  warm_start(kMost, row, a, b);
  EXPECT_EQ(row.impulse[0], 0.99f * kBound);
  EXPECT_EQ(row.lower_impulse, 0.1f);
  EXPECT_EQ(b.velocity[0], 0.99f * kBound);
}

TEST(JointGuess, OfAForceAlongItsArmIsHeldToWhatIsStable) {
  JointRow<2> row = row_with(4.0f * kBound, 0.4f);
  Motion<2> a{};
  Motion<2> b{};
  warm_start(kMost, row, a, b);
  EXPECT_NEAR(row.impulse[0], kBound, 1.0e-5f * kBound);
  EXPECT_NEAR(row.lower_impulse, 0.1f, 1.0e-6f);
  EXPECT_EQ(b.velocity[0], row.impulse[0]);
}

TEST(JointGuess, OfATorqueTurnsNoBodyFurther) {
  JointRow<2> row = row_with(0.0f, 1.0e6f);
  Motion<2> a{};
  Motion<2> b{};
  warm_start(kMost, row, a, b);
  EXPECT_NEAR(b.spin[0], kMost, 1.0e-2f);
}

TEST(JointGuess, IsBoundWhereSpringsHold) {
  EXPECT_NEAR((make_step_context<2>(kTick, {}, Tuning{}).guess_spin_max), 720.0f, 1.0e-3f);
  const auto of_pgs = make_step_context<2>(kTick, {}, Tuning::pgs());
  EXPECT_GT(of_pgs.guess_spin_max, 1.0e15f);
}

TEST(JointGuess, OfWhatIsSolvedAtOnceIsKept) {
  JointRow<2> row = row_with(4.0f * kBound, 0.4f);
  row.solved_directly = true;
  Motion<2> a{};
  Motion<2> b{};
  warm_start(kMost, row, a, b);
  EXPECT_EQ(row.impulse[0], 4.0f * kBound);
}

/// The impulses that a pin keeps in its first two lanes, of which the second is solved at once.
static void expect_pin_keeps(float along, float kept) {
  PinBlock<2, 4> block{};
  PinTurns<2, 4> turns{};
  block.form.has_limits = true;
  block.turns = &turns;
  block.used = 3;
  block.settled = 2;
  block.mass_b.inverse_mass = Lanes<4>(1.0f);
  block.mass_b.inverse_inertia[0] = Lanes<4>(kInverseInertia);
  block.direction[0][0] = block.direction[1][1] = Lanes<4>(1.0f);
  block.angular_b[1] = {{Lanes<4>(kArm)}};
  block.impulse[0] = Lanes<4>(along);
  turns.axis.direction = {{Lanes<4>(1.0f)}};
  Motion<2> motions[1] = {};
  PinKernels<2, 4>::warm_start(kMost, {&block, &block + 1, motions});
  EXPECT_EQ(block.impulse[0].raw[0], kept);
  EXPECT_EQ(block.impulse[0].raw[1], along);
}

TEST(JointGuess, OfAPinIsWhatThatOfItsRowsIs) {
  for (const float times : {0.5f, 0.99f, 1.01f, 3.0f, 1.0e6f}) {
    JointRow<2> row = row_with(times * kBound, 0.0f);
    Motion<2> a{};
    Motion<2> b{};
    warm_start(kMost, row, a, b);
    expect_pin_keeps(times * kBound, row.impulse[0]);
  }
}

/// Balls in a net of pins at arms four times their size, which comes down on the ground: jammed
/// there, each would be thrown out by guesses that have turned with it.
static Error crush_net(ContactBlockRows islands, float speed) {
  constexpr int kSide = 20;
  WorldDef<2> def = with_gravity<2>();
  def.tuning.contact_block = islands;
  World<2> world = make_world(def);
  add_ground<2>(world, up<2>());
  std::vector<BodyId> balls;
  const auto pin = [&](BodyId a, BodyId b, Vec<2> arm) {
    JointDef<2> joint;
    joint.kind = JointKind::kRevolute;
    joint.body_a = a;
    joint.body_b = b;
    joint.anchor_a = arm;
    joint.anchor_b = -arm;
    EXPECT_TRUE(world.create_joint(joint).ok());
  };
  for (int i = 0; i < kSide * kSide; ++i) {
    const auto x = static_cast<float>(i % kSide);
    BodyDef<2> body;
    body.position = {{0.5f * x, 0.6f + 0.5f * static_cast<float>(i / kSide) + 0.013f * x}};
    body.velocity = {{0.0f, -speed}};
    balls.push_back(add(world, body, ball<2>(0.06f)));
    const auto at = static_cast<std::size_t>(i);
    if (i % kSide > 0) pin(balls[at - 1], balls[at], {{0.25f, 0.0f}});
    if (i >= kSide) pin(balls[at - kSide], balls[at], {{0.0f, 0.25f}});
  }
  Error error;
  for (int tick = 0; tick < 150 && error.ok(); ++tick) error = world.step();
  return error;
}

TEST(JointGuess, NoNetThatIsCrushedFaults) {
  for (const ContactBlockRows islands : {ContactBlockRows::kNone, ContactBlockRows::kLoadedIsland})
    for (const float speed : {7.0f, 8.0f, 10.0f, 12.5f})
      EXPECT_TRUE(crush_net(islands, speed).ok()) << static_cast<int>(islands) << ' ' << speed;
}

}  // namespace cycloid::solver
