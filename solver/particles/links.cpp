#include "solver/particles/links.hpp"

namespace cycloid::solver {

template <int D>
static Vec<D> first_axis() {
  Vec<D> axis = Vec<D>::zero();
  axis[0] = 1.0f;
  return axis;
}

template <int D>
void project_links(float h, std::span<const Particle<D>> particles, std::span<const Link> links,
                   std::span<ParticleMotion<D>> motions, std::span<float> lambdas) {
  const Vec<D> fallback = first_axis<D>();
  for (std::size_t i = 0; i < links.size(); ++i) {
    const Link& link = links[i];
    if (link.kind == 0) continue;
    const Particle<D>& particle_a = particles[link.particle_a];
    const Particle<D>& particle_b = particles[link.particle_b];
    if (particle_a.kind == 0 || particle_b.kind == 0) continue;
    ParticleMotion<D>& a = motions[link.particle_a];
    ParticleMotion<D>& b = motions[link.particle_b];
    const float inverse_masses = a.inverse_mass + b.inverse_mass;
    if (!(inverse_masses > 0.0f)) continue;
    // Like is taken from like, so that small differences are not lost in great positions.
    const Vec<D> offset = (particle_b.position - particle_a.position) + (b.offset - a.offset) +
                          (b.displacement - a.displacement);
    const Vec<D> u = normalized_or(offset, fallback);
    const float error = length(offset) - link.length;
    const float softness = link.compliance / (h * h);
    const float change = -(error + softness * lambdas[i]) / (inverse_masses + softness);
    lambdas[i] += change;
    a.displacement -= (a.inverse_mass * change) * u;
    b.displacement += (b.inverse_mass * change) * u;
  }
}

template void project_links(float, std::span<const Particle<2>>, std::span<const Link>,
                            std::span<ParticleMotion<2>>, std::span<float>);
template void project_links(float, std::span<const Particle<3>>, std::span<const Link>,
                            std::span<ParticleMotion<3>>, std::span<float>);

}  // namespace cycloid::solver
