#include <gtest/gtest.h>

#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

static WorldDef<3> rough(float friction) {
  WorldDef<3> def = with_gravity<3>({friction, 0.0f, 0.0f});
  def.tuning.sleep_s = 0.0f;
  return def;
}

// A pyramid of two intervals would slow a body by up to sqrt(2) more along its diagonal.
TEST(FrictionCone, SlowsASlidingBodyEquallyIn16Directions) {
  constexpr double kPi = 3.14159265358979;
  for (int i = 0; i < 16; ++i) {
    const double angle = 2.0 * kPi * i / 16.0;
    World<3> world = make_world(rough(0.3f));
    add_ground<3>(world, up<3>());
    BodyDef<3> def;
    def.kind = BodyKind::kParticle;
    def.mass = 1.0f;
    def.position = {{0.0f, 0.5f, 0.0f}};
    def.velocity = {{static_cast<float>(6.0 * std::cos(angle)), 0.0f,
                     static_cast<float>(6.0 * std::sin(angle))}};
    const BodyId id = add(world, def, ball<3>(0.5f));
    step(world, 60);
    const Vec<3> velocity = view(world, id).velocity;
    EXPECT_NEAR(length(velocity), 3.0f, 0.03f) << i;
    const double turned_by =
        std::remainder(std::atan2(double{velocity[2]}, double{velocity[0]}) - angle, 2.0 * kPi);
    EXPECT_NEAR(turned_by, 0.0, 0.01) << i;
  }
}

struct ConeSetting {
  const char* name;
  Tuning tuning;
};

static std::vector<ConeSetting> cone_settings() {
  Tuning block = Tuning::soft_step();
  block.contact_block = ContactBlockRows::kNormals;
  Tuning coupled = Tuning::soft_step();
  coupled.contact_block = ContactBlockRows::kNormalFriction;
  return {{"soft_step", Tuning::soft_step()},
          {"soft_step, normals together", block},
          {"soft_step, normal and friction together", coupled},
          {"pgs", Tuning::pgs()},
          {"split_impulse", Tuning::split_impulse()},
          {"pgs_ngs_block", Tuning::pgs_ngs_block()},
          {"tgs_ngs", Tuning::tgs_ngs()}};
}

/// What a body slides like after a second, in units of its start.
struct Slide {
  double lost;    ///< Speed, m/s.
  double aside;   ///< Of the way.
  double turned;  ///< Spin about the vertical, rad/s.
};

static Slide slide(const Tuning& tuning, const ShapeDef<3>& shape, double angle, float speed) {
  WorldDef<3> def = rough(0.3f);
  def.tuning = tuning;
  def.tuning.sleep_s = 0.0f;
  World<3> world = make_world(def);
  add_ground<3>(world, up<3>());
  BodyDef<3> body;
  body.position = {{0.0f, shape.half[1], 0.0f}};
  const Vec<3> along = {
      {static_cast<float>(std::cos(angle)), 0.0f, static_cast<float>(std::sin(angle))}};
  body.velocity = speed * along;
  const BodyId id = add(world, body, shape);
  step(world, 60);
  const BodyView<3> now = view(world, id);
  const Vec<3> across = cross(along, up<3>());
  const double way = double{dot(now.position - body.position, along)};
  return {double{speed - dot(now.velocity, along)},
          std::abs(double{dot(now.position - body.position, across)}) / way,
          std::abs(double{now.spin[1]})};
}

// A flat box stays flat while its corners' friction, at its height below the centre, loads the
// front: the four points slide as one, at mu g, and straight on.
TEST(FrictionCone, SlowsASlidingBoxEquallyIn16DirectionsAndStraightOn) {
  constexpr double kPi = 3.14159265358979;
  for (const ConeSetting& setting : cone_settings())
    for (const Vec<3>& half : {Vec<3>{{0.5f, 0.5f, 0.5f}}, Vec<3>{{0.8f, 0.2f, 0.4f}}})
      for (int i = 0; i < 16; ++i) {
        ShapeDef<3> shape;
        shape.kind = ShapeKind::kBox;
        shape.half = half;
        const Slide now = slide(setting.tuning, shape, 2.0 * kPi * i / 16.0, 6.0f);
        EXPECT_NEAR(now.lost, 3.0, 0.03) << setting.name << " " << i << " " << half[0];
        EXPECT_LT(now.aside, 0.01) << setting.name << " " << i << " " << half[0];
        EXPECT_LT(now.turned, 0.05) << setting.name << " " << i << " " << half[0];
      }
}

/// Velocity along the ground after a spinning ball has come down on it at 5 m/s: after two ticks it
/// is a millimetre away, as its bounce acts where it then is.
template <int D>
static float speed_after_bounce(const Tuning& tuning, float friction, float restitution) {
  WorldDef<D> world_def;
  world_def.tuning = tuning;
  world_def.materials = {{friction, restitution}};
  World<D> world = make_world(world_def);
  add_ground<D>(world, up<D>());
  BodyDef<D> def;
  def.position[1] = 0.201f + 2.0f * 5.0f * kTick;
  def.velocity[1] = -5.0f;
  def.spin[Dim<D>::kSpin - 1] = -100.0f;
  const BodyId id = add(world, def, ball<D>(0.2f));
  step(world, 10);
  EXPECT_NEAR(view(world, id).velocity[1], 5.0f * restitution, 0.01f);
  return view(world, id).velocity[0];
}

// While it slips, friction has mu times the impulse of the whole collision, and no more than stops
// the slip: then it rolls, with a third of 20 m/s in the plane and 2/7 in space.
TEST(FrictionCone, ABallThatSpinsBouncesAwayAtItsShareOfTheWholeImpulse) {
  for (const ConeSetting& setting : cone_settings())
    for (const float restitution : {0.5f, 1.0f}) {
      const float slipping = 0.2f * (1.0f + restitution) * 5.0f;
      EXPECT_NEAR(speed_after_bounce<2>(setting.tuning, 0.2f, restitution), slipping, 0.01f)
          << setting.name << " in the plane, " << restitution;
      EXPECT_NEAR(speed_after_bounce<3>(setting.tuning, 0.2f, restitution), slipping, 0.01f)
          << setting.name << " in space, " << restitution;
      EXPECT_NEAR(speed_after_bounce<2>(setting.tuning, 2.0f, restitution), 20.0f / 3.0f, 0.03f)
          << setting.name << " in the plane, " << restitution;
      EXPECT_NEAR(speed_after_bounce<3>(setting.tuning, 2.0f, restitution), 40.0f / 7.0f, 0.03f)
          << setting.name << " in space, " << restitution;
    }
}

/// Speed of a ball that is thrown sliding, once it rolls.
template <int D>
static float rolling_speed() {
  WorldDef<D> def = with_gravity<D>({0.2f, 0.0f, 0.0f});
  def.tuning.sleep_s = 0.0f;
  World<D> world = make_world(def);
  add_ground<D>(world, up<D>());
  BodyDef<D> thrown;
  thrown.position = 0.5f * up<D>();
  thrown.velocity[0] = 5.0f;
  const BodyId id = add(world, thrown, ball<D>(0.5f));
  step(world, 120);
  return view(world, id).velocity[0];
}

// Friction turns the ball until nothing slips: v = v0 / (1 + I / (m r^2)).
TEST(FrictionCone, ABowlingBallRollsAtFiveSeventhsAndADiscAtTwoThirds) {
  EXPECT_NEAR(rolling_speed<3>(), 5.0f * 5.0f / 7.0f, 0.01f);
  EXPECT_NEAR(rolling_speed<2>(), 5.0f * 2.0f / 3.0f, 0.01f);
}

/// A dumbbell of two balls of 1 kg and a light one across, so that its three moments differ.
static BodyId add_tumbler(World<3>& world) {
  std::vector<ShapeDef<3>> shapes;
  const auto part = [&](Vec<3> at, float radius, float density) {
    ShapeDef<3> shape = ball<3>(radius);
    shape.points = {at};
    shape.density = density;
    shapes.push_back(shape);
  };
  part({{0.6f, 0.0f, 0.0f}}, 0.2f, 100.0f);
  part({{-0.6f, 0.0f, 0.0f}}, 0.2f, 100.0f);
  part({{0.0f, 0.35f, 0.0f}}, 0.2f, 60.0f);
  BodyDef<3> def;
  def.spin = {{0.02f, 5.0f, 0.02f}};
  const Result<BodyId> id = world.create_body(def, shapes);
  EXPECT_TRUE(id.ok());
  return id.value();
}

static Vec<3> angular_momentum(const Body<3>& body) {
  return rotate(body.rotation, body.inertia * rotate_back(body.rotation, body.spin));
}

// Without a gyroscopic term it never tumbles; with an explicit one it gains energy.
TEST(FreeTumbling, KeepsAngularMomentumAndEnergyForAMinute) {
  WorldDef<3> def;
  def.tuning.sleep_s = 0.0f;
  World<3> world = make_world(def);
  const BodyId id = add_tumbler(world);
  const Body<3>& body = world.state().bodies[id.index];
  const Vec<3> momentum = angular_momentum(body);
  const float energy = 0.5f * dot(momentum, body.spin);
  float least = 1.0f;
  float most = -1.0f;
  for (int tick = 0; tick < 3600; ++tick) {
    step(world, 1);
    const Body<3>& now = world.state().bodies[id.index];
    const Vec<3> axis = rotate(now.rotation, Vec<3>{{0.0f, 1.0f, 0.0f}});
    least = std::min(least, axis[1]);
    most = std::max(most, axis[1]);
    ASSERT_LT(length(angular_momentum(now) - momentum), 1.0e-3f * length(momentum)) << tick;
    ASSERT_NEAR(0.5f * dot(angular_momentum(now), now.spin), energy, 1.0e-3f * energy) << tick;
  }
  EXPECT_GT(most, 0.9f);
  EXPECT_LT(least, 0.9f);
}

}  // namespace cycloid::solver
