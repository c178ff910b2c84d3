#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>

#include "solver/state.hpp"

namespace cycloid::peers {

/// The joint as a constraint of Bullet's; null for kinds that none of the scenes of space use.
/// @param tick_s  turns a greatest torque into the greatest impulse of a motor.
std::unique_ptr<btTypedConstraint> make_joint(const solver::Joint<3>& joint, float tick_s,
                                              btRigidBody& a, btRigidBody& b);

}  // namespace cycloid::peers
