#include "solver/trig.hpp"
#include "solver/validate.hpp"

namespace cycloid::solver {

bool exists(JointKind kind, int spin) {
  switch (kind) {
    case JointKind::kGear:
    case JointKind::kCurve:
      return spin == 1;
    case JointKind::kHinge:
    case JointKind::kConeTwist:
      return spin > 1;
    default:
      return kind >= JointKind::kDistance && kind <= JointKind::kConeTwist;
  }
}

bool has_coordinate(JointKind kind, int spin) {
  switch (kind) {
    case JointKind::kDistance:
    case JointKind::kPrismatic:
    case JointKind::kUser:
    case JointKind::kWheel:
      return true;
    case JointKind::kRevolute:
      return spin == 1;
    case JointKind::kHinge:
      return spin > 1;
    default:
      return false;
  }
}

bool has_limits(JointKind kind, int spin) {
  const bool of_curve = kind == JointKind::kCurve && spin == 1;
  const bool of_cone = kind == JointKind::kConeTwist && spin > 1;
  return has_coordinate(kind, spin) || kind == JointKind::kPulley || of_curve || of_cone;
}

float limit_max(JointKind kind) {
  const bool turns =
      kind == JointKind::kRevolute || kind == JointKind::kHinge || kind == JointKind::kConeTwist;
  return turns ? 3.2f : kSizeMax;
}

bool needs_axis(JointKind kind) {
  return kind == JointKind::kPrismatic || kind == JointKind::kWheel || kind == JointKind::kHinge ||
         kind == JointKind::kConeTwist;
}

bool fits_wheel(const Vec<2>&, const Vec<2>& axle) {
  return dot(axle, axle) == 0.0f;
}
bool fits_wheel(const Vec<3>& axis, const Vec<3>& axle) {
  return is_unit(axle) && within(dot(axis, axle), -1.0e-3f, 1.0e-3f);
}

/// What only joints of space have.
template <int D>
static Error validate_turns(const JointDef<D>& def) {
  const float axle = dot(def.axle, def.axle);
  const bool wheel = def.kind == JointKind::kWheel;
  if (axle != 0.0f && (Dim<D>::kSpin == 1 || !is_unit(def.axle))) return invalid("axle");
  if (wheel && !fits_wheel(def.axis, def.axle)) return invalid("axle");
  const float most = Dim<D>::kSpin == 1 ? 0.0f : kSteeringMax;
  if (!within(def.steering, -most, most)) return invalid("steering");
  if (!within(def.cone, 0.0f, kPi)) return invalid("cone");
  return {};
}

template <int D>
static Error validate_geometry(const JointDef<D>& def) {
  if (!within(def.anchor_a, kSizeMax)) return invalid("anchor_a");
  if (!within(def.anchor_b, kSizeMax)) return invalid("anchor_b");
  const float axis = dot(def.axis, def.axis);
  const bool unit = is_unit(def.axis);
  if (needs_axis(def.kind) && !unit) return invalid("axis");
  if (!unit && axis != 0.0f) return invalid("axis");
  if (const Error error = validate_turns(def); !error.ok()) return error;
  const bool distance = def.kind == JointKind::kDistance;
  const bool rope = def.limit_enabled && def.hertz == 0.0f;
  if (distance && !rope && !within(def.length, kSizeMin, kSizeMax)) return invalid("length");
  if (!within(def.length, 0.0f, kSizeMax)) return invalid("length");
  const float ratio = abs(def.ratio);
  if (!within(ratio, 1.0e-3f, 1.0e3f)) return invalid("ratio");
  if (!within(def.ground_a, kPositionMax)) return invalid("ground_a");
  if (!within(def.ground_b, kPositionMax)) return invalid("ground_b");
  // Also of a joint that has no curve: a state keeps it, and no enumerator in it may be unknown.
  if (def.curve > CurveKind::kPolyline) return invalid("curve");
  for (const float size : def.size)
    if (!within(size, 0.0f, kSizeMax)) return invalid("size");
  if (def.kind != JointKind::kCurve) return {};
  if (def.curve == CurveKind::kPolyline) return {};
  const bool two = def.curve == CurveKind::kEllipse;
  if (!within(def.size[0], kSizeMin, kSizeMax)) return invalid("size");
  if (two && !within(def.size[1], kSizeMin, kSizeMax)) return invalid("size");
  return {};
}

template <int D>
static Error validate_drives(const JointDef<D>& def) {
  if (!within(def.hertz, 0.0f, 1.0e5f)) return invalid("hertz");
  if (!within(def.damping_ratio, 0.0f, 1.0e3f)) return invalid("damping_ratio");
  if (!within(def.angular_hertz, 0.0f, 1.0e5f)) return invalid("angular_hertz");
  if (!within(def.angular_damping_ratio, 0.0f, 1.0e3f)) return invalid("angular_damping_ratio");
  if (def.limit_enabled && !has_limits(def.kind, Dim<D>::kSpin)) return invalid("limit_enabled");
  const float bound = limit_max(def.kind);
  if (!within(def.lower, -bound, bound)) return invalid("lower");
  if (!within(def.upper, def.lower, bound)) return invalid("upper");
  if (def.motor > MotorKind::kPosition) return invalid("motor");
  if (def.motor != MotorKind::kOff && !has_coordinate(def.kind, Dim<D>::kSpin))
    return invalid("motor");
  // The motor of a wheel turns for ever; it has no position to hold.
  if (def.motor == MotorKind::kPosition && def.kind == JointKind::kWheel) return invalid("motor");
  if (!within(def.motor_speed, -kSpinMax, kSpinMax)) return invalid("motor_speed");
  if (!within(def.motor_max, 0.0f, kForceMax)) return invalid("motor_max");
  if (!within(def.target, -kSizeMax, kSizeMax)) return invalid("target");
  if (!within(def.drive_amplitude, -kSizeMax, kSizeMax)) return invalid("drive_amplitude");
  if (!within(def.drive_hertz, 0.0f, 1.0e4f)) return invalid("drive_hertz");
  if (!within(def.force_max, 0.0f, kForceMax)) return invalid("force_max");
  if (!within(def.torque_max, 0.0f, kForceMax)) return invalid("torque_max");
  for (const float parameter : def.parameters)
    if (!within(parameter, -1.0e30f, 1.0e30f)) return invalid("parameters");
  return {};
}

template <int D>
Error validate(const JointDef<D>& def) {
  if (!exists(def.kind, Dim<D>::kSpin)) return invalid("kind");
  if (def.body_a == def.body_b) return invalid("body_b");
  if (const Error error = validate_geometry(def); !error.ok()) return error;
  return validate_drives(def);
}

/// The settings of a joint as its definition had them, but for its bodies and anchors.
template <int D>
static JointDef<D> settings_of(const Joint<D>& joint) {
  JointDef<D> def;
  def.kind = joint.kind;
  def.body_a.index = joint.body_a;
  def.body_b.index = joint.body_b;
  def.axis = joint.axis;
  def.axle = joint.axle;
  def.steering = joint.steering;
  def.cone = joint.cone;
  def.length = joint.length;
  def.ratio = joint.ratio;
  def.hertz = joint.hertz;
  def.damping_ratio = joint.damping_ratio;
  def.angular_hertz = joint.angular_hertz;
  def.angular_damping_ratio = joint.angular_damping_ratio;
  def.limit_enabled = joint.limit_enabled != 0;
  def.lower = joint.lower;
  def.upper = joint.upper;
  def.motor = joint.motor;
  def.motor_speed = joint.motor_speed;
  def.motor_max = joint.motor_max;
  def.target = joint.target;
  def.drive_amplitude = joint.drive_amplitude;
  def.drive_hertz = joint.drive_hertz;
  def.force_max = joint.force_max;
  def.torque_max = joint.torque_max;
  def.ground_a = joint.ground_a;
  def.ground_b = joint.ground_b;
  def.curve = joint.curve;
  def.size = joint.size;
  def.user_kind = joint.user_kind;
  def.parameters = joint.parameters;
  return def;
}

template <int D>
bool is_reachable(const Joint<D>& joint) {
  if (joint.limit_enabled > 1 || joint.collide_connected > 1) return false;
  // From the centres of mass, which lie within the bodies.
  if (!within(joint.anchor_a, 4.0f * kSizeMax) || !within(joint.anchor_b, 4.0f * kSizeMax))
    return false;
  JointDef<D> def = settings_of(joint);
  // What the world measured itself, at the joint's creation or for a rope whose limits are now off.
  constexpr float kMeasuredMax = 1.0e12f;
  if (joint.kind == JointKind::kGear) {
    if (!within(def.target, -kMeasuredMax, kMeasuredMax)) return false;
    def.target = 0.0f;
  }
  if (joint.kind == JointKind::kPulley) {
    // a + ratio b, and a ratio may be negative.
    if (!within(def.length, -kMeasuredMax, kMeasuredMax)) return false;
    def.length = 0.0f;
  }
  // A rope may be created shorter than a rod, and keeps its length when its limits are off.
  if (joint.kind == JointKind::kDistance && within(def.length, 0.0f, kSizeMin))
    def.length = kSizeMin;
  return validate(def).ok();
}

template bool is_reachable(const Joint<2>&);
template bool is_reachable(const Joint<3>&);
template Error validate(const JointDef<2>&);
template Error validate(const JointDef<3>&);

}  // namespace cycloid::solver
