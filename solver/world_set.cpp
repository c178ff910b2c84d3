#include "solver/constraints/joints/swing_twist.hpp"
#include "solver/forget_pairs.hpp"
#include "solver/step_memory.hpp"
#include "solver/trig.hpp"
#include "solver/validate.hpp"
#include "solver/wake.hpp"
#include "solver/workers.hpp"
#include "solver/world.hpp"

namespace cycloid::solver {

/// Adds `change` to `sum` unless that leaves the bound; then nothing has changed.
template <int N>
static bool add_within(Vec<N>& sum, const Vec<N>& change, float bound) {
  const Vec<N> result = sum + change;
  if (!within(result, bound)) return false;
  sum = result;
  return true;
}

template <int D>
Error World<D>::apply_force(BodyId id, const Vec<D>& force_n) {
  if (const Error error = check(id); !error.ok()) return error;
  const BodyProperties<D>& kept = state_.bodies[id.index];
  BodyMotion<D>& body = touched(id);
  const Vec<D> answered = kept.inverse_mass == 0.0f ? Vec<D>::zero() : force_n;
  if (!within(force_n, kForceMax) || !add_within(body.force, answered, kForceMax))
    return invalid("force_n");
  return {};
}

template <int D>
Error World<D>::apply_torque(BodyId id, const Spin<D>& torque_n_m) {
  if (const Error error = check(id); !error.ok()) return error;
  const BodyProperties<D>& kept = state_.bodies[id.index];
  BodyMotion<D>& body = touched(id);
  const Spin<D> answered = kept.inverse_mass == 0.0f ? Spin<D>::zero() : torque_n_m;
  if (!within(torque_n_m, kForceMax) || !add_within(body.torque, answered, kForceMax))
    return invalid("torque_n_m");
  return {};
}

template <int D>
Error World<D>::apply_impulse(BodyId id, const Vec<D>& impulse_n_s) {
  if (const Error error = check(id); !error.ok()) return error;
  const BodyProperties<D>& kept = state_.bodies[id.index];
  BodyMotion<D>& body = touched(id);
  if (!within(impulse_n_s, kForceMax)) return invalid("impulse_n_s");
  if (!add_within(body.velocity, kept.inverse_mass * impulse_n_s, kSpeedMax))
    return invalid("impulse_n_s");
  return {};
}

template <int D>
Error World<D>::apply_angular_impulse(BodyId id, const Spin<D>& impulse_n_m_s) {
  if (const Error error = check(id); !error.ok()) return error;
  const BodyProperties<D>& kept = state_.bodies[id.index];
  BodyMotion<D>& body = touched(id);
  if (!within(impulse_n_m_s, kForceMax)) return invalid("impulse_n_m_s");
  const Inertia<D> inverse = world_inertia(kept.inverse_inertia, body.rotation);
  if (!add_within(body.spin, inverse * impulse_n_m_s, kSpinMax)) return invalid("impulse_n_m_s");
  return {};
}

template <int D>
Error World<D>::set_velocity(BodyId id, const Vec<D>& velocity, const Spin<D>& spin) {
  if (const Error error = check(id); !error.ok()) return error;
  const BodyProperties<D>& kept = state_.bodies[id.index];
  BodyMotion<D>& body = touched(id);
  if (!within(velocity, kSpeedMax)) return invalid("velocity");
  if (!within(spin, kSpinMax)) return invalid("spin");
  if (kept.kind == BodyKind::kStatic) return invalid("body");
  body.velocity = velocity;
  if (kept.fixed_rotation == 0) body.spin = spin;
  return {};
}

template <int D>
Error World<D>::set_pose(BodyId id, const Vec<D>& position, const Rotation<D>& rotation) {
  if (const Error error = check(id); !error.ok()) return error;
  if (!within(position, kPositionMax)) return invalid("position");
  if (!within(dot(rotation, rotation), 0.998f, 1.002f)) return invalid("rotation");
  const Rotation<D> unit = normalized_or(rotation, rotation);
  const Vec<D> centre = position + rotate(unit, state_.bodies[id.index].local_center);
  if (!within(centre, kPositionMax)) return invalid("position");
  BodyMotion<D>& body = state_.bodies.moved(id.index);
  body.rotation = unit;
  body.position = centre;
  note_move(state_.bodies[id.index], kept_->pair_cache);
  // Nobody looks for the pairs of two bodies that rest, so what may touch it now has to look.
  wake_all(state_, kept_->active_bodies);
  return {};
}

template <int D>
Error World<D>::set_gravity(const Vec<D>& gravity) {
  if (!within(gravity, 1.0e4f)) return invalid("gravity");
  state_.header.gravity = gravity;
  wake_all(state_, kept_->active_bodies);
  return {};
}

template <int D>
Error World<D>::set_gravity_scale(BodyId id, float scale) {
  if (const Error error = check(id); !error.ok()) return error;
  if (!within(scale, -1.0e3f, 1.0e3f)) return invalid("scale");
  state_.bodies.edit_one(id.index, [&](Body<D>& body) { body.gravity_scale = scale; });
  wake(state_, id.index, kept_->active_bodies);
  return {};
}

template <int D>
Error World<D>::set_damping(BodyId id, float linear, float angular) {
  if (const Error error = check(id); !error.ok()) return error;
  if (!within(linear, 0.0f, 1.0e4f)) return invalid("linear");
  if (!within(angular, 0.0f, 1.0e4f)) return invalid("angular");
  state_.bodies.edit_one(id.index, [&](Body<D>& body) {
    body.linear_damping = linear;
    body.angular_damping = angular;
  });
  wake(state_, id.index, kept_->active_bodies);
  return {};
}

template <int D>
Error World<D>::set_mass(BodyId id, float mass_kg) {
  if (const Error error = check(id); !error.ok()) return error;
  if (state_.bodies[id.index].inverse_mass == 0.0f) return invalid("body");
  if (!within(mass_kg, kMassMin, kMassMax)) return invalid("mass_kg");
  state_.bodies.edit_one(id.index, [&](Body<D>& body) {
    const float scale = mass_kg / body.mass;
    body.mass = mass_kg;
    body.inverse_mass = 1.0f / mass_kg;
    for (float& moment : body.inertia.m) moment *= scale;
    for (float& moment : body.inverse_inertia.m) moment *= 1.0f / scale;
  });
  wake(state_, id.index, kept_->active_bodies);
  return {};
}

template <int D>
Error World<D>::set_material(std::uint32_t material, const Material& values) {
  if (material >= state_.materials.size()) return invalid("material");
  if (const Error error = validate(values, static_cast<int>(material)); !error.ok()) return error;
  state_.materials[material] = values;
  wake_all(state_, kept_->active_bodies);
  return {};
}

template <int D>
Error World<D>::set_filter(BodyId id, std::uint32_t shape, const Filter& filter) {
  if (const Error error = check(id); !error.ok()) return error;
  for (std::uint32_t s = state_.bodies[id.index].first_shape; s != kNone; s = state_.shapes[s].next)
    if (state_.shapes[s].ordinal == shape) {
      state_.shapes.edit([&](std::vector<Shape<D>>& shapes) { shapes[s].filter = filter; });
      note_change(state_, state_.bodies[id.index], kept_->pair_cache);
      wake_all(state_, kept_->active_bodies);
      return {};
    }
  return invalid("shape");
}

template <int D>
static bool is_drivable(const Joint<D>& joint) {
  return has_coordinate(joint.kind, Dim<D>::kSpin);
}

template <int D>
Error World<D>::set_motor(JointId id, bool enabled, float speed, float max) {
  if (const Error error = check(id); !error.ok()) return error;
  const Joint<D>& joint = state_.joints[id.index];
  if (enabled && !is_drivable(joint)) return invalid("enabled");
  if (!within(speed, -kSpinMax, kSpinMax)) return invalid("speed");
  if (!within(max, 0.0f, kForceMax)) return invalid("max");
  const MotorKind motor = enabled ? MotorKind::kSpeed : MotorKind::kOff;
  // Controls say this in every tick; only what changes wakes.
  if (joint.motor == motor && joint.motor_speed == speed && joint.motor_max == max) return {};
  wake_both(state_, joint, kept_->active_bodies);
  state_.joints.edit_one(id.index, [&](Joint<D>& edited) {
    edited.motor = motor;
    edited.motor_speed = speed;
    edited.motor_max = max;
  });
  return {};
}

template <int D>
Error World<D>::set_target(JointId id, float target, float max) {
  if (const Error error = check(id); !error.ok()) return error;
  const Joint<D>& joint = state_.joints[id.index];
  if (!is_drivable(joint) || joint.kind == JointKind::kWheel) return invalid("joint");
  if (!within(target, -kSizeMax, kSizeMax)) return invalid("target");
  if (!within(max, 0.0f, kForceMax)) return invalid("max");
  if (joint.motor == MotorKind::kPosition && joint.target == target && joint.motor_max == max)
    return {};
  wake_both(state_, joint, kept_->active_bodies);
  state_.joints.edit_one(id.index, [&](Joint<D>& edited) {
    edited.motor = MotorKind::kPosition;
    edited.target = target;
    edited.motor_max = max;
  });
  return {};
}

template <int D>
Error World<D>::set_steering(JointId id, float angle) {
  if (const Error error = check(id); !error.ok()) return error;
  const Joint<D>& joint = state_.joints[id.index];
  if (joint.kind != JointKind::kWheel || Dim<D>::kSpin == 1) return invalid("joint");
  if (!within(angle, -kSteeringMax, kSteeringMax)) return invalid("angle");
  if (joint.steering == angle) return {};
  wake_both(state_, joint, kept_->active_bodies);
  state_.joints.edit_one(id.index, [&](Joint<D>& edited) { edited.steering = angle; });
  return {};
}

template <int D>
Error World<D>::set_anchor(JointId id, const Vec<D>& anchor_a) {
  if (const Error error = check(id); !error.ok()) return error;
  if (!within(anchor_a, kSizeMax)) return invalid("anchor_a");
  const Joint<D>& joint = state_.joints[id.index];
  wake_both(state_, joint, kept_->active_bodies);
  const Vec<D> from_centre = anchor_a - state_.bodies[joint.body_a].local_center;
  state_.joints.edit_one(id.index, [&](Joint<D>& edited) { edited.anchor_a = from_centre; });
  return {};
}

template <int D>
Error World<D>::set_limits(JointId id, bool enabled, float lower, float upper) {
  if (const Error error = check(id); !error.ok()) return error;
  const Joint<D>& joint = state_.joints[id.index];
  if (enabled && !has_limits(joint.kind, Dim<D>::kSpin)) return invalid("enabled");
  const float bound = limit_max(joint.kind);
  if (!within(lower, -bound, bound)) return invalid("lower");
  if (!within(upper, lower, bound)) return invalid("upper");
  wake_both(state_, joint, kept_->active_bodies);
  state_.joints.edit_one(id.index, [&](Joint<D>& edited) {
    edited.limit_enabled = enabled ? 1 : 0;
    edited.lower = lower;
    edited.upper = upper;
  });
  return {};
}

template <int D>
Error World<D>::set_spring(JointId id, float length, float hertz, float damping_ratio) {
  if (const Error error = check(id); !error.ok()) return error;
  const Joint<D>& joint = state_.joints[id.index];
  if (joint.kind != JointKind::kDistance) return invalid("joint");
  if (!within(length, kSizeMin, kSizeMax)) return invalid("length");
  if (!within(hertz, 0.0f, 1.0e5f)) return invalid("hertz");
  if (!within(damping_ratio, 0.0f, 1.0e3f)) return invalid("damping_ratio");
  wake_both(state_, joint, kept_->active_bodies);
  state_.joints.edit_one(id.index, [&](Joint<D>& edited) {
    edited.length = length;
    edited.hertz = hertz;
    edited.damping_ratio = damping_ratio;
  });
  return {};
}

/// An impulse is a force times h: what was found for one step length is scaled to the other, or the
/// next tick starts with too much or too little of it.
template <int D>
static void scale_impulses(float scale, WorldState<D>& state) {
  for (Contact<D>& contact : state.contacts) {
    for (ContactPoint<D>& point : contact.points) {
      point.normal_impulse *= scale;
      point.tangent_impulse = scale * point.tangent_impulse;
    }
    contact.rolling_impulse = scale * contact.rolling_impulse;
  }
  for (std::size_t i = 0; i < state.joints.size(); ++i) {
    if (state.joints[i].kind == JointKind::kFree) continue;
    JointImpulses<D>& joint = state.joints.moved(i);
    for (float& impulse : joint.impulse) impulse *= scale;
    for (float* impulse : {&joint.spring_impulse, &joint.motor_impulse, &joint.lower_impulse,
                           &joint.upper_impulse, &joint.cone_impulse})
      *impulse *= scale;
  }
}

template <int D>
Error World<D>::set_tuning(const Tuning& tuning) {
  if (const Error error = validate(tuning); !error.ok()) return error;
  Tuning& old = state_.header.tuning;
  if (tuning.substeps != old.substeps)
    scale_impulses(static_cast<float>(old.substeps) / static_cast<float>(tuning.substeps), state_);
  old = tuning;
  kept_->pair_cache.forget_all();
  wake_all(state_, kept_->active_bodies);
  return {};
}

/// Angle about the plane's axis of b relative to a, since creation.
static float angle_of(const Body<2>& a, const Body<2>& b, const Joint<2>& joint) {
  const Rotation<2> turned = compose(Rotation<2>{{a.rotation[0], -a.rotation[1]}}, b.rotation);
  const Rotation<2> since = compose(Rotation<2>{{joint.reference[0], -joint.reference[1]}}, turned);
  return atan2(since[1], since[0]);
}
/// Angle about a hinge's axis.
static float angle_of(const Body<3>& a, const Body<3>& b, const Joint<3>& joint) {
  const Rotation<3> turned = compose(conjugate(a.rotation), b.rotation);
  const Rotation<3> since = compose(conjugate(joint.reference), turned);
  return twist_angle(since, rotate_back(joint.reference, joint.axis));
}

template <int D>
Result<float> World<D>::joint_angle(JointId id) const {
  if (const Error error = check(id); !error.ok()) return error;
  const Joint<D>& joint = state_.joints[id.index];
  const JointKind turning = Dim<D>::kSpin == 1 ? JointKind::kRevolute : JointKind::kHinge;
  if (joint.kind != turning) return invalid("joint");
  return angle_of(state_.bodies[joint.body_a], state_.bodies[joint.body_b], joint);
}

template <int D>
Result<float> World<D>::joint_separation(JointId id) const {
  if (const Error error = check(id); !error.ok()) return error;
  const Joint<D>& joint = state_.joints[id.index];
  const Body<D>& a = state_.bodies[joint.body_a];
  const Body<D>& b = state_.bodies[joint.body_b];
  const Vec<D> between = (b.position - a.position) + rotate(b.rotation, joint.anchor_b) -
                         rotate(a.rotation, joint.anchor_a);
  return length(between);
}

template Error World<2>::apply_force(BodyId, const Vec<2>&);
template Error World<2>::apply_torque(BodyId, const Spin<2>&);
template Error World<2>::apply_impulse(BodyId, const Vec<2>&);
template Error World<2>::apply_angular_impulse(BodyId, const Spin<2>&);
template Error World<2>::set_velocity(BodyId, const Vec<2>&, const Spin<2>&);
template Error World<2>::set_pose(BodyId, const Vec<2>&, const Rotation<2>&);
template Error World<2>::set_gravity(const Vec<2>&);
template Error World<2>::set_gravity_scale(BodyId, float);
template Error World<2>::set_damping(BodyId, float, float);
template Error World<2>::set_mass(BodyId, float);
template Error World<2>::set_material(std::uint32_t, const Material&);
template Error World<2>::set_filter(BodyId, std::uint32_t, const Filter&);
template Error World<2>::set_motor(JointId, bool, float, float);
template Error World<2>::set_target(JointId, float, float);
template Error World<2>::set_anchor(JointId, const Vec<2>&);
template Error World<2>::set_steering(JointId, float);
template Error World<3>::set_steering(JointId, float);
template Error World<3>::set_target(JointId, float, float);
template Error World<3>::set_anchor(JointId, const Vec<3>&);
template Error World<2>::set_limits(JointId, bool, float, float);
template Error World<2>::set_spring(JointId, float, float, float);
template Error World<2>::set_tuning(const Tuning&);
template Result<float> World<2>::joint_angle(JointId) const;
template Result<float> World<2>::joint_separation(JointId) const;
template Error World<3>::apply_force(BodyId, const Vec<3>&);
template Error World<3>::apply_torque(BodyId, const Spin<3>&);
template Error World<3>::apply_impulse(BodyId, const Vec<3>&);
template Error World<3>::apply_angular_impulse(BodyId, const Spin<3>&);
template Error World<3>::set_velocity(BodyId, const Vec<3>&, const Spin<3>&);
template Error World<3>::set_pose(BodyId, const Vec<3>&, const Rotation<3>&);
template Error World<3>::set_gravity(const Vec<3>&);
template Error World<3>::set_gravity_scale(BodyId, float);
template Error World<3>::set_damping(BodyId, float, float);
template Error World<3>::set_mass(BodyId, float);
template Error World<3>::set_material(std::uint32_t, const Material&);
template Error World<3>::set_filter(BodyId, std::uint32_t, const Filter&);
template Error World<3>::set_motor(JointId, bool, float, float);
template Error World<3>::set_limits(JointId, bool, float, float);
template Error World<3>::set_spring(JointId, float, float, float);
template Error World<3>::set_tuning(const Tuning&);
template Result<float> World<3>::joint_angle(JointId) const;
template Result<float> World<3>::joint_separation(JointId) const;

}  // namespace cycloid::solver
