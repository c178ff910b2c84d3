#include "bench/peers/bullet_joints.hpp"

#include "bench/peers/bullet_shapes.hpp"

namespace cycloid::peers {

using solver::JointKind;

/// The joint's axis as body b carries it.
static btVector3 axis_on_b(const solver::Joint<3>& joint, const solver::Vec<3>& axis) {
  return to_bullet(rotate_back(joint.reference, axis));
}

static std::unique_ptr<btTypedConstraint> make_hinge(const solver::Joint<3>& joint, float tick_s,
                                                     btRigidBody& a, btRigidBody& b) {
  auto hinge = std::make_unique<btHingeConstraint>(a, b, to_bullet(joint.anchor_a),
                                                   to_bullet(joint.anchor_b), to_bullet(joint.axis),
                                                   axis_on_b(joint, joint.axis), true);
  if (joint.limit_enabled != 0) hinge->setLimit(joint.lower, joint.upper);
  if (joint.motor == solver::MotorKind::kSpeed)
    hinge->enableAngularMotor(true, joint.motor_speed, joint.motor_max * tick_s);
  return hinge;
}

/// Bullet's twist axis is x of the frames.
static std::unique_ptr<btTypedConstraint> make_cone(const solver::Joint<3>& joint, btRigidBody& a,
                                                    btRigidBody& b) {
  const btQuaternion turn = shortestArcQuat(btVector3(1, 0, 0), to_bullet(joint.axis));
  const btQuaternion back = to_bullet(joint.reference).inverse();
  auto cone =
      std::make_unique<btConeTwistConstraint>(a, b, btTransform(turn, to_bullet(joint.anchor_a)),
                                              btTransform(back * turn, to_bullet(joint.anchor_b)));
  if (joint.limit_enabled != 0)
    cone->setLimit(joint.cone, joint.cone, 0.5f * (joint.upper - joint.lower));
  return cone;
}

static std::unique_ptr<btTypedConstraint> make_wheel(const solver::Joint<3>& joint, btRigidBody& a,
                                                     btRigidBody& b) {
  const btTransform pose = a.getCenterOfMassTransform();
  btVector3 anchor = b.getCenterOfMassPosition();
  btVector3 suspension = pose.getBasis() * to_bullet(joint.axis);
  btVector3 axle = pose.getBasis() * to_bullet(joint.axle);
  auto wheel = std::make_unique<btHinge2Constraint>(a, b, anchor, suspension, axle);
  const btScalar rate = SIMD_2_PI * joint.hertz;
  const btScalar mass = 1.0f / (a.getInvMass() + b.getInvMass());
  wheel->setStiffness(2, mass * rate * rate);
  wheel->setDamping(2, 2.0f * joint.damping_ratio * mass * rate);
  wheel->setLimit(2, joint.lower, joint.upper);
  wheel->setLowerLimit(0.0f);
  wheel->setUpperLimit(0.0f);
  if (joint.motor == solver::MotorKind::kSpeed) {
    wheel->enableMotor(3, true);
    wheel->setMaxMotorForce(3, joint.motor_max);
  }
  return wheel;
}

std::unique_ptr<btTypedConstraint> make_joint(const solver::Joint<3>& joint, float tick_s,
                                              btRigidBody& a, btRigidBody& b) {
  switch (joint.kind) {
    case JointKind::kRevolute:
      return std::make_unique<btPoint2PointConstraint>(a, b, to_bullet(joint.anchor_a),
                                                       to_bullet(joint.anchor_b));
    case JointKind::kHinge:
      return make_hinge(joint, tick_s, a, b);
    case JointKind::kConeTwist:
      return make_cone(joint, a, b);
    case JointKind::kWheel:
      return make_wheel(joint, a, b);
    default:
      return nullptr;
  }
}

}  // namespace cycloid::peers
