#include "protocol/state/quantised.hpp"

#include <algorithm>

#include "protocol/state/quantised_rotation.hpp"
#include "solver/tracing/digest_writer.hpp"

namespace cycloid::protocol {

/// The nearest multiple of a step, as its number; clamped to so many steps.
static std::int32_t steps_of(float value, float step, float limit) {
  const double clamped = std::clamp(static_cast<double>(value), -static_cast<double>(limit),
                                    static_cast<double>(limit));
  return static_cast<std::int32_t>(clamped / static_cast<double>(step) +
                                   (clamped < 0.0 ? -0.5 : 0.5));
}

static std::int32_t position_steps(float value_m) {
  return steps_of(value_m, kPositionStep_m, kPositionLimit_m);
}

static std::int16_t velocity_steps(float value) {
  return static_cast<std::int16_t>(steps_of(value, kVelocityStep, kVelocityLimit));
}

template <int D>
static std::array<std::int32_t, 3> quantised_position(const solver::Vec<D>& from) {
  std::array<std::int32_t, 3> into{};
  for (int i = 0; i < D; ++i) into[static_cast<std::size_t>(i)] = position_steps(from[i]);
  return into;
}

template <int D>
static void put_velocities(const solver::Body<D>& body, const solver::Vec<D>& from_centre,
                           QuantisedBody& into) {
  const solver::Vec<D> velocity = body.velocity + spin_cross(body.spin, from_centre);
  for (int i = 0; i < D; ++i)
    into.velocity[static_cast<std::size_t>(i)] = velocity_steps(velocity[i]);
  // In the plane the one spin is about z.
  constexpr int kSpin = solver::Dim<D>::kSpin;
  for (int i = 0; i < kSpin; ++i)
    into.spin[static_cast<std::size_t>(3 - kSpin + i)] = velocity_steps(body.spin[i]);
}

template <int D>
static QuantisedBody quantised(const solver::Body<D>& body, std::uint32_t index,
                               const CaptureOptions& options) {
  const solver::Vec<D> from_centre = -rotate(body.rotation, body.local_center);
  QuantisedBody into;
  into.index = index;
  into.generation = body.generation;
  into.position = quantised_position<D>(body.position + from_centre);
  into.rotation = quantise_rotation(body.rotation);
  into.at_rest = !solver::is_active(body);
  if (options.velocities && !into.at_rest) put_velocities(body, from_centre, into);
  return into;
}

template <int D>
static QuantisedBody quantised(const solver::Particle<D>& particle, std::uint32_t index,
                               const CaptureOptions& options) {
  QuantisedBody into;
  into.index = index;
  into.generation = particle.generation;
  into.position = quantised_position<D>(particle.position);
  if (options.velocities)
    for (int i = 0; i < D; ++i)
      into.velocity[static_cast<std::size_t>(i)] = velocity_steps(particle.velocity[i]);
  return into;
}

template <int D>
static void capture_world(const solver::World<D>& world, const CaptureOptions& options,
                          QuantisedState& into) {
  const solver::WorldState<D>& state = world.state();
  into.dimension = D;
  into.tick = world.tick();
  for (std::uint32_t i = 0; i < state.bodies.size(); ++i)
    if (state.bodies[i].kind != solver::BodyKind::kFree)
      into.bodies.push_back(quantised(state.bodies[i], i, options));
  for (std::uint32_t i = 0; i < state.particles.size(); ++i)
    if (state.particles[i].kind != 0)
      into.particles.push_back(quantised(state.particles[i], i, options));
}

QuantisedState capture(const scenes::Simulation& simulation, const CaptureOptions& options) {
  QuantisedState state;
  if (const auto* planar = simulation.planar(); planar != nullptr)
    capture_world(*planar, options, state);
  else
    capture_world(*simulation.spatial(), options, state);
  for (const scenes::CharacterPose& pose : simulation.characters()) {
    QuantisedCharacter& into = state.characters.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      into.position[i] = position_steps(pose.position[i]);
      into.velocity[i] = velocity_steps(pose.velocity[i]);
    }
    into.grounded = pose.grounded;
  }
  return state;
}

static void write_bodies(const std::vector<QuantisedBody>& bodies, solver::DigestWriter& write) {
  write(static_cast<std::uint32_t>(bodies.size()));
  for (const QuantisedBody& body : bodies) {
    write(body.index);
    write(body.generation);
    for (const std::int32_t steps : body.position) write(steps);
    write(std::uint32_t{body.rotation.largest});
    for (const std::int16_t part : body.rotation.parts) write(std::int32_t{part});
    for (const std::int16_t steps : body.velocity) write(std::int32_t{steps});
    for (const std::int16_t steps : body.spin) write(std::int32_t{steps});
    write(static_cast<std::uint32_t>(body.at_rest));
  }
}

std::uint64_t digest_of(const QuantisedState& state) {
  solver::DigestWriter write;
  write(std::uint32_t{state.dimension});
  write(state.tick);
  write_bodies(state.bodies, write);
  write_bodies(state.particles, write);
  write(static_cast<std::uint32_t>(state.characters.size()));
  for (const QuantisedCharacter& character : state.characters) {
    for (const std::int32_t steps : character.position) write(steps);
    for (const std::int16_t steps : character.velocity) write(std::int32_t{steps});
    write(static_cast<std::uint32_t>(character.grounded));
  }
  return write.digest();
}

bool shows_the_same(const QuantisedState& a, const QuantisedState& b) {
  return a.dimension == b.dimension && a.bodies == b.bodies && a.particles == b.particles &&
         a.characters == b.characters;
}

std::size_t size_bytes(const QuantisedState& state) {
  return sizeof state +
         (state.bodies.capacity() + state.particles.capacity()) * sizeof(QuantisedBody) +
         state.characters.capacity() * sizeof(QuantisedCharacter);
}

static std::array<float, 3> in_steps(const std::array<std::int16_t, 3>& steps) {
  std::array<float, 3> values{};
  for (std::size_t i = 0; i < 3; ++i) values[i] = static_cast<float>(steps[i]) * kVelocityStep;
  return values;
}

scenes::Pose pose_of(const QuantisedBody& body, std::uint8_t dimension) {
  scenes::Pose pose;
  pose.index = body.index;
  pose.generation = body.generation;
  for (std::size_t i = 0; i < 3; ++i)
    pose.position[i] = static_cast<float>(body.position[i]) * kPositionStep_m;
  pose.rotation = quaternion_of(body.rotation, dimension);
  return pose;
}

scenes::CharacterPose pose_of(const QuantisedCharacter& character) {
  scenes::CharacterPose pose;
  for (std::size_t i = 0; i < 3; ++i)
    pose.position[i] = static_cast<float>(character.position[i]) * kPositionStep_m;
  pose.velocity = in_steps(character.velocity);
  pose.grounded = character.grounded;
  return pose;
}

std::array<float, 3> velocity_of(const QuantisedBody& body) {
  return in_steps(body.velocity);
}
std::array<float, 3> spin_of(const QuantisedBody& body) {
  return in_steps(body.spin);
}

}  // namespace cycloid::protocol
