#include "solver/bytes.hpp"
#include "solver/solids/validate_polyhedra.hpp"
#include "solver/validate.hpp"
#include "solver/visit.hpp"

namespace cycloid::solver {

static Error corrupt(const char* field, std::size_t index) {
  return {Code::kCorrupt, field, static_cast<int>(index)};
}

/// Whether every float of a record is finite and no larger than what `step` lets through.
template <class R>
static bool is_finite(const R& record) {
  bool finite = true;
  visit_words(record, [&](const auto& value) {
    if constexpr (std::is_same_v<std::remove_cvref_t<decltype(value)>, float>)
      finite = finite && within(value, -1.0e30f, 1.0e30f);
  });
  return finite;
}

/// A free list names each free slot once and nothing else.
template <class Slots, class Kind>
static bool is_free_list(const std::vector<std::uint32_t>& list, const Slots& slots, Kind free) {
  std::vector<bool> listed(slots.size(), false);
  for (const std::uint32_t index : list) {
    if (index >= slots.size() || listed[index] || slots[index].kind != free) return false;
    listed[index] = true;
  }
  for (std::size_t i = 0; i < slots.size(); ++i)
    if (slots[i].kind == free && !listed[i]) return false;
  return true;
}

/// Whether a slot that is free holds its generation and nothing else.
template <class R>
static bool is_blank(const R& record) {
  bool blank = true;
  R empty{};
  if constexpr (requires { record.generation; }) empty.generation = record.generation;
  std::vector<std::uint64_t> words;
  visit_words(empty, [&](const auto& value) { words.push_back(bits_of(value)); });
  std::size_t at = 0;
  visit_words(record, [&](const auto& value) { blank = blank && bits_of(value) == words[at++]; });
  return blank;
}

/// Whether World's calls and steps could have made these numbers of a body in use.
template <int D>
static bool is_reachable(const Body<D>& body) {
  const bool moves = body.kind == BodyKind::kDynamic || body.kind == BodyKind::kParticle;
  const bool weighs =
      moves ? within(body.mass, kMassMin, kMassMax) && body.inverse_mass == 1.0f / body.mass
            : body.mass == 0.0f && body.inverse_mass == 0.0f;
  if (!weighs || !within(body.position, kPositionMax)) return false;
  if (!within(dot(body.rotation, body.rotation), 0.99f, 1.01f)) return false;
  if (!within(body.velocity, kSpeedMax) || !within(body.spin, kSpinMax)) return false;
  const float force_max = moves ? kForceMax : 0.0f;
  if (!within(body.force, force_max) || !within(body.torque, force_max)) return false;
  const float motion = dot(body.velocity, body.velocity) + dot(body.spin, body.spin);
  if (body.kind == BodyKind::kStatic && motion != 0.0f) return false;
  if (!within(body.linear_damping, 0.0f, 1.0e4f) || !within(body.angular_damping, 0.0f, 1.0e4f))
    return false;
  if (!within(body.gravity_scale, -1.0e3f, 1.0e3f)) return false;
  if (!within(body.extent, 0.0f, 1.0e2f * kSizeMax)) return false;
  if (!within(body.thickness, 0.0f, 1.0e2f * kSizeMax)) return false;
  return body.asleep <= 1 && body.fixed_rotation <= 1 && within(body.local_center, 4.0f * kSizeMax);
}

template <int D>
static Error validate_bodies(const WorldState<D>& state) {
  std::vector<bool> owned(state.shapes.size(), false);
  for (std::size_t i = 0; i < state.bodies.size(); ++i) {
    const Body<D>& body = state.bodies[i];
    if (body.kind > BodyKind::kParticle || !is_finite(body)) return corrupt("body", i);
    const bool free = body.kind == BodyKind::kFree;
    if (free ? !is_blank(body) : !is_reachable(body)) return corrupt("body", i);
    if (free) continue;
    for (std::uint32_t s = body.first_shape; s != kNone; s = state.shapes[s].next) {
      // `owned` also ends a list that runs in a circle.
      if (s >= state.shapes.size() || owned[s]) return corrupt("body", i);
      const ShapeKind kind = state.shapes[s].kind;
      if (kind == ShapeKind::kFree || state.shapes[s].body != i) return corrupt("body", i);
      if (is_of_static_bodies(kind) && body.kind != BodyKind::kStatic) return corrupt("body", i);
      owned[s] = true;
    }
  }
  for (std::size_t i = 0; i < state.shapes.size(); ++i)
    if (owned[i] != (state.shapes[i].kind != ShapeKind::kFree)) return corrupt("shape", i);
  return {};
}

static bool has_unit_normals(const Shape<2>& shape) {
  for (std::size_t i = 0; i < shape.vertex_count; ++i)
    if (!within(dot(shape.normals[i], shape.normals[i]), 0.99f, 1.01f)) return false;
  return true;
}

/// Corners, radius and plane within what a definition may say, shifted to a centre of mass.
template <int D>
static bool is_sized(const Shape<D>& shape) {
  for (const Vec<D>& vertex : shape.vertices)
    if (!within(vertex, 8.0f * kSizeMax)) return false;
  const bool round = shape.kind == ShapeKind::kBall || shape.kind == ShapeKind::kCapsule;
  if (!within(shape.radius, round ? kSizeMin : 0.0f, kSizeMax)) return false;
  const bool plane = shape.kind == ShapeKind::kHalfSpace;
  if (plane && !within(dot(shape.normal, shape.normal), 0.99f, 1.01f)) return false;
  return within(shape.offset, -8.0f * kSizeMax, 8.0f * kSizeMax);
}

static bool outline_fits(const WorldState<2>&, const Shape<2>& shape) {
  const std::uint32_t n = shape.vertex_count;
  switch (shape.kind) {
    case ShapeKind::kFree:
      return true;
    case ShapeKind::kBall:
      return n == 1;
    case ShapeKind::kHalfSpace:
      return n == 0;
    case ShapeKind::kCapsule:
      return n == 2;
    case ShapeKind::kSegment:
      return n == 2 && shape.ghosts < 4;
    case ShapeKind::kPolygon:
      return n >= 3 && n <= shape.vertices.size() && has_unit_normals(shape);
    default:
      return false;
  }
}
static bool has_size(const Vec<3>& half) {
  for (const float extent : half.v)
    if (!within(extent, 0.0f, 2.0f * kSizeMax)) return false;
  return true;
}

static bool outline_fits(const WorldState<3>& state, const Shape<3>& shape) {
  const std::uint32_t n = shape.vertex_count;
  const bool turned = within(dot(shape.rotation, shape.rotation), 0.99f, 1.01f);
  switch (shape.kind) {
    case ShapeKind::kFree:
      return true;
    case ShapeKind::kBall:
      return n == 1;
    case ShapeKind::kHalfSpace:
      return n == 0;
    case ShapeKind::kCapsule:
      return n == 2;
    case ShapeKind::kTriangle:
      return n == 3 && shape.ghosts < 8 && within(dot(shape.normal, shape.normal), 0.99f, 1.01f);
    case ShapeKind::kBox:
      return n == 1 && turned && has_size(shape.half);
    case ShapeKind::kHull:
      return n == 1 && turned && has_size(shape.half) &&
             shape.polyhedron < state.polyhedra.records.size() &&
             state.polyhedra.records[shape.polyhedron].references > 0;
    default:
      return false;
  }
}

template <int D>
static Error validate_shapes(const WorldState<D>& state) {
  for (std::size_t i = 0; i < state.shapes.size(); ++i) {
    const Shape<D>& shape = state.shapes[i];
    if (!is_finite(shape) || !outline_fits(state, shape)) return corrupt("shape", i);
    if (shape.kind == ShapeKind::kFree) {
      if (!is_blank(shape)) return corrupt("shape", i);
      continue;
    }
    if (!is_sized(shape) || shape.material >= state.materials.size()) return corrupt("shape", i);
  }
  return {};
}

template <int D>
static Error validate_joints(const WorldState<D>& state) {
  for (std::size_t i = 0; i < state.joints.size(); ++i) {
    const Joint<D>& joint = state.joints[i];
    if (joint.kind > JointKind::kConeTwist || !is_finite(joint)) return corrupt("joint", i);
    if (joint.motor > MotorKind::kPosition || joint.curve > CurveKind::kPolyline)
      return corrupt("joint", i);
    if (joint.kind == JointKind::kFree) {
      if (!is_blank(joint)) return corrupt("joint", i);
      continue;
    }
    for (const std::uint32_t body : {joint.body_a, joint.body_b})
      if (body >= state.bodies.size() || state.bodies[body].kind == BodyKind::kFree)
        return corrupt("joint", i);
    const bool held = state.bodies[joint.body_a].inverse_mass == 0.0f &&
                      state.bodies[joint.body_b].inverse_mass == 0.0f;
    const bool turned = within(dot(joint.reference, joint.reference), 0.99f, 1.01f);
    if (held || !turned || !is_reachable(joint)) return corrupt("joint", i);
  }
  return {};
}

template <int D>
static Error validate_contacts(const WorldState<D>& state) {
  for (std::size_t i = 0; i < state.contacts.size(); ++i) {
    const Contact<D>& contact = state.contacts[i];
    if (!is_finite(contact)) return corrupt("contact", i);
    if (contact.point_count > Dim<D>::kManifoldPoints || contact.touching > 1)
      return corrupt("contact", i);
    if (contact.shape_a >= contact.shape_b || contact.shape_b >= state.shapes.size())
      return corrupt("contact", i);
    for (const std::uint32_t shape : {contact.shape_a, contact.shape_b})
      if (state.shapes[shape].kind == ShapeKind::kFree) return corrupt("contact", i);
    if (i == 0) continue;
    const Contact<D>& before = state.contacts[i - 1];
    const bool ordered = before.shape_a < contact.shape_a ||
                         (before.shape_a == contact.shape_a && before.shape_b < contact.shape_b);
    if (!ordered) return corrupt("contact", i);
  }
  return {};
}

template <int D>
static Error validate_particles(const WorldState<D>& state) {
  for (std::size_t i = 0; i < state.particles.size(); ++i) {
    const Particle<D>& particle = state.particles[i];
    if (particle.kind > 1 || !is_finite(particle)) return corrupt("particle", i);
    if (particle.kind == 0) {
      if (!is_blank(particle)) return corrupt("particle", i);
      continue;
    }
    const bool sized = within(particle.radius, kSizeMin, kSizeMax);
    const bool weighs = particle.inverse_mass == 0.0f ||
                        within(particle.inverse_mass, 0.5f / kMassMax, 2.0f / kMassMin);
    if (!sized || !weighs || !within(particle.position, kPositionMax) ||
        !within(particle.velocity, kSpeedMax) || particle.material >= state.materials.size())
      return corrupt("particle", i);
  }
  const auto lives = [&](std::uint32_t slot) {
    return slot < state.particles.size() && state.particles[slot].kind != 0;
  };
  for (std::size_t i = 0; i < state.links.size(); ++i) {
    const Link& link = state.links[i];
    if (link.kind > 1 || !is_finite(link)) return corrupt("link", i);
    if (link.kind == 0) {
      if (!is_blank(link)) return corrupt("link", i);
      continue;
    }
    if (!lives(link.particle_a) || !lives(link.particle_b) || link.particle_a == link.particle_b)
      return corrupt("link", i);
    if (!within(link.length, 0.0f, kSizeMax) || !within(link.compliance, 0.0f, 1.0e6f))
      return corrupt("link", i);
  }
  for (std::size_t i = 0; i < state.pins.size(); ++i) {
    const Pin<D>& pin = state.pins[i];
    if (pin.kind > 1 || !is_finite(pin)) return corrupt("pin", i);
    if (pin.kind == 0) {
      if (!is_blank(pin)) return corrupt("pin", i);
      continue;
    }
    if (!lives(pin.particle) || pin.body >= state.bodies.size() ||
        state.bodies[pin.body].kind == BodyKind::kFree || !within(pin.anchor, 4.0f * kSizeMax))
      return corrupt("pin", i);
  }
  return {};
}

template <int D>
static Error validate_header(const WorldState<D>& state) {
  const WorldHeader<D>& header = state.header;
  if (!within(header.gravity, 1.0e4f)) return corrupt("gravity", 0);
  if (!within(header.tick_s, 1.0e-5f, 1.0f)) return corrupt("tick_s", 0);
  if (header.tick >= kTickEnd) return corrupt("tick", 0);
  if (!validate(header.tuning).ok()) return corrupt("tuning", 0);
  if (!validate(header.limits).ok()) return corrupt("limits", 0);
  if (header.fault.field > kFaultParticle) return corrupt("fault", 0);
  const Limits& limits = header.limits;
  if (state.bodies.size() > limits.bodies) return corrupt("limits.bodies", 0);
  if (state.shapes.size() > limits.shapes) return corrupt("limits.shapes", 0);
  if (state.joints.size() > limits.joints) return corrupt("limits.joints", 0);
  if (state.contacts.size() > limits.contacts) return corrupt("limits.contacts", 0);
  if (state.materials.size() > limits.materials) return corrupt("limits.materials", 0);
  if (state.registers.size() > limits.registers) return corrupt("limits.registers", 0);
  if (state.particles.size() > limits.particles) return corrupt("limits.particles", 0);
  if (state.links.size() > limits.links) return corrupt("limits.links", 0);
  if (state.pins.size() > limits.pins) return corrupt("limits.pins", 0);
  for (std::size_t i = 0; i < state.materials.size(); ++i)
    if (!validate(state.materials[i], static_cast<int>(i)).ok()) return corrupt("material", i);
  return {};
}

template <int D>
Error validate(const WorldState<D>& state) {
  if (const Error error = validate_header(state); !error.ok()) return error;
  if (const Error error = validate_bodies(state); !error.ok()) return error;
  if (const Error error = validate_shapes(state); !error.ok()) return error;
  if (const Error error = validate_polyhedra(state); !error.ok()) return error;
  if (const Error error = validate_joints(state); !error.ok()) return error;
  if (const Error error = validate_contacts(state); !error.ok()) return error;
  if (const Error error = validate_particles(state); !error.ok()) return error;
  if (!is_free_list(state.free_bodies, state.bodies, BodyKind::kFree))
    return corrupt("free body", 0);
  if (!is_free_list(state.free_shapes, state.shapes, ShapeKind::kFree))
    return corrupt("free shape", 0);
  if (!is_free_list(state.free_joints, state.joints, JointKind::kFree))
    return corrupt("free joint", 0);
  if (!is_free_list(state.free_particles, state.particles, 0u)) return corrupt("free particle", 0);
  if (!is_free_list(state.free_links, state.links, 0u)) return corrupt("free link", 0);
  if (!is_free_list(state.free_pins, state.pins, 0u)) return corrupt("free pin", 0);
  return {};
}

template Error validate(const WorldState<2>&);
template Error validate(const WorldState<3>&);

}  // namespace cycloid::solver
