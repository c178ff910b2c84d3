#pragma once

#include <cstddef>

#include "solver/state.hpp"

namespace cycloid::solver {

/// One list of the fields of each record, by name: encoding, decoding, digest and comparison walk
/// these and nothing else. `R` is a record or a const record; `f` is called as f(name, field).

template <class R, class F>
constexpr void visit_fields(R& r, F&& f, const Material*) {
  f("friction", r.friction);
  f("restitution", r.restitution);
  f("rolling_resistance", r.rolling_resistance);
  f("twist_resistance", r.twist_resistance);
}

template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const BodyProperties<D>*) {
  f("generation", r.generation);
  f("kind", r.kind);
  f("fixed_rotation", r.fixed_rotation);
  f("first_shape", r.first_shape);
  f("tag", r.tag);
  f("mass", r.mass);
  f("inverse_mass", r.inverse_mass);
  f("inertia", r.inertia);
  f("inverse_inertia", r.inverse_inertia);
  f("local_center", r.local_center);
  f("linear_damping", r.linear_damping);
  f("angular_damping", r.angular_damping);
  f("gravity_scale", r.gravity_scale);
  f("extent", r.extent);
  f("thickness", r.thickness);
}

template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const BodyMotion<D>*) {
  f("position", r.position);
  f("rotation", r.rotation);
  f("velocity", r.velocity);
  f("spin", r.spin);
  f("force", r.force);
  f("torque", r.torque);
  f("rest_ticks", r.rest_ticks);
  f("asleep", r.asleep);
}

template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const Body<D>*) {
  visit_fields(r, f, static_cast<const BodyProperties<D>*>(nullptr));
  visit_fields(r, f, static_cast<const BodyMotion<D>*>(nullptr));
}

/// The part of a shape that is not the same in the plane and in space.
template <class R, class F>
requires requires(R& r) {
  r.normals;
}
constexpr void visit_outline(R& r, F&& f) {
  f("normals", r.normals);
}
template <class R, class F>
requires requires(R& r) {
  r.polyhedron;
}
constexpr void visit_outline(R& r, F&& f) {
  f("half", r.half);
  f("rotation", r.rotation);
  f("polyhedron", r.polyhedron);
}

template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const Shape<D>*) {
  f("kind", r.kind);
  f("body", r.body);
  f("next", r.next);
  f("ordinal", r.ordinal);
  f("material", r.material);
  f("filter.category", r.filter.category);
  f("filter.mask", r.filter.mask);
  f("filter.group", r.filter.group);
  f("vertex_count", r.vertex_count);
  f("ghosts", r.ghosts);
  f("radius", r.radius);
  f("offset", r.offset);
  f("normal", r.normal);
  f("vertices", r.vertices);
  visit_outline(r, f);
}

template <class R, class F>
constexpr void visit_fields(R& r, F&& f, const Polyhedron*) {
  f("references", r.references);
  f("first_vertex", r.first_vertex);
  f("vertex_count", r.vertex_count);
  f("first_face", r.first_face);
  f("face_count", r.face_count);
  f("first_edge", r.first_edge);
  f("edge_count", r.edge_count);
}

template <class R, class F>
constexpr void visit_fields(R& r, F&& f, const PolyhedronVertex*) {
  f("position", r.position);
  f("edge", r.edge);
}

template <class R, class F>
constexpr void visit_fields(R& r, F&& f, const PolyhedronFace*) {
  f("normal", r.normal);
  f("offset", r.offset);
  f("edge", r.edge);
}

template <class R, class F>
constexpr void visit_fields(R& r, F&& f, const PolyhedronEdge*) {
  f("origin", r.origin);
  f("twin", r.twin);
  f("next", r.next);
  f("face", r.face);
}

template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const ContactPoint<D>*) {
  f("feature", r.feature);
  f("normal_impulse", r.normal_impulse);
  f("tangent_impulse", r.tangent_impulse);
}

template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const Contact<D>*) {
  f("shape_a", r.shape_a);
  f("shape_b", r.shape_b);
  f("touching", r.touching);
  f("point_count", r.point_count);
  f("points", r.points);
  f("rolling_impulse", r.rolling_impulse);
}

template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const JointProperties<D>*) {
  f("generation", r.generation);
  f("kind", r.kind);
  f("body_a", r.body_a);
  f("body_b", r.body_b);
  f("anchor_a", r.anchor_a);
  f("anchor_b", r.anchor_b);
  f("axis", r.axis);
  f("axle", r.axle);
  f("steering", r.steering);
  f("cone", r.cone);
  f("length", r.length);
  f("ratio", r.ratio);
  f("hertz", r.hertz);
  f("damping_ratio", r.damping_ratio);
  f("angular_hertz", r.angular_hertz);
  f("angular_damping_ratio", r.angular_damping_ratio);
  f("reference", r.reference);
  f("limit_enabled", r.limit_enabled);
  f("lower", r.lower);
  f("upper", r.upper);
  f("motor", r.motor);
  f("motor_speed", r.motor_speed);
  f("motor_max", r.motor_max);
  f("target", r.target);
  f("drive_amplitude", r.drive_amplitude);
  f("drive_hertz", r.drive_hertz);
  f("force_max", r.force_max);
  f("torque_max", r.torque_max);
  f("ground_a", r.ground_a);
  f("ground_b", r.ground_b);
  f("curve", r.curve);
  f("size", r.size);
  f("user_kind", r.user_kind);
  f("parameters", r.parameters);
  f("collide_connected", r.collide_connected);
}

template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const JointImpulses<D>*) {
  f("unwrapped", r.unwrapped);
  f("impulse", r.impulse);
  f("spring_impulse", r.spring_impulse);
  f("motor_impulse", r.motor_impulse);
  f("lower_impulse", r.lower_impulse);
  f("upper_impulse", r.upper_impulse);
  f("cone_impulse", r.cone_impulse);
}

template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const Joint<D>*) {
  visit_fields(r, f, static_cast<const JointProperties<D>*>(nullptr));
  visit_fields(r, f, static_cast<const JointImpulses<D>*>(nullptr));
}

template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const Particle<D>*) {
  f("generation", r.generation);
  f("kind", r.kind);
  f("material", r.material);
  f("group", r.group);
  f("filter.category", r.filter.category);
  f("filter.mask", r.filter.mask);
  f("filter.group", r.filter.group);
  f("position", r.position);
  f("velocity", r.velocity);
  f("inverse_mass", r.inverse_mass);
  f("radius", r.radius);
}

template <class R, class F>
constexpr void visit_fields(R& r, F&& f, const Link*) {
  f("generation", r.generation);
  f("kind", r.kind);
  f("particle_a", r.particle_a);
  f("particle_b", r.particle_b);
  f("length", r.length);
  f("compliance", r.compliance);
}

template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const Pin<D>*) {
  f("generation", r.generation);
  f("kind", r.kind);
  f("particle", r.particle);
  f("body", r.body);
  f("anchor", r.anchor);
}

template <class R, class F>
constexpr void visit_fields(R& r, F&& f, const Tuning*) {
  f("tuning.substeps", r.substeps);
  f("tuning.sweeps", r.sweeps);
  f("tuning.relax_sweeps", r.relax_sweeps);
  f("tuning.position_sweeps", r.position_sweeps);
  f("tuning.stabilisation", r.stabilisation);
  f("tuning.order", r.order);
  f("tuning.contact_block", r.contact_block);
  f("tuning.joint_solver", r.joint_solver);
  f("tuning.warm_starting", r.warm_starting);
  f("tuning.over_relaxation", r.over_relaxation);
  f("tuning.baumgarte", r.baumgarte);
  f("tuning.slop", r.slop);
  f("tuning.correction_max", r.correction_max);
  f("tuning.contact_hertz", r.contact_hertz);
  f("tuning.contact_damping_ratio", r.contact_damping_ratio);
  f("tuning.joint_hertz", r.joint_hertz);
  f("tuning.joint_damping_ratio", r.joint_damping_ratio);
  f("tuning.push_speed_max", r.push_speed_max);
  f("tuning.restitution_threshold", r.restitution_threshold);
  f("tuning.speculative_distance", r.speculative_distance);
  f("tuning.sleep_s", r.sleep_s);
  f("tuning.sleep_speed", r.sleep_speed);
  f("tuning.continuous", r.continuous);
  f("tuning.particle_substeps", r.particle_substeps);
  f("tuning.particle_sweeps", r.particle_sweeps);
  f("tuning.particle_damping", r.particle_damping);
}

template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const WorldHeader<D>*) {
  f("tick", r.tick);
  f("fault.tick", r.fault.tick);
  f("fault.body.index", r.fault.body.index);
  f("fault.body.generation", r.fault.body.generation);
  f("fault.field", r.fault.field);
  f("gravity", r.gravity);
  f("tick_s", r.tick_s);
  f("tuning", r.tuning);
  f("limits.bodies", r.limits.bodies);
  f("limits.shapes", r.limits.shapes);
  f("limits.joints", r.limits.joints);
  f("limits.contacts", r.limits.contacts);
  f("limits.materials", r.limits.materials);
  f("limits.registers", r.limits.registers);
  f("limits.particles", r.limits.particles);
  f("limits.links", r.limits.links);
  f("limits.pins", r.limits.pins);
}

template <class R, class F>
constexpr void visit(R& record, F&& f) {
  visit_fields(record, f, static_cast<const std::remove_const_t<R>*>(nullptr));
}

/// Calls f(name, array), where an array that is to be changed is edited.
template <class Array, class F>
void visit_edited(const Array& array, const char* name, F&& f) {
  f(name, array);
}
template <class Array, class F>
void visit_edited(Array& array, const char* name, F&& f) {
  array.edit([&](auto& items) { f(name, items); });
}

/// The arrays of a state in canonical order: f(object name, array). An array that is to be changed
/// is a vector, good until f returns.
template <class S, class F>
void visit_arrays(S& state, F&& f) {
  f("material", state.materials);
  visit_edited(state.bodies, "body", f);
  f("free body", state.free_bodies);
  visit_edited(state.shapes, "shape", f);
  f("free shape", state.free_shapes);
  f("polyhedron", state.polyhedra.records);
  f("polyhedron vertex", state.polyhedra.vertices);
  f("polyhedron face", state.polyhedra.faces);
  f("polyhedron edge", state.polyhedra.edges);
  visit_edited(state.joints, "joint", f);
  f("free joint", state.free_joints);
  f("contact", state.contacts);
  f("register", state.registers);
  f("particle", state.particles);
  f("free particle", state.free_particles);
  visit_edited(state.links, "link", f);
  f("free link", state.free_links);
  f("pin", state.pins);
  f("free pin", state.free_pins);
}

template <class T>
inline constexpr bool kIsWord = std::is_arithmetic_v<T> || std::is_enum_v<T>;

/// What visits fields and does nothing: to ask whether a type has a list above. Not a lambda,
/// because Clang 14 crashes on one in a constraint.
struct FieldIgnorer {
  constexpr void operator()(const char*, auto&) const {}
};

/// Calls word(value) for each number of a field, innermost last; `field` is a number, a vector, an
/// array, or a record with fields of its own.
template <class F>
struct WordWalk {
  F& word;

  constexpr void operator()(const char*, auto& field) { walk(field); }

  template <class T>
  requires kIsWord<std::remove_const_t<T>>
  constexpr void walk(T& value) { word(value); }
  template <class T>
  requires requires(T& t) { t.v; }
  constexpr void walk(T& vector) {
    for (auto& value : vector.v) word(value);
  }
  template <class T>
  requires requires(T& t) { t.m; }
  constexpr void walk(T& inertia) {
    for (auto& value : inertia.m) word(value);
  }
  template <class T>
  requires requires(T& t) { t.size(); }
  constexpr void walk(T& array) {
    for (auto& element : array) walk(element);
  }
  template <class T>
  requires requires(T& t) {
    visit_fields(t, FieldIgnorer{}, static_cast<const std::remove_const_t<T>*>(nullptr));
  }
  constexpr void walk(T& record) { visit(record, *this); }
};

template <class R, class F>
constexpr void visit_words(R& record, F&& word) {
  WordWalk<std::remove_reference_t<F>> walk{word};
  walk.walk(record);
}

/// Bytes of all numbers that `visit` reaches in a record.
template <class R>
constexpr std::size_t visited_bytes() {
  R record{};
  std::size_t bytes = 0;
  visit_words(record, [&](auto& value) { bytes += sizeof value; });
  return bytes;
}

// A field that `visit` forgets would neither be saved nor hashed: a silent divergence. These fail
// when a record has bytes that no listed field covers, but for the padding at its end; the planar
// records have none, so no field hides there either.
template <class R>
inline constexpr bool kVisitsEverything = sizeof(R) == (visited_bytes<R>() + alignof(R) - 1) /
                                                           alignof(R) * alignof(R);
static_assert(visited_bytes<WorldHeader<2>>() == sizeof(WorldHeader<2>));
static_assert(kVisitsEverything<Material>);
static_assert(kVisitsEverything<Body<2>> && kVisitsEverything<Body<3>>);
static_assert(kVisitsEverything<Shape<2>> && kVisitsEverything<Shape<3>>);
static_assert(kVisitsEverything<Polyhedron> && kVisitsEverything<PolyhedronVertex>);
static_assert(kVisitsEverything<PolyhedronFace> && kVisitsEverything<PolyhedronEdge>);
static_assert(kVisitsEverything<Contact<2>> && kVisitsEverything<Contact<3>>);
static_assert(kVisitsEverything<Joint<2>> && kVisitsEverything<Joint<3>>);
static_assert(kVisitsEverything<Particle<2>> && kVisitsEverything<Particle<3>>);
static_assert(kVisitsEverything<Link>);
static_assert(kVisitsEverything<Pin<2>> && kVisitsEverything<Pin<3>>);
static_assert(kVisitsEverything<WorldHeader<2>> && kVisitsEverything<WorldHeader<3>>);

}  // namespace cycloid::solver
