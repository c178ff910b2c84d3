#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

template <class T>
class BothDimensions : public testing::Test {};
template <int N>
struct Dimension {
  static constexpr int kD = N;
};
using Dimensions = testing::Types<Dimension<2>, Dimension<3>>;
TYPED_TEST_SUITE(BothDimensions, Dimensions);

// Symplectic Euler with step h moves g h t / 2 further than the parabola, exactly.
TYPED_TEST(BothDimensions, FreeFallErrorIsThatOfSymplecticEuler) {
  constexpr int D = TypeParam::kD;
  World<D> world = make_world(with_gravity<D>());
  const BodyId id = add_at<D>(world, Vec<D>::zero(), ball<D>(0.5f));
  step(world, 60);
  const float h = kTick / 4.0f;
  EXPECT_NEAR(view(world, id).position[1], -5.0f - 10.0f * h * 0.5f, 2.0e-5f);
  EXPECT_NEAR(view(world, id).velocity[1], -10.0f, 1.0e-5f);
}

TYPED_TEST(BothDimensions, IsolatedPileKeepsItsMomentum) {
  constexpr int D = TypeParam::kD;
  World<D> world = make_world<D>();
  for (int i = 0; i < 12; ++i) {
    BodyDef<D> def;
    def.position[0] = 1.1f * static_cast<float>(i % 4);
    def.position[1] = 1.1f * static_cast<float>(i / 4);
    def.velocity[0] = i % 2 == 0 ? 3.0f : -2.0f;
    def.velocity[1] = 0.5f * static_cast<float>(i % 3);
    add(world, def, ball<D>(0.4f + 0.02f * static_cast<float>(i)));
  }
  // Momentum and angular momentum about the origin, in double.
  const auto momenta = [&] {
    std::array<double, 3> sum{};
    for (const BodyView<D>& body : world.bodies()) {
      const double m = body.mass;
      const float r = 0.4f + 0.02f * static_cast<float>(body.id.index);
      const double inertia = (D == 2 ? 0.5 : 0.4) * m * r * r;
      sum[0] += m * body.velocity[0];
      sum[1] += m * body.velocity[1];
      sum[2] += m * (body.position[0] * body.velocity[1] - body.position[1] * body.velocity[0]) +
                inertia * body.spin[D == 2 ? 0 : 2];
    }
    return sum;
  };
  const auto before = momenta();
  std::uint32_t contacts = 0;
  for (int tick = 0; tick < 120; ++tick) {
    step(world, 1);
    contacts += world.statistics().contacts;
  }
  EXPECT_GT(contacts, 0u);
  const auto after = momenta();
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(before[i], after[i], 1.0e-4) << i;
}

TYPED_TEST(BothDimensions, ElasticBallReturnsToItsHeight) {
  constexpr int D = TypeParam::kD;
  for (const float e : {0.0f, 0.5f, 1.0f}) {
    World<D> world = make_world(with_gravity<D>({0.3f, e}));
    add_ground<D>(world, up<D>());
    Vec<D> start = Vec<D>::zero();
    start[1] = 4.5f;  // The lowest point is 4 m up.
    const BodyId id = add_at<D>(world, start, ball<D>(0.5f));
    step(world, 58);  // Past the first impact at 0.894 s.
    float apex = 0.0f;
    for (int i = 0; i < 60; ++i) {
      step(world, 1);
      apex = std::max(apex, view(world, id).position[1] - 0.5f);
    }
    // e^2 of the height, up to what one tick of fall and the speed gained in it change.
    EXPECT_NEAR(apex, 4.0f * e * e, 0.12f) << "restitution " << e;
  }
}

TYPED_TEST(BothDimensions, SlowImpactDoesNotBounce) {
  constexpr int D = TypeParam::kD;
  World<D> world = make_world(with_gravity<D>({0.3f, 1.0f}));
  add_ground<D>(world, up<D>());
  Vec<D> start = Vec<D>::zero();
  start[1] = 0.52f;  // Arrives at 0.63 m/s, below the threshold of 1 m/s.
  const BodyId id = add_at<D>(world, start, ball<D>(0.5f));
  step(world, 120);
  EXPECT_NEAR(view(world, id).velocity[1], 0.0f, 1.0e-3f);
  EXPECT_NEAR(view(world, id).position[1], 0.5f, 0.01f);
}

TYPED_TEST(BothDimensions, DampingDecaysByImplicitEuler) {
  constexpr int D = TypeParam::kD;
  World<D> world = make_world<D>();
  BodyDef<D> def;
  def.velocity[0] = 1.0f;
  def.linear_damping = 2.0f;
  const BodyId id = add(world, def, ball<D>(0.5f));
  step(world, 60);
  const double h = 1.0 / 240.0;
  EXPECT_NEAR(view(world, id).velocity[0], std::pow(1.0 / (1.0 + h * 2.0), 240.0), 1.0e-5);
}

TYPED_TEST(BothDimensions, ForceActsForOneTickOnly) {
  constexpr int D = TypeParam::kD;
  World<D> world = make_world<D>();
  BodyDef<D> def;
  def.mass = 2.0f;
  const BodyId id = add(world, def, ball<D>(0.5f));
  Vec<D> force = Vec<D>::zero();
  force[0] = 12.0f;
  ASSERT_TRUE(world.apply_force(id, force).ok());
  step(world, 1);
  EXPECT_NEAR(view(world, id).velocity[0], 6.0f * kTick, 1.0e-6f);
  step(world, 5);
  EXPECT_NEAR(view(world, id).velocity[0], 6.0f * kTick, 1.0e-6f);
}

// Ideal pendulum at small amplitude: 2 pi sqrt(L / g) (1 + a^2 / 16).
TYPED_TEST(BothDimensions, PendulumHasItsPeriodOnDistanceAndOnRevoluteJoint) {
  constexpr int D = TypeParam::kD;
  for (const JointKind kind : {JointKind::kDistance, JointKind::kRevolute}) {
    World<D> world = make_world(with_gravity<D>());
    BodyDef<D> anchor;
    anchor.kind = BodyKind::kStatic;
    const BodyId pivot = world.create_body(anchor, {}).value();
    BodyDef<D> bob;
    bob.kind = BodyKind::kDynamic;
    bob.mass = 1.0f;
    bob.fixed_rotation = kind == JointKind::kDistance;
    const float amplitude = 0.2f;
    bob.position[0] = std::sin(amplitude);
    bob.position[1] = -std::cos(amplitude);
    ShapeDef<D> shape = ball<D>(0.01f);  // Nearly a point: 2/5 r^2 is 4e-5 of L^2.
    const BodyId id = add(world, bob, shape);
    JointDef<D> joint;
    joint.kind = kind;
    joint.body_a = pivot;
    joint.body_b = id;
    joint.length = 1.0f;
    if (kind == JointKind::kRevolute)
      for (int i = 0; i < D; ++i) joint.anchor_b[i] = -bob.position[i];
    ASSERT_TRUE(world.create_joint(joint).ok());
    int crossings = 0;
    double first = 0.0;
    double last = 0.0;
    float before = bob.position[0];
    for (int tick = 1; tick <= 1200; ++tick) {
      step(world, 1);
      const float x = view(world, id).position[0];
      if ((x < 0.0f) != (before < 0.0f)) {
        const double at = (tick - 1 + double{before} / (double{before} - double{x})) / 60.0;
        if (crossings++ == 0) first = at;
        last = at;
      }
      before = x;
    }
    const double period = 2.0 * (last - first) / (crossings - 1);
    const double ideal = 2.0 * 3.14159265358979 * std::sqrt(0.1) * (1.0 + 0.04 / 16.0);
    EXPECT_NEAR(period, ideal, 0.005 * ideal) << (kind == JointKind::kDistance ? "rope" : "pin");
  }
}

TEST(Slope, BoxSticksBelowTheAngleOfFrictionAndSlidesAboveIt) {
  const float theta = 0.25f;  // tan = 0.2553
  const Vec<2> normal = {{-std::sin(theta), std::cos(theta)}};
  for (const float mu : {0.0f, 0.1f, 0.2f, 0.25f, 0.26f, 0.4f}) {
    // At friction 0.25 it starts so slowly that it would fall asleep.
    WorldDef<2> restless = with_gravity<2>({mu, 0.0f});
    restless.tuning.sleep_s = 0.0f;
    World<2> world = make_world(restless);
    add_ground<2>(world, normal);
    BodyDef<2> def;
    def.position = 0.5f * normal;
    def.rotation = turned(theta);
    const BodyId id = add(world, def, box(0.5f, 0.5f));
    step(world, 30);
    const float v0 = length(view(world, id).velocity);
    step(world, 60);
    const float acceleration = length(view(world, id).velocity) - v0;
    const float sliding = 10.0f * (std::sin(theta) - mu * std::cos(theta));
    EXPECT_NEAR(acceleration, std::max(sliding, 0.0f), 0.01f) << "mu " << mu;
    if (sliding < 0.0f) {
      EXPECT_LT(length(view(world, id).velocity), 1.0e-3f);
    }
  }
}

// A rolling solid ball without slip accelerates at 5/7 g sin theta, a disc at 2/3.
TYPED_TEST(BothDimensions, BallRollsDownASlopeWithItsInertia) {
  constexpr int D = TypeParam::kD;
  const float theta = 0.25f;
  Vec<D> normal = Vec<D>::zero();
  normal[0] = -std::sin(theta);
  normal[1] = std::cos(theta);
  World<D> world = make_world(with_gravity<D>({1.0f, 0.0f}));
  add_ground<D>(world, normal);
  const BodyId id = add_at<D>(world, 0.5f * normal, ball<D>(0.5f));
  step(world, 30);
  const float v0 = length(view(world, id).velocity);
  step(world, 60);
  const float share = D == 2 ? 2.0f / 3.0f : 5.0f / 7.0f;
  const float expected = share * 10.0f * std::sin(theta);
  EXPECT_NEAR(length(view(world, id).velocity) - v0, expected, 0.01f * expected);
}

TEST(Stack, TenBoxesStandForAMinute) {
  WorldDef<2> restless = with_gravity<2>();
  restless.tuning.sleep_s = 0.0f;
  World<2> world = make_world(restless);
  add_ground<2>(world, up<2>());
  std::vector<BodyId> boxes;
  for (int i = 0; i < 10; ++i)
    boxes.push_back(add_at<2>(world, {{0.0f, 0.5f + static_cast<float>(i)}}, box(0.5f, 0.5f)));
  step(world, 3600);
  EXPECT_NEAR(view(world, boxes.back()).position[1], 9.5f, 0.1f);
  EXPECT_NEAR(view(world, boxes.back()).position[0], 0.0f, 0.02f);
  EXPECT_LT(length(view(world, boxes.back()).velocity), 0.01f);
}

TEST(Stack, ThreeBoxesStandUnderBaumgarteToo) {
  WorldDef<2> def = with_gravity<2>();
  def.tuning = Tuning::pgs();
  World<2> world = make_world(def);
  add_ground<2>(world, up<2>());
  BodyId top;
  for (int i = 0; i < 3; ++i)
    top = add_at<2>(world, {{0.0f, 0.5f + static_cast<float>(i)}}, box(0.5f, 0.5f));
  step(world, 600);
  EXPECT_NEAR(view(world, top).position[1], 2.5f, 0.03f);
  EXPECT_LT(length(view(world, top).velocity), 0.02f);
}

TEST(Motor, ReachesItsSpeedAtItsTorqueAndHoldsTheLimit) {
  World<2> world = make_world<2>();
  BodyDef<2> base;
  base.kind = BodyKind::kStatic;
  const BodyId a = world.create_body(base, {}).value();
  const BodyId b = add_at<2>(world, {{0.0f, 0.0f}}, box(0.5f, 0.5f));  // 1 kg, I = 1/6.
  JointDef<2> joint;
  joint.body_a = a;
  joint.body_b = b;
  joint.motor = MotorKind::kSpeed;
  joint.motor_speed = 2.0f;
  joint.motor_max = 1.0f;
  const JointId id = world.create_joint(joint).value();
  step(world, 10);  // w = torque t / I = 1 rad/s after 1/6 s.
  EXPECT_NEAR(view(world, b).spin[0], 1.0f, 1.0e-3f);
  step(world, 20);
  EXPECT_NEAR(view(world, b).spin[0], 2.0f, 1.0e-3f);

  ASSERT_TRUE(world.set_limits(id, true, -0.5f, world.joint_angle(id).value() + 0.2f).ok());
  const float stop = world.joint_angle(id).value() + 0.2f;
  step(world, 120);
  EXPECT_NEAR(world.joint_angle(id).value(), stop, 0.01f);
  EXPECT_NEAR(view(world, b).spin[0], 0.0f, 1.0e-3f);
}

TEST(Particle, HasNoRotationAndKeepsItsMass) {
  World<2> world = make_world(with_gravity<2>());
  add_ground<2>(world, up<2>());
  BodyDef<2> def;
  def.kind = BodyKind::kParticle;
  def.mass = 3.0f;
  def.position = {{0.0f, 0.6f}};
  def.velocity = {{4.0f, 0.0f}};
  const BodyId id = add(world, def, ball<2>(0.1f));
  step(world, 120);
  EXPECT_EQ(view(world, id).spin[0], 0.0f);
  EXPECT_EQ(view(world, id).mass, 3.0f);
  EXPECT_NEAR(view(world, id).position[1], 0.1f, 0.01f);
}

TEST(Kinematic, CarriesWhatRestsOnItAndIsNotPushed) {
  World<2> world = make_world(with_gravity<2>({1.0f, 0.0f}));
  BodyDef<2> belt;
  belt.kind = BodyKind::kKinematic;
  belt.velocity = {{1.0f, 0.0f}};
  const BodyId carrier = add(world, belt, box(5.0f, 0.5f));
  const BodyId load = add_at<2>(world, {{0.0f, 1.0f}}, box(0.5f, 0.5f));
  step(world, 120);
  EXPECT_NEAR(view(world, carrier).position[0], 2.0f, 1.0e-4f);
  EXPECT_EQ(view(world, carrier).position[1], 0.0f);
  EXPECT_NEAR(view(world, load).velocity[0], 1.0f, 1.0e-3f);
}

}  // namespace cycloid::solver
