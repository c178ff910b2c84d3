#include "tests/solver/particle_fixture.hpp"

namespace cycloid::solver {

template <int D>
SignedDistance<D> distance_from(const ShapeDef<D>& def, Vec<D> point, Vec<D> position = {},
                                Rotation<D> rotation = identity_rotation<D>()) {
  World<D> world = make_world<D>();
  BodyDef<D> body;
  body.kind = BodyKind::kStatic;
  add(world, body, def);
  return signed_distance(world.state().shapes[0], Pose<D>{position, rotation}, point);
}

template <int D>
void expect_signed_distance(const SignedDistance<D>& found, float distance, float normal_x,
                            float normal_y) {
  EXPECT_NEAR(found.distance, distance, 1.0e-6f);
  EXPECT_NEAR(found.normal[0], normal_x, 1.0e-6f);
  EXPECT_NEAR(found.normal[1], normal_y, 1.0e-6f);
}

TYPED_TEST(Particles, DistanceToBallAndHalfSpace) {
  constexpr int D = TypeParam::kD;
  expect_signed_distance(distance_from(ball<D>(2.0f), at<D>(3.0f, 4.0f)), 3.0f, 0.6f, 0.8f);
  expect_signed_distance(distance_from(ball<D>(2.0f), at<D>(0.0f, -0.5f)), -1.5f, 0.0f, -1.0f);
  expect_signed_distance(distance_from(ball<D>(2.0f), Vec<D>::zero()), -2.0f, 1.0f, 0.0f);
  ShapeDef<D> plane;
  plane.kind = ShapeKind::kHalfSpace;
  plane.normal = at<D>(0.6f, 0.8f);
  plane.offset = 1.0f;
  expect_signed_distance(distance_from(plane, at<D>(3.0f, 4.0f)), 4.0f, 0.6f, 0.8f);
  expect_signed_distance(distance_from(plane, at<D>(-3.0f, -4.0f)), -6.0f, 0.6f, 0.8f);
  expect_signed_distance(distance_from(plane, at<D>(3.0f, 4.0f), at<D>(3.0f, 4.0f)), -1.0f, 0.6f,
                         0.8f);
}

TEST(ShapeDistance, ToPolygonInsideOutsideAndAtCorners) {
  ShapeDef<2> shape = box(2.0f, 1.0f);
  shape.radius = 0.25f;
  expect_signed_distance(distance_from(shape, {{0.5f, 3.0f}}), 1.75f, 0.0f, 1.0f);
  expect_signed_distance(distance_from(shape, {{1.5f, 0.0f}}), -0.75f, 1.0f, 0.0f);
  expect_signed_distance(distance_from(shape, {{5.0f, 5.0f}}), 4.75f, 0.6f, 0.8f);
  expect_signed_distance(distance_from(shape, {{-5.0f, -5.0f}}), 4.75f, -0.6f, -0.8f);
  // The two long edges are as near: edge 0, the lower one, has the say.
  expect_signed_distance(distance_from(shape, {{0.0f, 0.0f}}), -1.25f, 0.0f, -1.0f);
  // Turned by a quarter and moved, the short side is up.
  expect_signed_distance(distance_from(shape, {{7.0f, 3.0f}}, {{7.0f, 0.0f}}, {{0.0f, 1.0f}}),
                         0.75f, 0.0f, 1.0f);
}

// A sharp triangle and a blunt pentagon, against the least distance over all edges.
TEST(ShapeDistance, ToPolygonIsTheLeastOverItsEdges) {
  const std::vector<Vec<2>> triangle = {{{0.0f, 0.0f}}, {{4.0f, -0.2f}}, {{4.0f, 0.4f}}};
  const std::vector<Vec<2>> pentagon = {
      {{0.0f, -2.0f}}, {{2.0f, -1.5f}}, {{2.5f, 0.5f}}, {{0.5f, 1.5f}}, {{-1.0f, 0.0f}}};
  ShapeDef<2> shape;
  shape.kind = ShapeKind::kPolygon;
  for (int i = 0; i < 2 * 81 * 81; ++i) {
    shape.points = i % 2 == 0 ? triangle : pentagon;
    const Vec<2> point = {{0.1f * float(i / 2 % 81) - 4.0f, 0.05f * float(i / 162) - 2.0f}};
    float nearest = 1.0e9f;
    bool inside = true;
    for (std::size_t k = 0; k < shape.points.size(); ++k) {
      const Vec<2> a = shape.points[k];
      const Vec<2> edge = shape.points[(k + 1) % shape.points.size()] - a;
      const float t = clamp(dot(point - a, edge) / dot(edge, edge), 0.0f, 1.0f);
      nearest = std::min(nearest, length(point - (a + t * edge)));
      inside = inside && cross(edge, point - a) > 0.0f;
    }
    EXPECT_NEAR(distance_from(shape, point).distance, inside ? -nearest : nearest, 5.0e-6f);
  }
}

TEST(ShapeDistance, ToCapsuleOnAllSides) {
  const ShapeDef<2> shape = capsule(2.0f, 0.5f);
  expect_signed_distance(distance_from(shape, {{1.0f, 3.0f}}), 2.5f, 0.0f, 1.0f);
  expect_signed_distance(distance_from(shape, {{1.0f, -0.25f}}), -0.25f, 0.0f, -1.0f);
  expect_signed_distance(distance_from(shape, {{5.0f, 4.0f}}), 4.5f, 0.6f, 0.8f);
  expect_signed_distance(distance_from(shape, {{-9.0f, 0.0f}}), 6.5f, -1.0f, 0.0f);
  expect_signed_distance(distance_from(shape, {{0.0f, 0.0f}}), -0.5f, 0.0f, -1.0f);  // Edge 0.
}

TEST(ShapeDistance, ToChainEdgeIsOneSided) {
  ShapeDef<2> shape;
  shape.kind = ShapeKind::kChain;
  shape.points = {{{0.0f, 0.0f}}, {{4.0f, 0.0f}}};  // Solid to the right: below.
  expect_signed_distance(distance_from(shape, {{1.0f, 2.0f}}), 2.0f, 0.0f, 1.0f);
  expect_signed_distance(distance_from(shape, {{1.0f, -9.0f}}), -9.0f, 0.0f, 1.0f);
  expect_signed_distance(distance_from(shape, {{7.0f, 4.0f}}), 5.0f, 0.6f, 0.8f);
  expect_signed_distance(distance_from(shape, {{-3.0f, -4.0f}}), 5.0f, -0.6f, -0.8f);
}

TYPED_TEST(Particles, RopeOverBallDoesNotPenetrate) {
  constexpr int D = TypeParam::kD;
  ParticleScene<D> scene;
  add_obstacle(scene, ball<D>(0.5f));
  scene.add_rope(at<D>(-1.0f, 0.7f), 41, 0.05f);
  for (int tick = 0; tick < 120; ++tick) {
    scene.run(1);
    EXPECT_GT(scene.clearance(), -0.001f);
  }
  EXPECT_LT(scene.stretch(), 0.02f);
  EXPECT_LT(scene.particles[0].position[1], 0.0f);              // It hangs down on both sides,
  EXPECT_NEAR(scene.particles[20].position[1], 0.51f, 0.001f);  // and lies on top.
}

TEST(ParticleCollision, RopeOverBoxDoesNotPenetrate) {
  ParticleScene<2> scene;
  add_obstacle(scene, box(0.5f, 0.5f), {{0.0f, 0.0f}}, turned(0.2f));
  scene.add_rope(at<2>(-1.0f, 0.9f), 41, 0.05f);
  for (int tick = 0; tick < 120; ++tick) {
    scene.run(1);
    EXPECT_GT(scene.clearance(), -0.001f);
  }
  EXPECT_LT(scene.particles[40].position[1], 0.3f);
}

// tan(angle) = 0.75: a particle sticks for mu above it and else slides at g (sin - mu cos).
TYPED_TEST(Particles, SlopeHoldsOrLetsSlideByCoulomb) {
  constexpr int D = TypeParam::kD;
  for (const float distance : {0.0f, 50.0f})
    for (const float mu : {0.0f, 0.3f, 0.5f, 0.7f, 0.8f, 1.5f}) {
      ParticleScene<D> scene;
      scene.world = make_world<D>(with_gravity<D>({mu, 0.0f}));
      add_ground<D>(scene.world, at<D>(-0.6f, 0.8f));  // Downhill is (-0.8, -0.6).
      const Vec<D> start = at<D>(-0.8f * distance - 0.006f, -0.6f * distance + 0.008f);
      scene.add_particle(start);
      scene.run(60);
      const float moved = length(scene.particles[0].position - start);
      const float acceleration = 10.0f * (0.6f - mu * 0.8f);
      if (mu > 0.75f) {
        EXPECT_LT(moved, 1.0e-4f) << mu;
        continue;
      }
      EXPECT_NEAR(moved, 0.5f * acceleration, 0.01f * acceleration) << mu << " " << distance;
      EXPECT_NEAR(length(scene.particles[0].velocity), acceleration, 0.02f * acceleration);
    }
}

// It meets the ground half-way through the substep, and friction would take more than there is.
TYPED_TEST(Particles, OneThatLandsAndSticksHasNotMovedAlongTheGround) {
  constexpr int D = TypeParam::kD;
  ParticleScene<D> scene;
  add_ground<D>(scene.world, up<D>());
  scene.gravity = Vec<D>::zero();
  scene.tuning.substeps = 1;
  scene.add_particle(at<D>(0.0f, 0.01f + 5.0f * kTick));
  scene.particles[0].velocity = at<D>(1.0f, -10.0f);
  scene.run(1);
  EXPECT_NEAR(scene.particles[0].position[0], 0.0f, 1.0e-8f);
  EXPECT_NEAR(scene.particles[0].position[1], 0.01f, 2.0e-6f);
}

TYPED_TEST(Particles, NothingPassesAGroundAtAnySpeed) {
  constexpr int D = TypeParam::kD;
  for (const float speed : {1.0f, 30.0f, 1000.0f}) {
    ParticleScene<D> scene;
    add_ground<D>(scene.world, up<D>());
    scene.add_particle(at<D>(0.0f, 3.0f));
    scene.particles[0].velocity = at<D>(speed, -speed);
    scene.run(60);
    EXPECT_NEAR(scene.particles[0].position[1], 0.01f, 1.0e-5f);
  }
}

TEST(ParticleCollision, NothingPassesAThinWallAtAnySpeed) {
  ShapeDef<2> edge;
  edge.kind = ShapeKind::kChain;
  edge.points = {{{0.0f, -50.0f}}, {{0.0f, 0.0f}}, {{0.0f, 50.0f}}};  // Free to the left.
  ShapeDef<2> rod = capsule(50.0f, 0.01f);
  rod.points = {{{0.0f, -50.0f}}, {{0.0f, 50.0f}}};
  for (const ShapeDef<2>& wall : {box(0.01f, 50.0f), rod, edge})
    for (int i = 0; i < 200; ++i) {
      ParticleScene<2> scene;
      scene.gravity = Vec<2>::zero();
      add_obstacle(scene, wall);
      scene.add_rope({{-1.0f - 0.013f * static_cast<float>(i), 0.0f}}, 2, 0.5f);
      for (Particle<2>& p : scene.particles) p.velocity = {{1000.0f - 5.0f * float(i), 7.0f}};
      scene.run(6);
      for (const Particle<2>& p : scene.particles) EXPECT_LT(p.position[0], 0.0f) << i;
    }
}

TEST(ParticleCollision, ChainLetsThroughFromBehind) {
  ParticleScene<2> scene;
  scene.gravity = Vec<2>::zero();
  ShapeDef<2> edge;
  edge.kind = ShapeKind::kChain;
  edge.points = {{{0.0f, -5.0f}}, {{0.0f, 5.0f}}};  // Free to the left.
  add_obstacle(scene, edge);
  scene.add_particle({{1.0f, 0.0f}});
  scene.add_particle({{0.005f, 0.0f}});
  scene.particles[0].velocity = {{-6.0f, 0.0f}};
  scene.particles[1].velocity = {{6.0f, 0.0f}};
  scene.run(30);
  EXPECT_NEAR(scene.particles[0].position[0], -2.0f, 1.0e-4f);
  EXPECT_NEAR(scene.particles[1].position[0], 3.005f, 1.0e-4f);
}

// A room of walls 0.02 m thick, turned and 300 m away, with a rope whose particles fly apart.
TEST(ParticleCollision, RopeStaysInARoomOfThinWalls) {
  ParticleScene<2> scene;
  const Rotation<2> rotation = turned(0.4f);
  const Vec<2> middle = {{300.0f, -200.0f}};
  for (int side = 0; side < 4; ++side) {
    const float sign = side % 2 == 0 ? 1.0f : -1.0f;
    const Vec<2> wall = side < 2 ? Vec<2>{{sign, 0.0f}} : Vec<2>{{0.0f, sign}};
    add_obstacle(scene, side < 2 ? box(0.01f, 1.01f) : box(1.01f, 0.01f),
                 middle + rotate(rotation, wall), rotation);
  }
  scene.add_rope(middle - at<2>(0.5f, 0.0f), 21, 0.05f);
  for (int tick = 0; tick < 120; ++tick) {
    for (std::size_t i = 0; tick % 20 == 0 && i < 21; ++i)
      scene.particles[i].velocity =
          rotate(turned(static_cast<float>(7 * i) + static_cast<float>(tick)), {{1000.0f, 0.0f}});
    scene.run(1);
    for (const Particle<2>& p : scene.particles) {
      const Vec<2> local = rotate_back(rotation, p.position - middle);
      EXPECT_LT(std::max(std::abs(local[0]), std::abs(local[1])), 0.9805f) << tick;
    }
  }
}

TYPED_TEST(Particles, LiftTakesAParticleAlongAtItsOwnSpeed) {
  constexpr int D = TypeParam::kD;
  ParticleScene<D> scene;
  BodyDef<D> lift;
  lift.kind = BodyKind::kKinematic;
  lift.velocity = at<D>(0.0f, 4.0f);
  add(scene.world, lift, ball<D>(1.0f));
  scene.add_particle(at<D>(0.0f, 1.01f));
  for (int tick = 0; tick < 60; ++tick) {
    step(scene.world, 1);
    scene.run(1);
    EXPECT_NEAR(scene.particles[0].velocity[1], 4.0f, 0.01f) << tick;
    EXPECT_NEAR(scene.clearance(), 0.0f, 1.0e-4f);
  }
}

// Friction mu = 0.6 brings a particle up to the speed of a belt within v / (mu g) = 0.33 s.
TYPED_TEST(Particles, BeltTakesAParticleAlong) {
  constexpr int D = TypeParam::kD;
  ParticleScene<D> scene;
  BodyDef<D> belt;
  belt.kind = BodyKind::kKinematic;
  belt.velocity = at<D>(2.0f, 0.0f);
  ShapeDef<D> shape = ball<D>(100.0f);
  shape.points = {at<D>(0.0f, -100.0f)};
  add(scene.world, belt, shape);
  scene.add_particle(at<D>(0.0f, 0.01f));
  for (int tick = 0; tick < 60; ++tick) {
    step(scene.world, 1);
    scene.run(1);
    const float expected = std::min(6.0f * kTick * static_cast<float>(tick + 1), 2.0f);
    EXPECT_NEAR(scene.particles[0].velocity[0], expected, 0.03f) << tick;
  }
  EXPECT_NEAR(scene.particles[0].velocity[0], 2.0f, 0.02f);
}

TYPED_TEST(Particles, FilterLetsThrough) {
  constexpr int D = TypeParam::kD;
  ParticleScene<D> scene;
  add_ground<D>(scene.world, up<D>());
  scene.add_particle(at<D>(0.0f, 1.0f));
  scene.particles[0].filter.mask = 2;
  scene.run(60);
  EXPECT_LT(scene.particles[0].position[1], -3.9f);
}

}  // namespace cycloid::solver
