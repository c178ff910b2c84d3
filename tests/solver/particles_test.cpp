#include "tests/solver/particle_fixture.hpp"

namespace cycloid::solver {

TYPED_TEST(Particles, LinkSharesItsErrorByInverseMassAndLeavesNone) {
  constexpr int D = TypeParam::kD;
  for (const float weight : {0.0f, 0.25f, 1.0f, 3.0f}) {
    ParticleScene<D> scene;
    scene.add_particle(at<D>(0.0f, 0.0f), weight);
    scene.add_particle(at<D>(3.0f, 4.0f));
    scene.add_link(0, 1, 3.0f);
    std::vector<ParticleMotion<D>> motions(2, {Vec<D>::zero(), Vec<D>::zero(), 1.0f});
    motions[0].inverse_mass = weight;
    std::vector<float> lambdas(1);
    project_links<D>(kTick, scene.particles, scene.links, motions, lambdas);
    const float share = weight / (weight + 1.0f);  // Of an error of 2 m.
    EXPECT_NEAR(length(motions[0].displacement), 2.0f * share, 1.0e-6f);
    EXPECT_NEAR(length(motions[1].displacement), 2.0f * (1.0f - share), 1.0e-6f);
    const Vec<D> d = at<D>(3.0f, 4.0f) + motions[1].displacement - motions[0].displacement;
    EXPECT_NEAR(length(d), 3.0f, 1.0e-6f);
  }
}

TYPED_TEST(Particles, FallLikeSymplecticEulerAlsoFarFromTheOrigin) {
  constexpr int D = TypeParam::kD;
  for (const float far : {0.0f, 4096.0f}) {
    ParticleScene<D> scene;
    scene.tuning.substeps = 4;
    scene.add_particle(at<D>(far, far));
    scene.run(60);
    const float h = kTick / static_cast<float>(scene.tuning.substeps);
    // x(t) = g t^2 / 2 + g h t / 2. At 4 km a place of a float is 0.5 mm.
    EXPECT_NEAR(scene.particles[0].position[1] - far, -5.0f - 5.0f * h, far > 0.0f ? 1e-2f : 2e-5f);
    EXPECT_NEAR(scene.particles[0].velocity[1], -10.0f, 1.0e-4f);
  }
}

TYPED_TEST(Particles, VelocityIsDisplacementPerTime) {
  constexpr int D = TypeParam::kD;
  ParticleScene<D> scene;
  scene.tuning.substeps = 1;
  scene.add_particle(Vec<D>::zero(), 0.0f);
  scene.add_particle(Vec<D>::zero());
  scene.add_link(0, 1, 0.7f);  // Coincident: parts along axis 0, bent by gravity.
  scene.run(1);
  for (int i = 0; i < D; ++i)
    EXPECT_EQ(scene.particles[1].velocity[i], scene.particles[1].position[i] / kTick);
  EXPECT_GT(length(scene.particles[1].velocity), 1.0f);
}

TYPED_TEST(Particles, CoincidentOnesPartAlongTheFirstAxis) {
  constexpr int D = TypeParam::kD;
  ParticleScene<D> scene;
  scene.gravity = Vec<D>::zero();
  scene.add_particle(at<D>(1.0f, 1.0f));
  scene.add_particle(at<D>(1.0f, 1.0f));
  scene.add_link(0, 1, 0.5f);
  scene.tuning.substeps = 1;
  scene.run(1);
  EXPECT_FLOAT_EQ(scene.particles[0].position[0], 0.75f);
  EXPECT_FLOAT_EQ(scene.particles[1].position[0], 1.25f);
  EXPECT_EQ(scene.particles[1].position[1], 1.0f);
}

// 20 by 20 with spacing 0.05 m; the upper row is pinned. In 3D it starts level and swings.
TYPED_TEST(Particles, HangingClothStretchesByLessThanOnePercent) {
  constexpr int D = TypeParam::kD;
  for (const float gravity : {10.0f, 100.0f}) {
    ParticleScene<D> scene;
    scene.gravity[1] = -gravity;
    for (int row = 0; row < 20; ++row)
      for (int column = 0; column < 20; ++column) {
        Vec<D> position = at<D>(0.05f * static_cast<float>(column), 0.0f);
        position[D - 1] = -0.05f * static_cast<float>(row);
        const auto id = scene.add_particle(position, row == 0 ? 0.0f : 1.0f);
        if (column > 0) scene.add_link(id - 1, id, 0.05f);
        if (row > 0) scene.add_link(id - 20, id, 0.05f);
      }
    scene.run(120);
    EXPECT_LT(scene.stretch(), 0.01f) << gravity;
    EXPECT_LT(scene.particles[399].position[1], -0.3f);
    for (int column = 0; column < 20; ++column)
      EXPECT_EQ(scene.particles[static_cast<std::size_t>(column)].position[1], 0.0f);
  }
}

TYPED_TEST(Particles, SwingingChainStretchesByLessThanOnePercent) {
  constexpr int D = TypeParam::kD;
  ParticleScene<D> scene;
  scene.add_rope(at<D>(0.0f, 5.0f), 20, 0.05f);
  scene.particles[0].inverse_mass = 0.0f;
  scene.run(120);
  EXPECT_LT(scene.stretch(), 0.01f);
  EXPECT_EQ(scene.particles[0].position[1], 5.0f);
}

// A spring of compliance a carries m g at the length m g a.
TYPED_TEST(Particles, CompliantLinkHangsAtItsForceTimesCompliance) {
  constexpr int D = TypeParam::kD;
  ParticleScene<D> scene;
  scene.tuning.damping = 5.0f;
  scene.add_particle(Vec<D>::zero(), 0.0f);
  scene.add_particle(at<D>(0.0f, -1.0f), 0.5f);
  scene.add_link(0, 1, 1.0f, 0.01f);
  scene.run(300);
  EXPECT_NEAR(scene.particles[1].position[1], -1.0f - 2.0f * 10.0f * 0.01f, 1.0e-3f);
}

TYPED_TEST(Particles, FreeRopeKeepsItsMomentum) {
  constexpr int D = TypeParam::kD;
  ParticleScene<D> scene;
  scene.gravity = Vec<D>::zero();
  scene.add_rope(Vec<D>::zero(), 30, 0.1f);
  double before[D] = {};
  for (std::size_t i = 0; i < 30; ++i) {
    Particle<D>& p = scene.particles[i];
    p.inverse_mass = i % 3 == 0 ? 0.2f : 1.5f;
    p.velocity[0] = i % 2 == 0 ? 3.0f : -1.0f;
    p.velocity[1] = 0.3f * static_cast<float>(i);
    for (int k = 0; k < D; ++k) before[k] += p.velocity[k] / p.inverse_mass;
  }
  scene.run(120);
  for (int k = 0; k < D; ++k) {
    double after = 0.0;
    for (const Particle<D>& p : scene.particles) after += p.velocity[k] / p.inverse_mass;
    EXPECT_NEAR(after, before[k], 1.0e-3) << k;  // Of some 300 kg m/s.
  }
}

TYPED_TEST(Particles, PinFollowsItsBodyAndTheLowestPinHolds) {
  constexpr int D = TypeParam::kD;
  ParticleScene<D> scene;
  const BodyId id = add_at<D>(scene.world, at<D>(1.0f, 2.0f), ball<D>(0.1f));
  ASSERT_TRUE(scene.world.set_gravity(Vec<D>::zero()).ok());
  ASSERT_TRUE(scene.world.set_velocity(id, at<D>(3.0f, 0.0f), Spin<D>::zero()).ok());
  scene.add_particle(at<D>(1.0f, 1.5f));
  scene.pins.push_back({0, 0, 0, id.index, at<D>(7.0f, 7.0f)});  // Free: has no say.
  scene.pins.push_back({0, 1, 0, id.index, at<D>(0.0f, -0.5f)});
  scene.pins.push_back({0, 1, 0, id.index, at<D>(0.0f, 0.5f)});
  for (int tick = 1; tick <= 30; ++tick) {
    step(scene.world, 1);
    scene.run(1);
    EXPECT_NEAR(scene.particles[0].position[0], scene.world.state().bodies[0].position[0], 1e-6f);
    EXPECT_NEAR(scene.particles[0].position[1], 1.5f, 1.0e-6f);
    EXPECT_NEAR(scene.particles[0].velocity[0], 3.0f, 1.0e-3f);
  }
}

TYPED_TEST(Particles, FreeSlotsAreLeftAlone) {
  constexpr int D = TypeParam::kD;
  ParticleScene<D> scene;
  scene.add_rope(at<D>(0.0f, 0.0f), 3, 0.5f);
  scene.particles[1].kind = 0;
  scene.links[0].length = 9.0f;
  scene.run(30);
  EXPECT_EQ(scene.particles[1].position[1], 0.0f);
  EXPECT_EQ(scene.particles[0].position[0], 0.0f);
  EXPECT_EQ(scene.particles[2].position[0], 1.0f);
}

TYPED_TEST(Particles, TwoRunsAreEqualToTheBitWhateverTheScratchHeld) {
  constexpr int D = TypeParam::kD;
  ParticleScene<D> one;
  add_obstacle(one, ball<D>(0.5f));
  one.add_rope(at<D>(-1.2f, 0.7f), 41, 0.05f);
  ParticleScene<D> other;
  add_obstacle(other, ball<D>(0.5f));
  other.add_rope(at<D>(3.0f, 0.7f), 90, 0.07f);
  other.run(3);
  other.particles = one.particles;
  other.links = one.links;
  for (int tick = 0; tick < 60; ++tick) {
    one.run(1);
    other.run(1);
    ASSERT_EQ(std::memcmp(one.particles.data(), other.particles.data(),
                          one.particles.size() * sizeof(Particle<D>)),
              0);
  }
}

}  // namespace cycloid::solver
