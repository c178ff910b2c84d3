#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>
#include <vector>

#include "solver/state.hpp"

namespace cycloid::peers {

inline btVector3 to_bullet(const solver::Vec<3>& v) {
  return {v[0], v[1], v[2]};
}
inline btQuaternion to_bullet(const solver::Rotation<3>& q) {
  return {q[0], q[1], q[2], q[3]};
}

/// What shapes are made of; they do not own one another in Bullet.
struct BulletShapes {
  std::vector<std::unique_ptr<btCollisionShape>> shapes;
  std::vector<std::unique_ptr<btTriangleMesh>> meshes;
};

/// All shapes of a body about its centre of mass; null where it has none. Triangles become one
/// mesh.
btCollisionShape* make_shape(const solver::WorldState<3>& state, const solver::Body<3>& body,
                             BulletShapes& into);

}  // namespace cycloid::peers
