#pragma once

#include "solver/particles/move_particles.hpp"
#include "solver/particles/shape_distance.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// Particles and what they collide with; gravity is 10 m/s^2, downwards along axis 1.
template <int D>
struct ParticleScene {
  World<D> world = make_world<D>(with_gravity<D>());
  Vec<D> gravity = at<D>(0.0f, -10.0f);
  ParticleTuning tuning;
  std::vector<Particle<D>> particles;
  std::vector<Link> links;
  std::vector<Pin<D>> pins;
  ParticleScratch<D> scratch;

  std::uint32_t add_particle(Vec<D> position, float inverse_mass = 1.0f) {
    Particle<D> particle;
    particle.kind = 1;
    particle.position = position;
    particle.inverse_mass = inverse_mass;
    particles.push_back(particle);
    return static_cast<std::uint32_t>(particles.size() - 1);
  }
  void add_link(std::uint32_t a, std::uint32_t b, float rest_length, float compliance = 0.0f) {
    links.push_back({0, 1, a, b, rest_length, compliance});
  }
  /// From `start` on, `count` particles `spacing` apart along axis 0, each linked to the next.
  void add_rope(Vec<D> start, int count, float spacing) {
    for (int i = 0; i < count; ++i) {
      const auto last = add_particle(start + at<D>(spacing * static_cast<float>(i), 0.0f));
      if (i > 0) add_link(last - 1, last, spacing);
    }
  }
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i)
      move_particles<D>(kTick, gravity, tuning, world.state(), particles, links, pins, scratch);
  }
  float stretch() const {
    float worst = 0.0f;
    for (const Link& link : links) {
      const Vec<D> d = particles[link.particle_b].position - particles[link.particle_a].position;
      worst = std::max(worst, std::abs(length(d) / link.length - 1.0f));
    }
    return worst;
  }
  /// The least signed distance of any particle's surface from shape 0.
  float clearance() const {
    float least = 1.0e9f;
    for (const Particle<D>& p : particles) {
      const Body<D>& body = world.state().bodies[0];
      const Pose<D> pose{body.position, body.rotation};
      least = std::min(
          least, signed_distance(world.state().shapes[0], pose, p.position).distance - p.radius);
    }
    return least;
  }
};

/// A static body of one shape and nothing else.
template <int D>
void add_obstacle(ParticleScene<D>& scene, const ShapeDef<D>& shape,
                  Vec<D> position = Vec<D>::zero(), Rotation<D> rotation = identity_rotation<D>()) {
  BodyDef<D> body;
  body.kind = BodyKind::kStatic;
  body.position = position;
  body.rotation = rotation;
  add(scene.world, body, shape);
}

template <class T>
class Particles : public testing::Test {};
template <int N>
struct ParticleDimension {
  static constexpr int kD = N;
};
using ParticleDimensions = testing::Types<ParticleDimension<2>, ParticleDimension<3>>;
TYPED_TEST_SUITE(Particles, ParticleDimensions);

}  // namespace cycloid::solver
