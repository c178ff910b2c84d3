#include <algorithm>

#include "solver/constraints/joints/unwrap.hpp"
#include "solver/constraints/rows.hpp"
#include "solver/events.hpp"
#include "solver/forget_pairs.hpp"
#include "solver/mass.hpp"
#include "solver/shapes.hpp"
#include "solver/slots.hpp"
#include "solver/solids/polyhedra.hpp"
#include "solver/step_memory.hpp"
#include "solver/validate.hpp"
#include "solver/wake.hpp"
#include "solver/workers.hpp"
#include "solver/world.hpp"

namespace cycloid::solver {

template <int D>
static bool is_movable(BodyKind kind) {
  return kind == BodyKind::kDynamic || kind == BodyKind::kParticle;
}

/// Sets mass, inertia and centre of a body; kInvalid "mass" where nothing gives it any.
template <int D>
static Error set_mass_properties(const BodyDef<D>& def, std::span<const ShapeDef<D>> defs,
                                 const std::vector<Shape<D>>& shapes, const Polyhedra& hulls,
                                 const std::vector<int>& def_of, Body<D>& body) {
  body.local_center = Vec<D>::zero();
  if (!is_movable<D>(def.kind)) return {};
  std::vector<float> densities;
  for (const int i : def_of) densities.push_back(defs[static_cast<std::size_t>(i)].density);
  CentralMass<D> shaped = central_mass<D>(shapes, densities, hulls);
  const bool stated = def.mass != 0.0f;
  if (!stated && !within(shaped.mass, kMassMin, kMassMax)) return {Code::kInvalid, "mass"};
  // A stated mass is shared out as the densities say, and by volume alone where they say nothing.
  if (stated && shaped.mass == 0.0f) {
    std::fill(densities.begin(), densities.end(), 1.0f);
    shaped = central_mass<D>(shapes, densities, hulls);
  }
  // What the densities of a stated mass come to may be far less, or more, than any mass may be.
  constexpr float kShapedMin = 1.0e-25f;
  constexpr float kShapedMax = 1.0e25f;
  body.mass = stated ? def.mass : shaped.mass;
  body.inverse_mass = 1.0f / body.mass;
  if (!within(shaped.mass, kShapedMin, kShapedMax)) return {};
  body.local_center = shaped.centre;
  if (def.kind == BodyKind::kParticle) return {};
  body.inertia = thickened(shaped.inertia);
  for (float& moment : body.inertia.m) moment *= body.mass / shaped.mass;
  if (!def.fixed_rotation) body.inverse_inertia = inverse(body.inertia);
  return {};
}

template <int D>
static Body<D> body_from(const BodyDef<D>& def) {
  Body<D> body{};
  body.kind = def.kind;
  body.fixed_rotation = def.fixed_rotation || def.kind == BodyKind::kParticle ? 1 : 0;
  body.first_shape = kNone;
  body.tag = {static_cast<std::uint32_t>(def.tag), static_cast<std::uint32_t>(def.tag >> 32)};
  body.rotation = normalized_or(def.rotation, identity_rotation<D>());
  body.velocity = def.velocity;
  body.spin = body.fixed_rotation != 0 ? Spin<D>::zero() : def.spin;
  body.linear_damping = def.linear_damping;
  body.angular_damping = def.angular_damping;
  body.gravity_scale = def.gravity_scale;
  return body;
}

/// Farthest point and thinnest place of a body with its shapes in place.
template <int D>
static void set_size(const std::vector<Shape<D>>& shapes, Body<D>& body) {
  body.extent = 0.0f;
  body.thickness = 0.0f;
  for (std::uint32_t s = body.first_shape; s != kNone; s = shapes[s].next) {
    const Shape<D>& shape = shapes[s];
    if (shape.vertex_count == 0) continue;
    const float thickness = thickness_of(shape);
    body.extent = max(body.extent, extent_of(shape));
    body.thickness = body.thickness == 0.0f ? thickness : min(body.thickness, thickness);
  }
}

/// Slots are taken in the order of the shapes and linked back to front.
template <int D>
static void attach_shapes(const std::vector<Shape<D>>& shapes, std::uint32_t index,
                          std::vector<std::uint32_t>& free, std::vector<Shape<D>>& all,
                          Body<D>& body) {
  std::vector<std::uint32_t> slots;
  for (std::size_t i = 0; i < shapes.size(); ++i) slots.push_back(take_slot(all, free));
  for (std::size_t i = shapes.size(); i-- > 0;) {
    Shape<D>& shape = all[slots[i]];
    shape = shapes[i];
    shift_shape(body.local_center, shape);
    shape.body = index;
    shape.ordinal = static_cast<std::uint32_t>(i);
    shape.next = body.first_shape;
    body.first_shape = slots[i];
  }
}

template <int D>
Result<BodyId> World<D>::create_body(const BodyDef<D>& def, std::span<const ShapeDef<D>> defs) {
  if (const Error error = validate(def); !error.ok()) return error;
  std::vector<Shape<D>> shapes;
  std::vector<int> def_of;
  Polyhedra hulls;  // Their own, until nothing can fail any more.
  for (int i = 0; i < static_cast<int>(defs.size()); ++i) {
    const ShapeDef<D>& shape = defs[static_cast<std::size_t>(i)];
    if (const Error error = validate(shape, def.kind, state_.materials.size(), i); !error.ok())
      return error;
    if (const Error error = append_shapes(shape, i, shapes, hulls); !error.ok()) return error;
    def_of.resize(shapes.size(), i);
  }
  Body<D> body = body_from(def);
  if (const Error error = set_mass_properties(def, defs, shapes, hulls, def_of, body); !error.ok())
    return error;
  body.position = def.position + rotate(body.rotation, body.local_center);
  if (!within(body.position, kPositionMax)) return invalid("position");
  if (!has_room(state_.bodies, state_.free_bodies, 1, state_.header.limits.bodies))
    return Error{Code::kCapacity, "limits.bodies"};
  if (!has_room(state_.shapes, state_.free_shapes, shapes.size(), state_.header.limits.shapes))
    return Error{Code::kCapacity, "limits.shapes"};

  const std::uint32_t index = take_slot(state_.bodies, state_.free_bodies);
  body.generation = state_.bodies[index].generation;
  for (Shape<D>& shape : shapes) adopt_hull(hulls, state_.polyhedra, shape);
  state_.shapes.edit([&](std::vector<Shape<D>>& all) {
    attach_shapes(shapes, index, state_.free_shapes, all, body);
    set_size(all, body);
  });
  state_.bodies.edit_one(index, [&](Body<D>& slot) { slot = body; });
  // A static body may be put where others sleep, and neither would look for the other.
  if (body.inverse_mass == 0.0f) wake_all(state_, kept_->active_bodies);
  note_change(state_, body, kept_->pair_cache);
  kept_->active_bodies.touch(index);
  return BodyId{index, body.generation};
}

template <int D>
Error World<D>::destroy_body(BodyId id) {
  if (const Error error = check(id); !error.ok()) return error;
  for (std::uint32_t i = 0; i < state_.joints.size(); ++i) {
    const Joint<D>& joint = state_.joints[i];
    if (joint.kind == JointKind::kFree) continue;
    if (joint.body_a == id.index || joint.body_b == id.index)
      if (const Error error = destroy_joint({i, joint.generation}); !error.ok()) return error;
  }
  for (std::uint32_t i = 0; i < state_.pins.size(); ++i)
    if (state_.pins[i].kind != 0 && state_.pins[i].body == id.index)
      free_slot(i, state_.pins, state_.free_pins);
  const auto is_of_body = [&](const Contact<D>& contact) {
    return state_.shapes[contact.shape_a].body == id.index ||
           state_.shapes[contact.shape_b].body == id.index;
  };
  for (const Contact<D>& contact : state_.contacts) {
    if (!is_of_body(contact)) continue;
    wake(state_, state_.shapes[contact.shape_a].body, kept_->active_bodies);
    wake(state_, state_.shapes[contact.shape_b].body, kept_->active_bodies);
    if (contact.touching != 0) ended_.push_back(contact_event(state_, contact, false));
  }
  std::erase_if(state_.contacts, is_of_body);
  kept_->active_contacts.is_known = false;
  kept_->active_bodies.touch(id.index);
  note_change(state_, state_.bodies[id.index], kept_->pair_cache);
  state_.shapes.edit([&](std::vector<Shape<D>>& shapes) {
    for (std::uint32_t s = state_.bodies[id.index].first_shape; s != kNone;) {
      const std::uint32_t next = shapes[s].next;
      abandon_hull(shapes[s], state_.polyhedra);
      shapes[s] = Shape<D>{};
      state_.free_shapes.push_back(s);
      s = next;
    }
  });
  free_slot(id.index, state_.bodies, state_.free_bodies);
  return {};
}

template <int D>
static Vec<D> anchor_from(const Body<D>& body, const Vec<D>& anchor) {
  return anchor - body.local_center;
}

template <int D>
static Joint<D> joint_from(const JointDef<D>& def, const Body<D>& a, const Body<D>& b) {
  Joint<D> joint{};
  joint.kind = def.kind;
  joint.body_a = def.body_a.index;
  joint.body_b = def.body_b.index;
  joint.anchor_a = anchor_from(a, def.anchor_a);
  joint.anchor_b = anchor_from(b, def.anchor_b);
  joint.axis = def.axis;
  joint.axle = def.axle;
  joint.steering = def.steering;
  joint.cone = def.cone;
  joint.length = def.length;
  joint.ratio = def.ratio;
  joint.hertz = def.hertz;
  joint.damping_ratio = def.damping_ratio;
  joint.angular_hertz = def.angular_hertz;
  joint.angular_damping_ratio = def.angular_damping_ratio;
  joint.reference = compose(conjugate(a.rotation), b.rotation);
  joint.limit_enabled = def.limit_enabled ? 1 : 0;
  joint.lower = def.lower;
  joint.upper = def.upper;
  joint.motor = def.motor;
  joint.motor_speed = def.motor_speed;
  joint.motor_max = def.motor_max;
  joint.target = def.target;
  joint.drive_amplitude = def.drive_amplitude;
  joint.drive_hertz = def.drive_hertz;
  joint.force_max = def.force_max;
  joint.torque_max = def.torque_max;
  joint.ground_a = def.ground_a;
  joint.ground_b = def.ground_b;
  joint.curve = def.curve;
  joint.size = def.size;
  joint.user_kind = def.user_kind;
  joint.parameters = def.parameters;
  joint.collide_connected = def.collide_connected ? 1 : 0;
  return joint;
}

/// What a joint takes from the poses at its creation: the sum of a gear's angles, the length of a
/// pulley's rope where none is given.
template <int D>
static void take_rest_values(const WorldState<D>& state, Joint<D>& joint) {
  const Body<D>& a = state.bodies[joint.body_a];
  const Body<D>& b = state.bodies[joint.body_b];
  joint.unwrapped = {unwrapped_angle(a.rotation, 0.0f), unwrapped_angle(b.rotation, 0.0f)};
  const bool rope_of_its_own = joint.kind == JointKind::kPulley && joint.length == 0.0f;
  if (joint.kind != JointKind::kGear && !rope_of_its_own) return;
  JointRows<D> rows;
  rows_of(
      make_frame(state, joint, a.position, b.position - a.position, a.rotation, b.rotation, 0.0f),
      rows);
  if (joint.kind == JointKind::kGear) joint.target = rows.rows[0].error;
  if (rope_of_its_own) joint.length = rows.has_axis ? rows.axis.error : rows.rows[0].error;
}

template <int D>
static bool has_outline(const WorldState<D>& state, std::uint32_t body) {
  for (std::uint32_t s = state.bodies[body].first_shape; s != kNone; s = state.shapes[s].next) {
    const ShapeKind kind = state.shapes[s].kind;
    if (kind == ShapeKind::kSegment || kind == ShapeKind::kPolygon) return true;
  }
  return false;
}

template <int D>
Result<JointId> World<D>::create_joint(const JointDef<D>& def) {
  if (!contains(def.body_a)) return Error{Code::kUnknownId, "body_a"};
  if (!contains(def.body_b)) return Error{Code::kUnknownId, "body_b"};
  if (const Error error = validate(def); !error.ok()) return error;
  const Body<D>& a = state_.bodies[def.body_a.index];
  const Body<D>& b = state_.bodies[def.body_b.index];
  if (a.inverse_mass == 0.0f && b.inverse_mass == 0.0f) return Error{Code::kInvalid, "body_b"};
  if (def.kind == JointKind::kUser &&
      find_rows_function<D>(kept_->user_rows, def.user_kind) == nullptr)
    return Error{Code::kInvalid, "user_kind"};
  if (def.kind == JointKind::kCurve && def.curve == CurveKind::kPolyline &&
      !has_outline(state_, def.body_a.index))
    return Error{Code::kInvalid, "curve"};
  if (!has_room(state_.joints, state_.free_joints, 1, state_.header.limits.joints))
    return Error{Code::kCapacity, "limits.joints"};

  const std::uint32_t index = take_slot(state_.joints, state_.free_joints);
  Joint<D> joint = joint_from(def, a, b);
  joint.generation = state_.joints[index].generation;
  take_rest_values(state_, joint);
  state_.joints.edit_one(index, [&](Joint<D>& slot) { slot = joint; });
  note_joint(state_, joint, kept_->pair_cache);
  wake_both(state_, joint, kept_->active_bodies);
  return JointId{index, joint.generation};
}

template <int D>
Error World<D>::destroy_joint(JointId id) {
  if (const Error error = check(id); !error.ok()) return error;
  const Joint<D>& joint = state_.joints[id.index];
  note_joint(state_, joint, kept_->pair_cache);
  wake_both(state_, joint, kept_->active_bodies);
  free_slot(id.index, state_.joints, state_.free_joints);
  return {};
}

template <int D>
void World<D>::register_constraint(std::uint32_t user_kind, RowsFunction<D> function) {
  for (UserRows<D>& rows : kept_->user_rows)
    if (rows.user_kind == user_kind) {
      rows.function = function;
      return;
    }
  kept_->user_rows.push_back({user_kind, function});
}

template void World<2>::register_constraint(std::uint32_t, RowsFunction<2>);
template void World<3>::register_constraint(std::uint32_t, RowsFunction<3>);
template Result<BodyId> World<2>::create_body(const BodyDef<2>&, std::span<const ShapeDef<2>>);
template Result<BodyId> World<3>::create_body(const BodyDef<3>&, std::span<const ShapeDef<3>>);
template Error World<2>::destroy_body(BodyId);
template Error World<3>::destroy_body(BodyId);
template Result<JointId> World<2>::create_joint(const JointDef<2>&);
template Result<JointId> World<3>::create_joint(const JointDef<3>&);
template Error World<2>::destroy_joint(JointId);
template Error World<3>::destroy_joint(JointId);

}  // namespace cycloid::solver
