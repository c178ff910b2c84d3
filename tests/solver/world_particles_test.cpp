#include <gtest/gtest.h>

#include <limits>

#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

template <int D>
static ParticleId add_particle(World<D>& world, const Vec<D>& position, float mass = 0.1f) {
  ParticleDef<D> def;
  def.position = position;
  def.mass = mass;
  const Result<ParticleId> id = world.create_particle(def);
  EXPECT_TRUE(id.ok()) << id.error().field;
  return id.ok() ? id.value() : ParticleId{};
}

template <int D>
static LinkId link(World<D>& world, ParticleId a, ParticleId b, float length) {
  const Result<LinkId> id = world.create_link({a, b, length, 0.0f});
  EXPECT_TRUE(id.ok()) << id.error().field;
  return id.ok() ? id.value() : LinkId{};
}

/// A rope of `count` particles from a pin on a static body, and a ball that falls on it.
struct Rope {
  World<2> world = make_world(with_gravity<2>());
  BodyId post;
  std::vector<ParticleId> particles;
  std::vector<LinkId> links;
  PinId pin;

  explicit Rope(int count) {
    add_ground<2>(world, up<2>());
    BodyDef<2> fixed;
    fixed.kind = BodyKind::kStatic;
    fixed.position = {{0.0f, 2.0f}};
    post = world.create_body(fixed, {}).value();
    for (int i = 0; i < count; ++i)
      particles.push_back(add_particle<2>(world, {{0.1f * static_cast<float>(i), 2.0f}}));
    for (std::size_t i = 0; i + 1 < particles.size(); ++i)
      links.push_back(link(world, particles[i], particles[i + 1], 0.1f));
    pin = world.create_pin({particles[0], post, {{0.0f, 0.0f}}}).value();
  }
};

TEST(WorldParticles, ARopeSwingsFromItsPinAndItsStateGoesRoundThroughBytes) {
  Rope rope(10);
  step(rope.world, 60);
  std::vector<std::byte> bytes;
  rope.world.encode(bytes);
  World<2> other = make_world<2>();
  ASSERT_TRUE(other.decode(bytes).ok());
  WorldState<2> saved;
  rope.world.save(saved);
  for (int tick = 0; tick < 120; ++tick) {
    step(rope.world, 1);
    step(other, 1);
    ASSERT_EQ(rope.world.digest(), other.digest()) << tick;
  }
  const std::uint64_t end = rope.world.digest();
  rope.world.restore(saved);
  step(rope.world, 120);
  EXPECT_EQ(rope.world.digest(), end);
  const auto& particles = rope.world.state().particles;
  EXPECT_NEAR(particles[0].position[1], 2.0f, 1.0e-5f);
  for (std::size_t i = 0; i + 1 < particles.size(); ++i)
    EXPECT_NEAR(length(particles[i + 1].position - particles[i].position), 0.1f, 0.002f);
}

TEST(WorldParticles, TruncatedBytesAndBrokenReferencesAreRefused) {
  Rope rope(4);
  std::vector<std::byte> bytes;
  rope.world.encode(bytes);
  World<2> other = make_world<2>();
  const std::uint64_t before = other.digest();
  for (std::size_t size = 0; size < bytes.size(); size += 7)
    EXPECT_FALSE(other.decode(std::span(bytes.data(), size)).ok());
  WorldState<2> state = rope.world.state();
  const auto refuses = [&](const char* what, auto&& spoil) {
    WorldState<2> broken = state;
    spoil(broken);
    World<2> from = make_world<2>();
    from.restore(broken);
    std::vector<std::byte> encoded;
    from.encode(encoded);
    EXPECT_FALSE(other.decode(encoded).ok()) << what;
  };
  refuses("link to nowhere",
          [](auto& s) { s.links.edit([](auto& links) { links[0].particle_b = 77; }); });
  refuses("link to itself", [](auto& s) {
    s.links.edit([](auto& links) { links[0].particle_b = links[0].particle_a; });
  });
  refuses("pin to nobody", [](auto& s) { s.pins[0].body = 77; });
  refuses("no radius", [](auto& s) { s.particles[0].radius = 0.0f; });
  refuses("no such material", [](auto& s) { s.particles[0].material = 9; });
  refuses("not finite",
          [](auto& s) { s.particles[0].velocity[0] = std::numeric_limits<float>::quiet_NaN(); });
  EXPECT_EQ(other.digest(), before);
}

TEST(WorldParticles, DestroyedOnesTakeTheirLinksAndPinsWithThem) {
  Rope rope(5);
  ASSERT_TRUE(rope.world.destroy_particle(rope.particles[2]).ok());
  EXPECT_EQ(rope.world.state().free_links.size(), 2u);
  EXPECT_EQ(rope.world.destroy_particle(rope.particles[2]).code, Code::kUnknownId);
  EXPECT_EQ(rope.world.destroy_link(rope.links[1]).code, Code::kUnknownId);
  ASSERT_TRUE(rope.world.destroy_body(rope.post).ok());
  EXPECT_EQ(rope.world.destroy_pin(rope.pin).code, Code::kUnknownId);
  step(rope.world, 180);
  for (const Particle<2>& particle : rope.world.state().particles)
    if (particle.kind != 0) {
      EXPECT_NEAR(particle.position[1], 0.01f, 2.0e-3f);
    }
  const ParticleId again = add_particle<2>(rope.world, {{0.0f, 1.0f}});
  EXPECT_EQ(again.index, rope.particles[2].index);
  EXPECT_NE(again.generation, rope.particles[2].generation);
}

TEST(WorldParticles, EachMistakeIsRefusedByItsField) {
  Rope rope(3);
  const std::uint64_t before = rope.world.digest();
  const auto expect = [&](const char* field, auto&& spoil) {
    ParticleDef<2> def;
    spoil(def);
    const auto id = rope.world.create_particle(def);
    ASSERT_FALSE(id.ok()) << field;
    EXPECT_STREQ(id.error().field, field);
  };
  const float nan = std::numeric_limits<float>::quiet_NaN();
  expect("position", [&](auto& d) { d.position[0] = nan; });
  expect("velocity", [&](auto& d) { d.velocity[1] = nan; });
  expect("mass", [](auto& d) { d.mass = -1.0f; });
  expect("radius", [](auto& d) { d.radius = 0.0f; });
  expect("material", [](auto& d) { d.material = 3; });
  const auto field_of = [](const auto& result) { return std::string(result.error().field); };
  const ParticleId a = rope.particles[0];
  EXPECT_EQ(field_of(rope.world.create_link({a, a, 1.0f, 0.0f})), "particle_b");
  EXPECT_EQ(field_of(rope.world.create_link({a, {99, 0}, 1.0f, 0.0f})), "particle_b");
  EXPECT_EQ(field_of(rope.world.create_link({a, rope.particles[1], nan, 0.0f})), "length");
  EXPECT_EQ(field_of(rope.world.create_link({a, rope.particles[1], 1.0f, -1.0f})), "compliance");
  EXPECT_EQ(field_of(rope.world.create_pin({a, {99, 0}, {}})), "body");
  EXPECT_EQ(rope.world.digest(), before);
}

TEST(WorldParticles, OneThatLeavesTheBoundsFaultsTheWorldAndUndoesTheTick) {
  WorldDef<2> def;
  World<2> world = make_world(def);
  const BodyId body = add_at<2>(world, {{0.0f, 0.0f}}, ball<2>(0.5f));
  ASSERT_TRUE(world.set_velocity(body, {{1.0f, 0.0f}}, {{0.0f}}).ok());
  // It begins to touch this one in the tick in which the particle goes too far.
  add_at<2>(world, {{0.999f, 0.0f}}, ball<2>(0.5f));
  ParticleDef<2> fast;
  fast.position = {{9.9999e6f, 0.0f}};
  fast.velocity = {{9.0e4f, 0.0f}};
  ASSERT_TRUE(world.create_particle(fast).ok());
  Error error;
  int ticks = 0;
  WorldState<2> before;
  while (error.ok() && ticks++ < 100) {
    world.save(before);
    error = world.step();
  }
  EXPECT_EQ(error.code, Code::kFaulted);
  EXPECT_STREQ(error.field, "particle");
  EXPECT_EQ(ticks, 1);
  EXPECT_TRUE(world.contact_events().empty()) << "nothing of the tick is told";
  EXPECT_EQ(view(world, body).position[0], before.bodies[0].position[0]);
  ASSERT_TRUE(world.fault().has_value());
  EXPECT_EQ(world.fault()->tick, world.tick() + 1);
}

// An over-constrained net of pins: loops without end, heavy, fixed at two corners. Whatever the
// method, impulses stay bounded, or the world says in which tick they did not.
// Farther in one tick than anything may move by itself.
TEST(WorldParticles, OneThatIsHeldGoesWhereverItsBodyIsPut) {
  Rope rope(5);
  step(rope.world, 10);
  const Vec<2> away = {{4000.0f, 3000.0f}};
  ASSERT_TRUE(rope.world.set_pose(rope.post, away, identity_rotation<2>()).ok());
  step(rope.world, 1);
  const Particle<2>& held = rope.world.state().particles[rope.particles[0].index];
  EXPECT_NEAR(length(held.position - away), 0.0f, 1.0e-3f);
  step(rope.world, 600);
  EXPECT_LT(length(rope.world.state().particles[rope.particles[4].index].position - away), 1.0f);
}

TEST(Overconstrained, AGridOfPinsStaysBoundedOrFaultsByName) {
  const auto run = [](const Tuning& tuning, float& fastest) {
    WorldDef<2> def = with_gravity<2>();
    def.tuning = tuning;
    def.tuning.sleep_s = 0.0f;
    World<2> world = make_world(def);
    constexpr int kSide = 10;
    std::vector<BodyId> grid;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        BodyDef<2> body;
        body.position = {{static_cast<float>(x), -static_cast<float>(y)}};
        if (y == 0 && (x == 0 || x == kSide - 1)) body.kind = BodyKind::kStatic;
        ShapeDef<2> shape = ball<2>(0.2f);
        shape.filter.group = -1;
        grid.push_back(add(world, body, shape));
      }
    const auto pin = [&](int a, int b, Vec<2> anchor) {
      JointDef<2> joint;
      joint.body_a = grid[static_cast<std::size_t>(a)];
      joint.body_b = grid[static_cast<std::size_t>(b)];
      joint.anchor_a = 0.5f * anchor;
      joint.anchor_b = -0.5f * anchor;
      EXPECT_TRUE(world.create_joint(joint).ok());
    };
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        if (x + 1 < kSide) pin(y * kSide + x, y * kSide + x + 1, {{1.0f, 0.0f}});
        if (y + 1 < kSide) pin(y * kSide + x, (y + 1) * kSide + x, {{0.0f, -1.0f}});
      }
    Error error;
    for (int tick = 0; tick < 300 && error.ok(); ++tick) error = world.step();
    fastest = 0.0f;
    for (const auto& body : world.bodies()) fastest = std::max(fastest, length(body.velocity));
    return error;
  };
  float fastest = 0.0f;
  EXPECT_TRUE(run(Tuning::soft_step(), fastest).ok());
  EXPECT_LT(fastest, 5.0f);
  Tuning direct = Tuning::soft_step();
  direct.joint_solver = JointSolver::kDirect;
  for (const Tuning& tuning :
       {direct, Tuning::pgs(), Tuning::split_impulse(), Tuning::pgs_ngs(), Tuning::pgs_ngs_block(),
        Tuning::pgs_soft(), Tuning::tgs_ngs(), Tuning::xpbd()}) {
    const Error error = run(tuning, fastest);
    if (error.ok()) {
      EXPECT_LT(fastest, 1.0e5f);
    } else {
      EXPECT_EQ(error.code, Code::kFaulted);
      EXPECT_STRNE(error.field, "");
    }
  }
}

}  // namespace cycloid::solver
