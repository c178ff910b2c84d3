#include "solver/slots.hpp"
#include "solver/step_scratch.hpp"
#include "solver/validate.hpp"
#include "solver/workers.hpp"
#include "solver/world.hpp"

namespace cycloid::solver {

template <class Slots, class Id>
static bool lives(const Slots& slots, const Id& id) {
  return id.index < slots.size() && slots[id.index].kind != 0 &&
         slots[id.index].generation == id.generation;
}

/// Takes a slot for `record`, whose generation becomes that of the slot.
template <class Id, class Record>
static Id place(Record record, std::vector<Record>& slots, std::vector<std::uint32_t>& free) {
  const std::uint32_t index = take_slot(slots, free);
  record.generation = slots[index].generation;
  record.kind = 1;
  slots[index] = record;
  return {index, record.generation};
}

template <int D>
Result<ParticleId> World<D>::create_particle(const ParticleDef<D>& def) {
  if (!within(def.position, kPositionMax)) return invalid("position");
  if (!within(def.velocity, kSpeedMax)) return invalid("velocity");
  if (def.mass != 0.0f && !within(def.mass, kMassMin, kMassMax)) return invalid("mass");
  if (!within(def.radius, kSizeMin, kSizeMax)) return invalid("radius");
  if (def.material >= state_.materials.size()) return invalid("material");
  if (!has_room(state_.particles, state_.free_particles, 1, state_.header.limits.particles))
    return Error{Code::kCapacity, "limits.particles"};
  Particle<D> particle;
  particle.position = def.position;
  particle.velocity = def.velocity;
  particle.inverse_mass = def.mass > 0.0f ? 1.0f / def.mass : 0.0f;
  particle.radius = def.radius;
  particle.material = def.material;
  particle.group = def.group;
  particle.filter = def.filter;
  return place<ParticleId>(particle, state_.particles, state_.free_particles);
}

template <int D>
Result<LinkId> World<D>::create_link(const LinkDef& def) {
  if (!lives(state_.particles, def.particle_a)) return Error{Code::kUnknownId, "particle_a"};
  if (!lives(state_.particles, def.particle_b)) return Error{Code::kUnknownId, "particle_b"};
  if (def.particle_a == def.particle_b) return invalid("particle_b");
  if (!within(def.length, 0.0f, kSizeMax)) return invalid("length");
  if (!within(def.compliance, 0.0f, 1.0e6f)) return invalid("compliance");
  if (!has_room(state_.links, state_.free_links, 1, state_.header.limits.links))
    return Error{Code::kCapacity, "limits.links"};
  Link link;
  link.particle_a = def.particle_a.index;
  link.particle_b = def.particle_b.index;
  link.length = def.length;
  link.compliance = def.compliance;
  return state_.links.edit(
      [&](std::vector<Link>& links) { return place<LinkId>(link, links, state_.free_links); });
}

template <int D>
Result<PinId> World<D>::create_pin(const PinDef<D>& def) {
  if (!lives(state_.particles, def.particle)) return Error{Code::kUnknownId, "particle"};
  if (!contains(def.body)) return Error{Code::kUnknownId, "body"};
  if (!within(def.anchor, kSizeMax)) return invalid("anchor");
  if (!has_room(state_.pins, state_.free_pins, 1, state_.header.limits.pins))
    return Error{Code::kCapacity, "limits.pins"};
  Pin<D> pin;
  pin.particle = def.particle.index;
  pin.body = def.body.index;
  pin.anchor = def.anchor - state_.bodies[def.body.index].local_center;
  return place<PinId>(pin, state_.pins, state_.free_pins);
}

template <int D>
Error World<D>::destroy_particle(ParticleId id) {
  if (!lives(state_.particles, id)) return {Code::kUnknownId, "particle"};
  for (std::uint32_t i = 0; i < state_.links.size(); ++i) {
    const Link& link = state_.links[i];
    if (link.kind != 0 && (link.particle_a == id.index || link.particle_b == id.index))
      free_slot(i, state_.links, state_.free_links);
  }
  for (std::uint32_t i = 0; i < state_.pins.size(); ++i)
    if (state_.pins[i].kind != 0 && state_.pins[i].particle == id.index)
      free_slot(i, state_.pins, state_.free_pins);
  free_slot(id.index, state_.particles, state_.free_particles);
  return {};
}

template <int D>
Error World<D>::destroy_link(LinkId id) {
  if (!lives(state_.links, id)) return {Code::kUnknownId, "link"};
  free_slot(id.index, state_.links, state_.free_links);
  return {};
}

template <int D>
Error World<D>::destroy_pin(PinId id) {
  if (!lives(state_.pins, id)) return {Code::kUnknownId, "pin"};
  free_slot(id.index, state_.pins, state_.free_pins);
  return {};
}

template Result<ParticleId> World<2>::create_particle(const ParticleDef<2>&);
template Result<ParticleId> World<3>::create_particle(const ParticleDef<3>&);
template Result<LinkId> World<2>::create_link(const LinkDef&);
template Result<LinkId> World<3>::create_link(const LinkDef&);
template Result<PinId> World<2>::create_pin(const PinDef<2>&);
template Result<PinId> World<3>::create_pin(const PinDef<3>&);
template Error World<2>::destroy_particle(ParticleId);
template Error World<3>::destroy_particle(ParticleId);
template Error World<2>::destroy_link(LinkId);
template Error World<3>::destroy_link(LinkId);
template Error World<2>::destroy_pin(PinId);
template Error World<3>::destroy_pin(PinId);

}  // namespace cycloid::solver
