#include "tests/solver/particle_fixture.hpp"
#include "tests/solver/query_3d_fixture.hpp"

namespace cycloid::solver {

static void expect_distance(const Shape<3>& shape, Vec<3> point, float distance, Vec<3> normal,
                            const Polyhedra& pools = {}) {
  const Pose<3> pose{{{7, -3, 2}}, turned_about({{0, 1, 0}}, 1.1f)};
  const SignedDistance<3> found =
      signed_distance(shape, pose, pose.position + rotate(pose.rotation, point), pools);
  EXPECT_NEAR(found.distance, distance, 2e-6f);
  const Vec<3> local = rotate_back(pose.rotation, found.normal);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(local[i], normal[i], 4e-6f) << "axis " << i;
}

TEST(SolidDistance, IsThatOfTheNearestFeature) {
  const Shape<3> rod = solid_capsule({{0, 0, 0}}, {{2, 0, 0}}, 0.5f);
  expect_distance(rod, {{1, 3, 4}}, 4.5f, {{0, 0.6f, 0.8f}});
  expect_distance(rod, {{5, 0, 4}}, 4.5f, {{0.6f, 0, 0.8f}});
  expect_distance(rod, {{1, 0.1f, 0}}, -0.4f, {{0, 1, 0}});
  const Shape<3> box = solid_box({{1, 2, 3}}, {{1, 0, 0}});
  expect_distance(box, {{5, 1, 1}}, 3, {{1, 0, 0}});
  expect_distance(box, {{1, -5, 7}}, 5, {{0, -0.6f, 0.8f}});
  expect_distance(box, {{4, 4, 4}}, 3, {{2 / 3.0f, 2 / 3.0f, 1 / 3.0f}});
  expect_distance(box, {{1.8f, 0, 0}}, -0.2f, {{1, 0, 0}});
  expect_distance(box, {{1, 0, -2.9f}}, -0.1f, {{0, 0, -1}});
  const Shape<3> turned =
      solid_box({{1, 1, 1}}, {{0, 0, 0}}, turned_about({{0, 0, 1}}, 0.78539816f));
  expect_distance(turned, {{0, 3, 0}}, 3 - std::sqrt(2.0f), {{0, 1, 0}});
  const Shape<3> floor = solid_triangle({{-1, 0, -1}}, {{-1, 0, 1}}, {{1, 0, 0}});
  expect_distance(floor, {{0, 2, 0}}, 2, {{0, 1, 0}});
  expect_distance(floor, {{0, -2, 0}}, -2, {{0, 1, 0}});
  expect_distance(floor, {{-4, -4, 0}}, 5, {{-0.6f, -0.8f, 0}});
  expect_distance(floor, {{4, 0, 0}}, 3, {{1, 0, 0}});
  Polyhedra pools;
  const Shape<3> octahedron = solid_hull(
      {{{2, 0, 0}}, {{-2, 0, 0}}, {{0, 2, 0}}, {{0, -2, 0}}, {{0, 0, 2}}, {{0, 0, -2}}}, pools);
  const float r = std::sqrt(1 / 3.0f);
  expect_distance(octahedron, {{0, 3, 0}}, 1, {{0, 1, 0}}, pools);
  expect_distance(octahedron, {{2, 2, 2}}, 4 * r, {{r, r, r}}, pools);
  expect_distance(octahedron, {{2, 2, 0}}, std::sqrt(2.0f), {{std::sqrt(0.5f), std::sqrt(0.5f), 0}},
                  pools);
  expect_distance(octahedron, {{0.1f, 0.2f, 0.3f}}, -1.4f * r, {{r, r, r}}, pools);
}

TEST(SolidDistance, AgreesWithDoublePrecisionAndIsConvex) {
  std::mt19937 random(3);
  int inside = 0;
  for (int i = 0; i < 10000; ++i) {
    Polyhedra pools;
    const Vec<3> half = {
        {uniform(random, 0.02f, 1), uniform(random, 0.02f, 1), uniform(random, 0.02f, 1)}};
    Shape<3> shape = solid_box(half, random_vector(random, 0.3f), random_rotation(random));
    if (i % 3 == 1) shape = solid_hull(random_corners(random, 4 + i % 13, half), pools);
    if (i % 3 == 2) shape = solid_capsule(random_vector(random, 1), random_vector(random, 1), 0.2f);
    const Pose<3> pose{random_vector(random, 0.3f), random_rotation(random)};
    const Vec<3> x = random_vector(random, i % 2 == 0 ? 0.4f : 1.2f);
    const Vec<3> y = random_vector(random, 1.2f);
    const SignedDistance<3> at_x = signed_distance(shape, pose, x, pools);
    const SignedDistance<3> at_y = signed_distance(shape, pose, y, pools);
    WideCore point;
    point.points = {wide(x)};
    const double wanted =
        wide_separation(wide_core(core_of(shape, pose.rotation, pose.position, pools)), point) -
        shape.radius;
    if (wanted < 0) ++inside;
    ASSERT_NEAR(at_x.distance, wanted, 2e-6) << i;
    ASSERT_NEAR(length(at_x.normal), 1, 1e-5f) << i;
    ASSERT_GE(at_y.distance, at_x.distance + dot(at_x.normal, y - x) - 4e-6f) << i;
  }
  EXPECT_GT(inside, 500);
}

static ShapeDef<3> block(Vec<3> half) {
  ShapeDef<3> shape;
  shape.kind = ShapeKind::kBox;
  shape.half = half;
  return shape;
}

TEST(ParticlesOnSolids, StopAtThinBoxesAtAnySpeed) {
  for (const float speed : {10.0f, 500.0f, 5000.0f}) {
    ParticleScene<3> scene;
    BodyDef<3> def;
    def.kind = BodyKind::kStatic;
    def.rotation = turned_about({{0, 0, 1}}, 0.3f);
    add(scene.world, def, block({{20, 0.01f, 20}}));
    for (int i = 0; i < 20; ++i) {
      const std::uint32_t id =
          scene.add_particle({{0.3f * static_cast<float>(i) - 3, 6, 0.1f * static_cast<float>(i)}});
      scene.particles[id].velocity = {{0, -speed, 0}};
      scene.particles[id].radius = i % 2 == 0 ? 0.0f : 0.05f;
    }
    const Vec<3> normal = rotate(def.rotation, {{0, 1, 0}});
    for (int tick = 0; tick < 60; ++tick) {
      scene.run(1);
      for (const Particle<3>& particle : scene.particles)
        ASSERT_GT(dot(normal, particle.position), 0.01f + particle.radius - 1e-4f) << speed;
    }
  }
}

TEST(ParticlesOnSolids, ARopeHangsOverABoxAndOverACapsule) {
  for (const ShapeKind kind : {ShapeKind::kBox, ShapeKind::kCapsule}) {
    ParticleScene<3> scene;
    BodyDef<3> def;
    def.kind = BodyKind::kStatic;
    ShapeDef<3> shape = block({{0.3f, 0.3f, 2}});
    if (kind == ShapeKind::kCapsule) {
      shape.kind = kind;
      shape.points = {{{0, 0, -2}}, {{0, 0, 2}}};
      shape.radius = 0.3f;
    }
    add(scene.world, def, shape);
    scene.add_rope({{-1.5f, 0.5f, 0.1f}}, 31, 0.1f);
    for (Particle<3>& particle : scene.particles) particle.radius = 0.02f;
    scene.run(240);
    const Shape<3>& placed = scene.world.state().shapes[0];
    float lowest = 9;
    for (const Particle<3>& particle : scene.particles) {
      const SignedDistance<3> gap =
          signed_distance(placed, Pose<3>{{{0, 0, 0}}, identity_rotation<3>()}, particle.position);
      ASSERT_GT(gap.distance, 0.02f - 2e-3f);
      ASSERT_TRUE(std::isfinite(particle.position[0]));
      lowest = std::min(lowest, particle.position[1]);
    }
    // Both ends hang down, and the middle lies on top.
    EXPECT_NEAR(scene.particles[15].position[1], 0.32f, 0.01f);
    EXPECT_LT(lowest, -0.5f);
  }
}

}  // namespace cycloid::solver
