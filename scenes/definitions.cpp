#include "scenes/definitions.hpp"

#include "solver/trig.hpp"

namespace cycloid::scenes {

static void set_rotation(const SceneBody& from, solver::BodyDef<2>& to) {
  solver::sin_cos(from.angle, to.rotation[1], to.rotation[0]);
  to.spin = {{from.spin[0]}};
}
static void set_rotation(const SceneBody& from, solver::BodyDef<3>& to) {
  for (int i = 0; i < 4; ++i) to.rotation[i] = from.rotation[static_cast<std::size_t>(i)];
  to.spin = vec<3>(from.spin);
}

static void set_solid(const SceneShape&, solver::ShapeDef<2>&) {}
/// What only shapes of space have.
static void set_solid(const SceneShape& from, solver::ShapeDef<3>& to) {
  to.half = vec<3>(from.half);
  for (int i = 0; i < 4; ++i) to.rotation[i] = from.rotation[static_cast<std::size_t>(i)];
  to.triangles = from.triangles;
  to.heights = from.heights;
  to.columns = from.columns;
  to.cell = from.cell;
}

template <int D>
solver::BodyDef<D> body_def(const SceneBody& from) {
  solver::BodyDef<D> to;
  to.kind = from.kind;
  to.position = vec<D>(from.position);
  set_rotation(from, to);
  to.velocity = vec<D>(from.velocity);
  to.mass = from.mass;
  to.linear_damping = from.linear_damping;
  to.angular_damping = from.angular_damping;
  to.gravity_scale = from.gravity_scale;
  to.fixed_rotation = from.fixed_rotation;
  to.tag = from.tag;
  return to;
}

template <int D>
solver::ShapeDef<D> shape_def(const SceneShape& from) {
  solver::ShapeDef<D> to;
  to.kind = from.kind;
  for (const Triple& point : from.points) to.points.push_back(vec<D>(point));
  to.radius = from.radius;
  to.normal = vec<D>(from.normal);
  to.offset = from.offset;
  to.loop = from.loop;
  set_solid(from, to);
  to.density = from.density;
  to.filter = from.filter;
  return to;
}

template <int D>
solver::JointDef<D> joint_def(const SceneJoint& from) {
  solver::JointDef<D> to;
  to.kind = from.kind;
  to.anchor_a = vec<D>(from.anchor_a);
  to.anchor_b = vec<D>(from.anchor_b);
  to.axis = vec<D>(from.axis);
  to.axle = vec<D>(from.axle);
  to.steering = from.steering;
  to.cone = from.cone;
  to.length = from.length;
  to.ratio = from.ratio;
  to.hertz = from.hertz;
  to.damping_ratio = from.damping_ratio;
  to.angular_hertz = from.angular_hertz;
  to.angular_damping_ratio = from.angular_damping_ratio;
  to.limit_enabled = from.limit_enabled;
  to.lower = from.lower;
  to.upper = from.upper;
  to.motor = from.motor;
  to.motor_speed = from.motor_speed;
  to.motor_max = from.motor_max;
  to.target = from.target;
  to.drive_amplitude = from.drive_amplitude;
  to.drive_hertz = from.drive_hertz;
  to.force_max = from.force_max;
  to.torque_max = from.torque_max;
  to.ground_a = vec<D>(from.ground_a);
  to.ground_b = vec<D>(from.ground_b);
  to.curve = from.curve;
  to.size = from.size;
  to.collide_connected = from.collide_connected;
  return to;
}

template solver::BodyDef<2> body_def(const SceneBody&);
template solver::BodyDef<3> body_def(const SceneBody&);
template solver::ShapeDef<2> shape_def(const SceneShape&);
template solver::ShapeDef<3> shape_def(const SceneShape&);
template solver::JointDef<2> joint_def(const SceneJoint&);
template solver::JointDef<3> joint_def(const SceneJoint&);

}  // namespace cycloid::scenes
