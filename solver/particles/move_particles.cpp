#include "solver/particles/move_particles.hpp"

#include <algorithm>

#include "solver/particles/shape_distance.hpp"
#include "solver/validate.hpp"

namespace cycloid::solver {

/// Surfaces that one particle may meet in one substep before it stops where it is.
static constexpr int kHitsMax = 8;
/// Steps of a march. It is Newton's method on a convex function from the outside: quadratic, or
/// one fourth of the gap per step where the path only grazes.
static constexpr int kMarchMax = 16;
static constexpr float kArrived = 1.0e-6f;  ///< m of gap at which the march has arrived.
/// Share of a path that may lead into a surface which it runs along: rounding.
static constexpr float kGrazing = 1.0e-6f;
static constexpr float kSkin = 0.01f;  ///< m added to boxes: covers rounding to 10 km away.

/// A particle in a substep, as the collisions see it. Points are relative to the particle's
/// position at the start of the tick.
template <int D>
struct Flight {
  const WorldState<D>& state;
  const Particle<D>& particle;
  float h;         ///< s
  Vec<D> at;       ///< Where the particle has got to, m.
  Vec<D> covered;  ///< Displacement up to there since the start of the substep, m.
  Vec<D> rest;     ///< Displacement that is still to come, m.
};

template <int D>
struct Hit {
  float time = 1.0f;  ///< Share of the rest of the flight.
  std::uint32_t shape = kNone;
  Vec<D> normal;
};

static bool may_meet(const Filter& a, const Filter& b) {
  if (a.group != 0 && a.group == b.group) return a.group > 0;
  return (a.category & b.mask) != 0 && (b.category & a.mask) != 0;
}

template <int D>
static Pose<D> relative_pose(const Flight<D>& flight, const Shape<D>& shape) {
  const Body<D>& body = flight.state.bodies[shape.body];
  return {body.position - flight.particle.position, body.rotation};
}

/// From the surface of the particle, centred at `at`, to the surface of the shape.
template <int D>
static SignedDistance<D> gap(const Flight<D>& flight, const Shape<D>& shape, const Vec<D>& at) {
  SignedDistance<D> result =
      signed_distance(shape, relative_pose(flight, shape), at, flight.state.polyhedra);
  result.distance -= flight.particle.radius;
  return result;
}

/// Whether the particle's centre is behind a segment or triangle, which then lets it through.
template <int D>
static bool is_behind(const Flight<D>& flight, const Shape<D>& shape, float gap_distance) {
  const bool one_sided = shape.kind == ShapeKind::kSegment || shape.kind == ShapeKind::kTriangle;
  return one_sided && gap_distance < -shape.radius - flight.particle.radius;
}

/// Shapes that meet the particle on its way from `at` along the rest, by slot.
template <int D>
static void list_near(const Flight<D>& flight, ParticleScratch<D>& scratch) {
  scratch.nearby.clear();
  const auto consider = [&](std::uint32_t s) {
    if (may_meet(flight.particle.filter, flight.state.shapes[s].filter))
      scratch.nearby.push_back(s);
  };
  for (const std::uint32_t s : scratch.unbounded) consider(s);
  const Vec<D> from = flight.particle.position + flight.at;
  const Vec<D> to = from + flight.rest;
  Bounds<D> bounds = merged(Bounds<D>{from, from}, Bounds<D>{to, to});
  for (int i = 0; i < D; ++i) {
    bounds.lower[i] -= flight.particle.radius;
    bounds.upper[i] += flight.particle.radius;
  }
  scratch.tree.query(bounds, [&](int rank) { consider(scratch.tree.leaf(rank).id); });
  // Total order: a slot is listed once.
  std::sort(scratch.nearby.begin(), scratch.nearby.end());
}

/// Coulomb friction on the displacement: takes up to mu `depth` off what the whole substep moves
/// the particle along the surface, relative to the surface. What lies before the impact counts too,
/// so one that sticks goes as far as the surface does, however late in the substep they meet.
template <int D>
static void rub(const Shape<D>& shape, const Vec<D>& normal, float depth, Flight<D>& flight) {
  const Body<D>& body = flight.state.bodies[shape.body];
  Vec<D> relative = flight.covered + flight.rest;
  if (body.kind != BodyKind::kStatic) {
    const Vec<D> arm =
        flight.at - relative_pose(flight, shape).position - flight.particle.radius * normal;
    relative -= flight.h * (body.velocity + spin_cross(body.spin, arm));
  }
  const Vec<D> slip = relative - dot(relative, normal) * normal;
  const float distance = length(slip);
  const float friction = sqrt(flight.state.materials[flight.particle.material].friction *
                              flight.state.materials[shape.material].friction);
  const float limit = friction * depth;
  flight.rest -= (distance > limit ? limit / distance : 1.0f) * slip;
}

/// Leads a particle out of the shapes it is in, by 1 / substeps_left of the depth in each.
template <int D>
static void lead_out(float substeps_left, Flight<D>& flight, ParticleScratch<D>& scratch) {
  for (const std::uint32_t s : scratch.nearby) {
    const Shape<D>& shape = flight.state.shapes[s];
    const SignedDistance<D> now = gap(flight, shape, flight.at);
    if (now.distance >= 0.0f || is_behind(flight, shape, now.distance)) continue;
    const float depth = -now.distance / substeps_left - dot(now.normal, flight.rest);
    if (depth <= 0.0f) continue;
    flight.rest += depth * now.normal;
    rub(shape, now.normal, depth, flight);
  }
}

/// Marches along the rest of the flight until it meets the shape sooner than `hit`. A shape is
/// convex: the particle cannot meet it before it meets the tangent plane of the nearest point, so
/// going that far is safe. Where the particle is inside, it goes no deeper.
template <int D>
static void march(std::uint32_t s, const Flight<D>& flight, Hit<D>& hit) {
  const Shape<D>& shape = flight.state.shapes[s];
  const float grazing = kGrazing * length(flight.rest);
  SignedDistance<D> now = gap(flight, shape, flight.at);
  if (is_behind(flight, shape, now.distance)) return;
  float time = 0.0f;
  for (int i = 0; i < kMarchMax; ++i) {
    const float approach = -dot(now.normal, flight.rest);
    if (approach <= grazing) return;
    if (now.distance <= kArrived) break;
    time += now.distance / approach;
    if (time >= hit.time) return;
    now = gap(flight, shape, flight.at + time * flight.rest);
  }
  // A later slot at the same time does not replace an earlier one.
  if (time < hit.time) hit = {time, s, now.normal};
}

/// Flies from surface to surface, sliding along each, until nothing is left of the displacement.
/// @returns the displacement of the substep.
template <int D>
static Vec<D> fly(float substeps_left, Flight<D> flight, ParticleScratch<D>& scratch) {
  list_near(flight, scratch);
  if (scratch.nearby.empty()) return flight.rest;
  lead_out(substeps_left, flight, scratch);
  for (int i = 0; i < kHitsMax; ++i) {
    list_near(flight, scratch);
    Hit<D> hit;
    for (const std::uint32_t s : scratch.nearby) march(s, flight, hit);
    if (hit.shape == kNone) return flight.covered + flight.rest;
    const Vec<D> step = hit.time * flight.rest;
    flight.at += step;
    flight.covered += step;
    flight.rest -= step;
    const float depth = max(-dot(hit.normal, flight.rest), 0.0f);
    flight.rest += depth * hit.normal;
    rub(flight.state.shapes[hit.shape], hit.normal, depth, flight);
  }
  return flight.covered;
}

template <int D>
static void list_shapes(const WorldState<D>& state, ParticleScratch<D>& scratch) {
  scratch.leaves.clear();
  scratch.unbounded.clear();
  for (std::uint32_t s = 0; s < state.shapes.size(); ++s) {
    const Shape<D>& shape = state.shapes[s];
    if (shape.kind == ShapeKind::kFree) continue;
    if (shape.kind == ShapeKind::kHalfSpace) {
      scratch.unbounded.push_back(s);
      continue;
    }
    const Body<D>& body = state.bodies[shape.body];
    scratch.leaves.push_back({bounds_of(shape, Pose<D>{body.position, body.rotation}, kSkin), s});
  }
  Workers alone(1);
  scratch.tree.build(scratch.leaves, alone, scratch.tree_room);
}

template <int D>
static void start_tick(const WorldState<D>& state, std::span<const Particle<D>> particles,
                       std::span<const Pin<D>> pins, ParticleScratch<D>& scratch) {
  scratch.motions.clear();
  for (const Particle<D>& particle : particles)
    scratch.motions.push_back({Vec<D>::zero(), Vec<D>::zero(), particle.inverse_mass});
  scratch.held.assign(particles.size(), 0);
  scratch.targets.assign(particles.size(), Vec<D>::zero());
  for (const Pin<D>& pin : pins) {
    if (pin.kind == 0 || particles[pin.particle].kind == 0) continue;
    const Body<D>& body = state.bodies[pin.body];
    if (body.kind == BodyKind::kFree || scratch.held[pin.particle] != 0) continue;
    scratch.held[pin.particle] = 1;
    scratch.motions[pin.particle].inverse_mass = 0.0f;
    scratch.targets[pin.particle] =
        (body.position - particles[pin.particle].position) + rotate(body.rotation, pin.anchor);
  }
}

template <int D>
static Vec<D> predict(float h, const Vec<D>& gravity, const ParticleTuning& tuning,
                      float substeps_left, std::size_t i, const Particle<D>& particle,
                      const ParticleScratch<D>& scratch) {
  const ParticleMotion<D>& motion = scratch.motions[i];
  if (scratch.held[i] != 0) return (1.0f / substeps_left) * (scratch.targets[i] - motion.offset);
  if (motion.inverse_mass == 0.0f) return Vec<D>::zero();
  return (h / (1.0f + h * tuning.damping)) * (particle.velocity + h * gravity);
}

template <int D>
static void move_substep(float h, const Vec<D>& gravity, const ParticleTuning& tuning,
                         float substeps_left, const WorldState<D>& state,
                         std::span<Particle<D>> particles, std::span<const Link> links,
                         ParticleScratch<D>& scratch) {
  for (std::size_t i = 0; i < particles.size(); ++i)
    scratch.motions[i].displacement =
        predict(h, gravity, tuning, substeps_left, i, particles[i], scratch);
  scratch.lambdas.assign(links.size(), 0.0f);
  for (std::uint32_t sweep = 0; sweep < tuning.sweeps; ++sweep)
    project_links<D>(h, particles, links, scratch.motions, scratch.lambdas);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    Particle<D>& particle = particles[i];
    if (particle.kind == 0) continue;
    ParticleMotion<D>& motion = scratch.motions[i];
    if (motion.inverse_mass > 0.0f)
      motion.displacement =
          fly(substeps_left,
              {state, particle, h, motion.offset, Vec<D>::zero(), motion.displacement}, scratch);
    motion.offset += motion.displacement;
    for (int axis = 0; axis < D; ++axis) particle.velocity[axis] = motion.displacement[axis] / h;
  }
}

/// What is held goes wherever its body is put, and pulls what it is linked to: farther in a tick
/// than a particle moves by itself. NaN stays NaN, so that the tick faults. `clamp` would hide it.
static float bounded(float speed, float bound) {
  if (speed > bound) return bound;
  return speed < -bound ? -bound : speed;
}

template <int D>
void move_particles(float tick_s, const Vec<D>& gravity, const ParticleTuning& tuning,
                    const WorldState<D>& state, std::span<Particle<D>> particles,
                    std::span<const Link> links, std::span<const Pin<D>> pins,
                    ParticleScratch<D>& scratch) {
  list_shapes(state, scratch);
  start_tick<D>(state, particles, pins, scratch);
  const float h = tick_s / static_cast<float>(tuning.substeps);
  for (std::uint32_t done = 0; done < tuning.substeps; ++done)
    move_substep(h, gravity, tuning, static_cast<float>(tuning.substeps - done), state, particles,
                 links, scratch);
  for (std::size_t i = 0; i < particles.size(); ++i) {
    if (particles[i].kind == 0) continue;
    particles[i].position += scratch.motions[i].offset;
    for (float& speed : particles[i].velocity.v) speed = bounded(speed, kSpeedMax);
  }
}

template void move_particles(float, const Vec<2>&, const ParticleTuning&, const WorldState<2>&,
                             std::span<Particle<2>>, std::span<const Link>, std::span<const Pin<2>>,
                             ParticleScratch<2>&);
template void move_particles(float, const Vec<3>&, const ParticleTuning&, const WorldState<3>&,
                             std::span<Particle<3>>, std::span<const Link>, std::span<const Pin<3>>,
                             ParticleScratch<3>&);

}  // namespace cycloid::solver
