#include <cstring>

#include "solver/constraints/joints/joints.hpp"
#include "solver/trig.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// Pins, hinges and cones in lanes against the same rows solved one by one. A user's kind is solved
/// as a row by itself: registered with the rows of a built-in kind it must do the same, to the bit.

constexpr std::uint32_t kUserKind = 3;

template <int D>
struct Scenario {
  const char* name;
  JointKind kind;
  RowsFunction<D> rows;
  bool motor;
  bool limits;
  float cone;
};

/// How a chain's bodies move at the start: so that some limits are met soon and others never.
template <int D>
static BodyDef<D> link_at(int chain, int link) {
  BodyDef<D> body;
  body.position = at<D>(0.5f + static_cast<float>(link), 3.0f * static_cast<float>(chain));
  body.mass = 1.0f + 0.25f * static_cast<float>(link);
  for (int i = 0; i < Dim<D>::kSpin; ++i)
    body.spin[i] = 0.7f * static_cast<float>((chain + i) % 5 - 2);
  body.fixed_rotation = chain % 6 == 5 && link == 2;
  return body;
}

template <int D>
static JointDef<D> joint_between(const Scenario<D>& scenario, bool by_user, int chain) {
  JointDef<D> def;
  def.kind = by_user ? JointKind::kUser : scenario.kind;
  def.user_kind = by_user ? kUserKind : 0;
  def.anchor_a = at<D>(0.5f, 0.0f);
  def.anchor_b = at<D>(-0.5f, 0.0f);
  if constexpr (D == 3) def.axis = {{0.6f, 0.0f, 0.8f}};
  def.limit_enabled = scenario.limits;
  def.lower = -0.2f - 0.3f * static_cast<float>(chain % 4);
  def.upper = 0.1f + 0.4f * static_cast<float>(chain % 3);
  def.cone = scenario.cone;
  if (scenario.motor) def.motor = MotorKind::kSpeed;
  def.motor_speed = static_cast<float>(chain % 3) - 0.5f;
  def.motor_max = 4.0f;
  return def;
}

/// Chains of five links that hang from the ground; more than one block of any width, and one that
/// is not full.
template <int D>
static World<D> make_chains(const Scenario<D>& scenario, bool by_user, int lanes) {
  World<D> world = make_world(with_gravity<D>());
  EXPECT_TRUE(world.set_lanes(lanes).ok());
  world.register_constraint(kUserKind, scenario.rows);
  for (int chain = 0; chain < 21; ++chain) {
    BodyDef<D> anchor;
    anchor.kind = BodyKind::kStatic;
    anchor.position = at<D>(-0.5f, 3.0f * static_cast<float>(chain));
    BodyId last = add(world, anchor, ball<D>(0.1f));
    for (int link = 0; link < 5; ++link) {
      const BodyId next = add(world, link_at<D>(chain, link), ball<D>(0.2f));
      JointDef<D> def = joint_between(scenario, by_user, chain);
      def.body_a = last;
      def.body_b = next;
      EXPECT_TRUE(world.create_joint(def).ok()) << scenario.name;
      last = next;
    }
  }
  return world;
}

template <int D>
static bool same_motion(const World<D>& one, const World<D>& other) {
  const auto& a = one.state().bodies;
  const auto& b = other.state().bodies;
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

template <int D>
static std::vector<Scenario<D>> scenarios();
template <>
std::vector<Scenario<2>> scenarios<2>() {
  const JointKind pin = JointKind::kRevolute;
  return {{"pin", pin, &revolute_rows<2>, false, false, 0.0f},
          {"motor", pin, &revolute_rows<2>, true, false, 0.0f},
          {"limits", pin, &revolute_rows<2>, false, true, 0.0f},
          {"motor and limits", pin, &revolute_rows<2>, true, true, 0.0f}};
}
template <>
std::vector<Scenario<3>> scenarios<3>() {
  const JointKind hinge = JointKind::kHinge;
  const JointKind cone = JointKind::kConeTwist;
  return {{"ball", JointKind::kRevolute, &revolute_rows<3>, false, false, 0.0f},
          {"hinge", hinge, &hinge_rows<3>, false, false, 0.0f},
          {"hinge with motor", hinge, &hinge_rows<3>, true, false, 0.0f},
          {"hinge with limits", hinge, &hinge_rows<3>, false, true, 0.0f},
          {"hinge with both", hinge, &hinge_rows<3>, true, true, 0.0f},
          {"cone", cone, &cone_twist_rows<3>, false, true, 0.5f},
          {"twist alone", cone, &cone_twist_rows<3>, false, true, kPi},
          {"cone without limits", cone, &cone_twist_rows<3>, false, false, 0.5f}};
}

template <int D>
static void expect_as_single_rows() {
  for (const Scenario<D>& scenario : scenarios<D>()) {
    World<D> in_lanes = make_chains(scenario, false, 0);
    World<D> by_user = make_chains(scenario, true, 0);
    for (int tick = 0; tick < 240; ++tick) {
      step(in_lanes, 1);
      step(by_user, 1);
      ASSERT_TRUE(same_motion(in_lanes, by_user)) << scenario.name << ", tick " << tick;
    }
  }
}

TEST(Pins, MoveAsTheSameRowsOneByOneInThePlane) {
  expect_as_single_rows<2>();
}
TEST(Pins, MoveAsTheSameRowsOneByOneInSpace) {
  expect_as_single_rows<3>();
}

/// All scenarios in one world, so that blocks of every form stand beside one another; cones rub.
template <int D>
static World<D> make_mixture(int lanes) {
  World<D> world = make_world(with_gravity<D>());
  EXPECT_TRUE(world.set_lanes(lanes).ok());
  add_ground(world, up<D>());
  int chain = 0;
  for (int repeat = 0; repeat < 5; ++repeat)
    for (const Scenario<D>& scenario : scenarios<D>()) {
      BodyId last{};
      for (int link = 0; link < 4; ++link) {
        BodyDef<D> body = link_at<D>(chain, link);
        body.position[1] = 0.3f + 0.9f * static_cast<float>(chain);
        const BodyId next = add(world, body, ball<D>(0.2f));
        JointDef<D> def = joint_between(scenario, false, chain);
        def.body_a = last;
        def.body_b = next;
        if (scenario.cone > 0.0f) def.torque_max = 0.5f * static_cast<float>(chain % 3);
        if (link > 0) {
          EXPECT_TRUE(world.create_joint(def).ok()) << scenario.name;
        }
        last = next;
      }
      ++chain;
    }
  return world;
}

template <int D>
static void expect_equal_in_lanes() {
  for (const int lanes : {4, 8, 16, 0}) {
    World<D> wide = make_mixture<D>(lanes);
    World<D> single = make_mixture<D>(1);
    for (int tick = 0; tick < 200; ++tick) {
      step(wide, 1);
      step(single, 1);
      ASSERT_EQ(wide.digest(), single.digest()) << lanes << " lanes, tick " << tick;
    }
  }
}

TEST(Pins, DoNotShowInHowManyLanesTheyAreSolved) {
  expect_equal_in_lanes<2>();
  expect_equal_in_lanes<3>();
}

}  // namespace cycloid::solver
