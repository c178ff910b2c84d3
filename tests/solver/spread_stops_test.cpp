#include "solver/stages/stages.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// Two bodies that move along x by 1 m in the tick, jointed where they meet: 0 ends a quarter of
/// its way early, 1 not.
struct PairThatStops {
  WorldState<2> state;
  StepScratch<2> scratch;
  StepContext<2> context = make_step_context<2>(kTick, {}, Tuning{});

  PairThatStops() {
    Body<2> body{};
    body.rotation = identity_rotation<2>();
    state.bodies.edit([&](auto& bodies) { bodies.assign(2, body); });
    Joint<2> joint{};
    joint.anchor_a = {{0.5f, 0.0f}};
    joint.anchor_b = {{-0.5f, 0.0f}};
    state.joints.edit([&](auto& joints) { joints.push_back(joint); });
    JointRow<2>& row = scratch.joint_rows.emplace_back();
    row.body_b = 1;
    row.holds_point = true;
    row.centre_offset = {{1.0f, 0.0f}};
    scratch.masses.assign(2, {1.0f, {{1.0f}}});
    Motion<2> motion{};
    motion.delta_rotation = identity_rotation<2>();
    motion.delta_position = {{1.0f, 0.0f}};
    scratch.motions.assign(3, motion);
    scratch.fast_bodies = {{0, false, 0.75f}};
  }

  /// The fraction after which body 1 stops.
  float stop_of_other() {
    spread_stops(context, state, scratch);
    for (const Stop& stop : scratch.stops)
      if (stop.slot == 1) return stop.fraction;
    return 1.0f;
  }
};

TEST(SpreadStops, WhatAJointHoldsStopsThreeSlopsLater) {
  PairThatStops pair;
  EXPECT_NEAR(pair.stop_of_other(), 0.75f + 3.0f * Tuning{}.slop, 1.0e-6f);
  ASSERT_EQ(pair.scratch.stops.size(), 2u);
  EXPECT_EQ(pair.scratch.stops[0].slot, 0u);
  EXPECT_EQ(pair.scratch.stops[0].fraction, 0.75f);
}

TEST(SpreadStops, BothMayBeStoppedAndTheEarlierTakesTheOther) {
  PairThatStops pair;
  pair.scratch.fast_bodies.push_back({1, false, 0.9f});
  EXPECT_NEAR(pair.stop_of_other(), 0.75f + 3.0f * Tuning{}.slop, 1.0e-6f);
  pair.scratch.fast_bodies[1].stop = 0.76f;
  EXPECT_EQ(pair.stop_of_other(), 0.76f);
}

TEST(SpreadStops, AWayThatClosesTheJointIsNotCutShort) {
  PairThatStops pair;
  pair.scratch.joint_rows[0].centre_offset = {{0.5f, 0.0f}};
  EXPECT_EQ(pair.stop_of_other(), 1.0f);
}

TEST(SpreadStops, OnlyWhatHoldsAPointRigidlyAndHasMassStops) {
  PairThatStops sliding;
  sliding.scratch.joint_rows[0].holds_point = false;
  EXPECT_EQ(sliding.stop_of_other(), 1.0f);
  PairThatStops soft;
  soft.scratch.joint_rows[0].is_spring[0] = true;
  EXPECT_EQ(soft.stop_of_other(), 1.0f);
  PairThatStops massless;
  massless.scratch.masses[1].inverse_mass = 0.0f;
  EXPECT_EQ(massless.stop_of_other(), 1.0f);
}

/// The widest gap of a rod of balls, end on end, that comes down on another ball at 60 m/s, m:
/// after the tick in which the lowest is stopped there.
template <int D>
static float widest_gap(int balls) {
  World<D> world = make_world(with_gravity<D>());
  BodyDef<D> below;
  below.kind = BodyKind::kStatic;
  below.position = at<D>(0.0f, -1.0f);
  add(world, below, ball<D>(1.0f));
  std::vector<BodyId> ids;
  JointDef<D> joint;
  for (int i = 0; i < balls; ++i) {
    BodyDef<D> body;
    body.position = at<D>(0.0f, 2.75f + 0.4f * static_cast<float>(i));
    body.velocity = -60.0f * up<D>();
    ids.push_back(add(world, body, ball<D>(0.2f)));
    joint.body_b = ids.back();
    joint.anchor_a = 0.2f * up<D>();
    joint.anchor_b = -0.2f * up<D>();
    const bool is_jointed = i == 0 || world.create_joint(joint).ok();
    EXPECT_TRUE(is_jointed);
    joint.body_a = ids.back();
  }
  step(world, 3);
  EXPECT_NEAR(view(world, ids[0]).position[1], 0.2f, 0.01f);
  float widest = 0.0f;
  for (const Joint<D>& each : world.state().joints) {
    const Body<D>& a = world.state().bodies[each.body_a];
    const Body<D>& b = world.state().bodies[each.body_b];
    widest = max(widest, length((b.position - a.position) + rotate(b.rotation, each.anchor_b) -
                                rotate(a.rotation, each.anchor_a)));
  }
  return widest;
}

TEST(SpreadStops, ARodThatMeetsSomethingKeepsTogether) {
  // Of the metre that it falls in that tick the lowest ball loses a half.
  const float most = 1.01f * 3.0f * Tuning{}.slop;
  EXPECT_LT(widest_gap<2>(2), most);
  EXPECT_LT(widest_gap<3>(2), most);
  EXPECT_LT(widest_gap<2>(12), most);
  EXPECT_LT(widest_gap<3>(12), most);
}

}  // namespace cycloid::solver
