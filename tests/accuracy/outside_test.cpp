#include <span>

#include "bench/accuracy/measure.hpp"
#include "bench/accuracy/observer.hpp"
#include "scenes/catalogue.hpp"
#include "tests/accuracy/worlds.hpp"

namespace cycloid::accuracy {

using solver::BodyKind;
using solver::JointDef;
using solver::JointKind;
using solver::World;

/// What is said of two bodies that nothing but each other, and maybe a joint, holds.
static Metrics metrics_of(const solver::BodyDef<2>& second, const JointDef<2>* joint) {
  World<2> world = empty_world<2>();
  const solver::BodyId a = add_box(world, -2.0f, 0.0f);
  solver::ShapeDef<2> ball;
  ball.radius = 0.5f;
  const solver::BodyId b = world.create_body(second, std::span(&ball, 1)).value();
  if (joint != nullptr) {
    JointDef<2> between = *joint;
    between.body_a = a;
    between.body_b = b;
    const auto made = world.create_joint(between);
    EXPECT_TRUE(made.ok()) << made.error().field;
  }
  Observer<2> observer(world.state(), 1, false, {});
  EXPECT_TRUE(observer.look(world.state(), 1));
  return observer.finish(world.state());
}

static Metrics metrics_of(const JointDef<2>& joint) {
  solver::BodyDef<2> ball;
  ball.position = {{2.0f, 0.0f}};
  return metrics_of(ball, &joint);
}

// A blow beside the middle would turn it, were it not held; angular momentum goes there.
TEST(MomentumDrift, IsNotSaidOfTurnsWhereABodyDoesNotTurn) {
  solver::BodyDef<2> second;
  second.position = {{2.0f, 0.0f}};
  Metrics metrics = metrics_of(second, nullptr);
  EXPECT_TRUE(metrics.momentum_drift && metrics.angular_momentum_drift);
  second.fixed_rotation = true;
  metrics = metrics_of(second, nullptr);
  EXPECT_TRUE(metrics.momentum_drift.has_value());
  EXPECT_FALSE(metrics.angular_momentum_drift.has_value());
  second.fixed_rotation = false;
  second.kind = BodyKind::kParticle;
  second.mass = 1.0f;
  metrics = metrics_of(second, nullptr);
  EXPECT_TRUE(metrics.momentum_drift.has_value());
  EXPECT_FALSE(metrics.angular_momentum_drift.has_value());
}

TEST(MomentumDrift, IsNotSaidWhereAJointStandsOnTheWorld) {
  JointDef<2> pulley;
  pulley.kind = JointKind::kPulley;
  pulley.ground_a = {{-2.0f, 4.0f}};
  pulley.ground_b = {{2.0f, 4.0f}};
  Metrics metrics = metrics_of(pulley);
  EXPECT_FALSE(metrics.momentum_drift || metrics.angular_momentum_drift);
  JointDef<2> gear;
  gear.kind = JointKind::kGear;
  metrics = metrics_of(gear);
  EXPECT_TRUE(metrics.momentum_drift.has_value()) << "wheels that turn each other push nobody";
  EXPECT_FALSE(metrics.angular_momentum_drift.has_value());
  gear.axis = {{1.0f, 0.0f}};
  metrics = metrics_of(gear);
  EXPECT_FALSE(metrics.momentum_drift || metrics.angular_momentum_drift);
  metrics = metrics_of(JointDef<2>{});
  EXPECT_TRUE(metrics.momentum_drift && metrics.angular_momentum_drift) << "a pin";
}

TEST(EnergyGained, IsNoShareWhereASpringMayBringItIn) {
  JointDef<2> rod;
  rod.kind = JointKind::kDistance;
  rod.length = 4.0f;
  EXPECT_TRUE(metrics_of(rod).energy_gained_share.has_value());
  rod.hertz = 4.0f;
  EXPECT_FALSE(metrics_of(rod).energy_gained_share.has_value());
  JointDef<2> weld;
  weld.kind = JointKind::kWeld;
  weld.angular_hertz = 4.0f;
  EXPECT_FALSE(metrics_of(weld).energy_gained_share.has_value());
}

// Who sits there and does nothing brings nothing in.
TEST(Subjects, AreActedOnByScriptsAndCharacters) {
  Subject subject{scenes::find("half-pipe").scene.value(), 60, nullptr};
  EXPECT_TRUE(is_acted_on(subject));
  for (scenes::Seat& seat : subject.scene.seats) seat.script.clear();
  EXPECT_FALSE(subject.scene.seats.empty());
  EXPECT_FALSE(is_acted_on(subject));
  subject.scene.characters.emplace_back();
  EXPECT_TRUE(is_acted_on(subject));
}

}  // namespace cycloid::accuracy
