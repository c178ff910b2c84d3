#pragma once

#include "solver/constraints/joints/swing_twist.hpp"
#include "solver/motion.hpp"
#include "tests/solver/joint_scene.hpp"

namespace cycloid::solver {

/// Bodies and measures that the tests of joints in space share.

/// Two equal balls at +-half from the centre, `mass` kg together: its moments differ by axis.
inline BodyId add_dumbbell(World<3>& world, const Vec<3>& centre, const Vec<3>& half, float mass,
                           float radius = 0.2f) {
  BodyDef<3> body;
  body.position = centre;
  body.mass = mass;
  ShapeDef<3> balls[2] = {ball<3>(radius), ball<3>(radius)};
  balls[0].points = {half};
  balls[1].points = {-half};
  const Result<BodyId> id = world.create_body(body, balls);
  EXPECT_TRUE(id.ok()) << id.error().field;
  return id.ok() ? id.value() : BodyId{};
}

/// Moment of inertia of a body about an axis of the world through its centre, kg m^2.
inline float moment_about(const World<3>& world, BodyId id, const Vec<3>& axis) {
  const Body<3>& body = world.state().bodies[id.index];
  return dot(axis, world_inertia(body.inertia, body.rotation) * axis);
}

/// Steps with a constant torque on one body, world frame, N m.
inline void turn(World<3>& world, BodyId id, const Vec<3>& torque, int ticks) {
  for (int i = 0; i < ticks; ++i) {
    ASSERT_TRUE(world.apply_torque(id, torque).ok());
    step(world, 1);
  }
}

/// Linear, then angular momentum about the origin, in double.
inline std::array<double, 6> momenta_in_space(const World<3>& world) {
  std::array<double, 6> sum{};
  for (const Body<3>& body : world.state().bodies) {
    if (body.kind != BodyKind::kDynamic) continue;
    const Vec<3> own = world_inertia(body.inertia, body.rotation) * body.spin;
    const double m = body.mass;
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      const int k = (i + 2) % 3;
      sum[static_cast<std::size_t>(i)] += m * body.velocity[i];
      sum[static_cast<std::size_t>(3 + i)] +=
          own[i] + m * (double{body.position[j]} * body.velocity[k] -
                        double{body.position[k]} * body.velocity[j]);
    }
  }
  return sum;
}

/// Where a joint's axis or axle of creation, given in the frame of a, is carried to by body b.
inline Vec<3> carried(const World<3>& world, const Joint<3>& joint, const Vec<3>& axis) {
  return rotate(world.state().bodies[joint.body_b].rotation, rotate_back(joint.reference, axis));
}

inline float angle_between(const Vec<3>& a, const Vec<3>& b) {
  return std::atan2(length(cross(a, b)), dot(a, b));
}

/// Twist of b about the axis of a joint that has one, rad.
inline float twist_of(const World<3>& world, const Joint<3>& joint) {
  const Rotation<3>& a = world.state().bodies[joint.body_a].rotation;
  const Rotation<3>& b = world.state().bodies[joint.body_b].rotation;
  const Rotation<3> since = compose(conjugate(joint.reference), compose(conjugate(a), b));
  return twist_angle(since, rotate_back(joint.reference, joint.axis));
}

}  // namespace cycloid::solver
