#include <gtest/gtest.h>

#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// A body of 2 kg, slot 0, that the warm start has just set going to the right, between joints
/// along x to slot 1 and to slot 2, which have no mass.
struct BodyBetweenRows {
  StepScratch<2> scratch;
  Workers workers{1};
  Lot lot{};

  BodyBetweenRows(float speed, float from_left, float from_right) {
    scratch.masses.resize(3);
    scratch.masses[0] = {0.5f, {{1.0f}}};
    scratch.motions.resize(4);
    scratch.motions[0].velocity = {{speed, 0.0f}};
    IslandSolver<2>& solver = scratch.islands_solved;
    solver.island_of = {0, -1, -1};
    solver.guess.resize(4);
    solver.islands.emplace_back();
    solver.islands[0].weighed = true;
    solver.islands[0].groups = solver.islands[0].joints = {0, 2};
    add_joint(1, from_left);
    add_joint(2, from_right);
    scratch.single_rows.order = {0, 1};
    scratch.single_rows.overflow = {0, 2};
  }

  void add_joint(std::uint32_t to, float impulse) {
    const int place = static_cast<int>(scratch.joint_rows.size());
    JointRow<2>& row = scratch.joint_rows.emplace_back();
    row.body_a = 0;
    row.body_b = to;
    row.rows_function = [](const JointFrame<2>&, JointRows<2>&) {};
    row.mass_a = scratch.masses[0];
    row.rows.count = 1;
    row.rows.rows[0].linear_a = {{1.0f, 0.0f}};
    row.rows.rows[0].linear_b = {{-1.0f, 0.0f}};
    row.impulse[0] = impulse;
    scratch.islands_solved.held.push_back({0, to, place, -1, 1, true, false});
    scratch.islands_solved.held_in.push_back(0);
    scratch.islands_solved.sources.push_back({place, -1, 0});
    scratch.pins.lane_of.push_back(Pins<2>::kNone);
  }

  /// Holds the body by a pin where joint 0 was.
  void pin_it(float impulse) {
    auto& pins = std::get<PinBlocks<2, 1>>(scratch.pins.blocks);
    PinBlock<2, 1>& block = pins.blocks.emplace_back();
    block = {};
    block.body_b[0] = 1;
    block.moves_a = block.used = block.rest.is_wild = 1;
    block.mass_a.inverse_mass = Lanes<1>(0.5f);
    block.direction[0][0] = block.direction[1][1] = Lanes<1>(-1.0f);
    block.impulse[0] = Lanes<1>(impulse);
    pins.colors = {{0, 1}};
    scratch.pins.lanes = 1;
    scratch.pins.lane_of[0] = 0;
    scratch.single_rows = {{1}, {{0, 0}}, {0, 1}};
  }
  float pin_impulse() const {
    return std::get<PinBlocks<2, 1>>(scratch.pins.blocks).blocks[0].impulse[0].raw[0];
  }

  /// Puts the body onto slot 2, which pushes it up.
  void put_down(float impulse) {
    auto& contacts = std::get<ContactBlocks<2, 1>>(scratch.contact_blocks);
    ContactBlock<2, 1>& block = contacts.blocks.emplace_back();
    block = {};
    block.body_a[0] = 2;
    block.moves_b = block.point_count = 1;
    block.mass_b.inverse_mass = Lanes<1>(0.5f);
    block.normal[1] = Lanes<1>(1.0f);
    block.points[0].normal_impulse = Lanes<1>(impulse);
    contacts.colors = {{0, 1}};
    lot.colors = {0, 1};
    scratch.islands_solved.held.push_back({2, 0, 0, 0, 1, false, true});
    scratch.islands_solved.held_in.push_back(0);
  }
  float contact_impulse() const {
    return std::get<ContactBlocks<2, 1>>(scratch.contact_blocks)
        .blocks[0]
        .points[0]
        .normal_impulse.raw[0];
  }

  void weigh() {
    const StepContext<2> context = make_step_context<2>(1.0f / 60.0f, {{0.0f, 0.0f}}, Tuning{});
    weigh_guesses<2, 1>(context, lot, workers, scratch);
  }

  float speed() const { return scratch.motions[0].velocity[0]; }
  float impulse(std::size_t joint) const { return scratch.joint_rows[joint].impulse[0]; }
};

// A stress of a thousand newton seconds whose rest of 20 throws the body away.
TEST(WeighGuesses, TakesBackWhatThrowsABodyAway) {
  BodyBetweenRows body(10.0f, 1020.0f, -1000.0f);
  body.weigh();
  EXPECT_NEAR(body.speed(), 0.0f, 1.0e-3f);
  EXPECT_NEAR(body.impulse(0), 0.0f, 0.1f);
  EXPECT_NEAR(body.impulse(1), 0.0f, 0.1f);
}

// The guess of 20 N s has turned 4 m/s to the left into 6 to the right: 8 of it are worth having.
TEST(WeighGuesses, KeepsWhatHoldsTheBody) {
  BodyBetweenRows body(6.0f, 30.0f, -10.0f);
  body.weigh();
  EXPECT_NEAR(body.speed(), 0.0f, 1.0e-5f);
  EXPECT_NEAR(body.impulse(0), 12.0f, 1.0e-5f);
  EXPECT_NEAR(body.impulse(1), -4.0f, 1.0e-5f);
}

TEST(WeighGuesses, LeavesAloneWhatIsWorthAll) {
  BodyBetweenRows body(-2.0f, 30.0f, -10.0f);
  body.weigh();
  EXPECT_EQ(body.speed(), -2.0f);
  EXPECT_EQ(body.impulse(0), 30.0f);
}

// Both ride to the right at 5 m/s, and the guess has made the body as fast as what carries it.
TEST(WeighGuesses, ReckonsWithGroundThatMoves) {
  BodyBetweenRows body(5.0f, 20.0f, 0.0f);
  body.scratch.motions[1].velocity = body.scratch.motions[2].velocity = {{5.0f, 0.0f}};
  body.scratch.motions[0].velocity[1] = 3.0f;
  body.scratch.joint_rows[1].rows.rows[0].linear_a = {{0.0f, 1.0f}};
  body.scratch.joint_rows[1].rows.rows[0].linear_b = {{0.0f, -1.0f}};
  body.weigh();
  EXPECT_EQ(body.speed(), 5.0f);
  EXPECT_EQ(body.impulse(0), 20.0f);
}

// A pin whose guess of 20 N s has turned 5 m/s to the left into 5 to the right.
TEST(WeighGuesses, WeighsPins) {
  for (const float carried : {0.0f, 5.0f}) {
    BodyBetweenRows body(5.0f, 0.0f, 0.0f);
    body.pin_it(20.0f);
    body.scratch.motions[1].velocity = {{carried, 0.0f}};
    body.weigh();
    EXPECT_NEAR(body.speed(), carried, 1.0e-5f);
    EXPECT_NEAR(body.pin_impulse(), carried > 0.0f ? 20.0f : 10.0f, 1.0e-5f);
  }
}

// A contact has pushed the body up to 5 m/s, beside a joint that is wild.
TEST(WeighGuesses, WeighsContacts) {
  for (const float lifted : {0.0f, 5.0f}) {
    BodyBetweenRows body(0.0f, 0.0f, 0.0f);
    body.put_down(10.0f);
    body.scratch.motions[0].velocity = {{0.0f, 5.0f}};
    body.scratch.motions[1].velocity = {{-3.0f, 0.0f}};
    body.scratch.motions[2].velocity = {{0.0f, lifted}};
    body.weigh();
    EXPECT_NEAR(body.scratch.motions[0].velocity[1], lifted, 1.0e-5f);
    EXPECT_NEAR(body.contact_impulse(), 2.0f * lifted, 1.0e-5f);
  }
}

TEST(WeighGuesses, LooksAtNothingThatMissesLittle) {
  BodyBetweenRows body(0.5f, 1020.0f, -1000.0f);
  body.weigh();
  EXPECT_EQ(body.speed(), 0.5f);
  EXPECT_EQ(body.impulse(0), 1020.0f);
}

TEST(WeighGuesses, LeavesAloneWhatIsSolvedAtOnce) {
  BodyBetweenRows body(10.0f, 1020.0f, -1000.0f);
  auto& island = body.scratch.islands_solved.islands[0];
  island.weighed = false;
  island.taken = true;
  island.products_left = 1;
  body.weigh();
  EXPECT_EQ(body.speed(), 10.0f);
  island.products_left = 0;
  body.weigh();
  EXPECT_NEAR(body.speed(), 0.0f, 1.0e-3f) << "it has cost too much, and is swept from here on";
}

}  // namespace cycloid::solver
