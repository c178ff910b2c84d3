#include <gtest/gtest.h>

#include "tests/solver/joint_scene.hpp"

namespace cycloid::solver {

/// A ladder of balls that fall and swing, whose joints each share a body with two or three others:
/// in another order of the joints every tick ends in other bits.
struct Ladder : Scene<2> {
  explicit Ladder(const Tuning& tuning) : Scene<2>(tuning) {
    for (int i = 0; i < 8; ++i) {
      balls.push_back(add_ball(at<2>(static_cast<float>(i / 2), i % 2 == 0 ? 0.0f : -1.0f), 1.0f));
      if (i >= 1) pin(i - 1, i);
      if (i >= 2) pin(i - 2, i);
    }
    pin(anchor, balls[0]);
  }
  void pin(int a, int b) {
    pin(balls[static_cast<std::size_t>(a)], balls[static_cast<std::size_t>(b)]);
  }
  /// Where the second one is.
  void pin(BodyId a, BodyId b) {
    JointDef<2> def = joint(JointKind::kRevolute, a, b);
    def.anchor_a = view(world, b).position - view(world, a).position;
    pins.push_back(create(def));
  }
  void set_order(Order order) {
    Tuning tuning = world.tuning();
    tuning.order = order;
    ASSERT_TRUE(world.set_tuning(tuning).ok());
  }
  /// What a world that has never stepped comes to from here.
  std::uint64_t digest_after_a_fresh_step() const {
    World<2> fresh = make_world<2>();
    fresh.restore(world.state());
    step(fresh, 1);
    return fresh.digest();
  }

  std::vector<BodyId> balls;
  std::vector<JointId> pins;
};

/// What is done to a ladder before a tick.
static void change(int tick, Ladder& ladder) {
  World<2>& world = ladder.world;
  Error error;
  if (tick == 5) error = world.destroy_joint(ladder.pins[3]);
  if (tick == 10) ladder.pin(0, 7);  // In the slot of the one that is gone.
  if (tick == 15) ladder.set_order(Order::kReverse);
  if (tick == 20) ladder.set_order(Order::kColor);
  if (tick == 25) error = world.destroy_joint(ladder.pins.back());
  if (tick == 25) ladder.pin(1, 6);  // As many joints in the same slots, of other bodies.
  if (tick == 30) error = world.destroy_body(ladder.balls[4]);
  if (tick == 35) error = world.set_mass(ladder.balls[5], 40.0f);
  EXPECT_TRUE(error.ok()) << error.field;
}

TEST(JointColors, AreThoseOfAFreshWorldWhateverHasChanged) {
  for (const Tuning& tuning : {Tuning::soft_step(), Tuning{}}) {
    Ladder ladder(tuning);
    for (int tick = 0; tick < 50; ++tick) {
      change(tick, ladder);
      const std::uint64_t fresh = ladder.digest_after_a_fresh_step();
      step(ladder.world, 1);
      ASSERT_EQ(ladder.world.digest(), fresh) << "tick " << tick;
    }
  }
}

/// A heavy ball on a chain of light ones, which is solved at once: what its island holds is known
/// by the places of its joints.
struct LoadedChain : Ladder {
  LoadedChain() : Ladder(awake()) {
    BodyId above = anchor;
    for (int i = 1; i <= 6; ++i) {
      const float mass = i < 6 ? 1.0f : 500.0f;
      const BodyId link = add_ball(at<2>(10.0f + static_cast<float>(i), 0.0f), mass);
      pin(above, link);
      above = link;
    }
  }
  static Tuning awake() {
    Tuning tuning;
    tuning.sleep_s = 0.0f;
    return tuning;
  }
};

TEST(JointColors, AreWhatIslandsFindTheirJointsBy) {
  LoadedChain chain;
  for (int tick = 0; tick < 60; ++tick) {
    constexpr Order kOrders[] = {Order::kColor, Order::kReverse, Order::kColor, Order::kId};
    if (tick % 5 == 0) chain.set_order(kOrders[tick / 5 % 4]);
    const std::uint64_t fresh = chain.digest_after_a_fresh_step();
    step(chain.world, 1);
    ASSERT_EQ(chain.world.digest(), fresh) << "tick " << tick;
  }
  // Soft sweeps would leave it centimetres: it was solved at once.
  EXPECT_LT(chain.error(chain.pins.back()), 1.0e-3f);
}

TEST(JointColors, MatterToTheBitsOfALadder) {
  Ladder by_color(Tuning::soft_step());
  Ladder in_reverse(Tuning::soft_step());
  in_reverse.set_order(Order::kReverse);
  step(by_color.world, 1);
  step(in_reverse.world, 1);
  in_reverse.set_order(Order::kColor);
  EXPECT_NE(by_color.world.digest(), in_reverse.world.digest());
}

}  // namespace cycloid::solver
