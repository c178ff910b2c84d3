#include "bench/peers/bullet_shapes.hpp"

namespace cycloid::peers {

using solver::ShapeKind;

template <class S>
static S* keep(std::unique_ptr<S> shape, BulletShapes& into) {
  S* raw = shape.get();
  into.shapes.push_back(std::move(shape));
  return raw;
}

/// Bullet's capsule runs along y through its middle.
static btTransform along_y(const solver::Vec<3>& from, const solver::Vec<3>& to) {
  const btVector3 span = to_bullet(to) - to_bullet(from);
  const btVector3 middle = 0.5f * (to_bullet(to) + to_bullet(from));
  return btTransform(shortestArcQuat(btVector3(0, 1, 0), span.normalized()), middle);
}

static btCollisionShape* make_hull(const solver::WorldState<3>& state,
                                   const solver::Shape<3>& shape, BulletShapes& into) {
  auto hull = std::make_unique<btConvexHullShape>();
  for (const auto& vertex : view_of(state.polyhedra, shape.polyhedron).vertices)
    hull->addPoint(to_bullet(vertex.position), false);
  hull->recalcLocalAabb();
  return keep(std::move(hull), into);
}

/// One shape, and where it lies on the body.
static btCollisionShape* make_one(const solver::WorldState<3>& state, const solver::Shape<3>& shape,
                                  BulletShapes& into, btTransform& place) {
  place.setIdentity();
  switch (shape.kind) {
    case ShapeKind::kBall:
      place.setOrigin(to_bullet(shape.vertices[0]));
      return keep(std::make_unique<btSphereShape>(shape.radius), into);
    case ShapeKind::kCapsule: {
      place = along_y(shape.vertices[0], shape.vertices[1]);
      const btScalar height =
          (to_bullet(shape.vertices[1]) - to_bullet(shape.vertices[0])).length();
      return keep(std::make_unique<btCapsuleShape>(shape.radius, height), into);
    }
    case ShapeKind::kBox:
      place = btTransform(to_bullet(shape.rotation), to_bullet(shape.vertices[0]));
      return keep(std::make_unique<btBoxShape>(to_bullet(shape.half)), into);
    case ShapeKind::kHull:
      place = btTransform(to_bullet(shape.rotation), to_bullet(shape.vertices[0]));
      return make_hull(state, shape, into);
    case ShapeKind::kHalfSpace:
      return keep(std::make_unique<btStaticPlaneShape>(to_bullet(shape.normal), shape.offset),
                  into);
    default:
      return nullptr;
  }
}

static void add_mesh(const solver::WorldState<3>& state, const solver::Body<3>& body,
                     BulletShapes& into, btCompoundShape& compound) {
  auto mesh = std::make_unique<btTriangleMesh>();
  for (std::uint32_t s = body.first_shape; s != solver::kNone; s = state.shapes[s].next) {
    const solver::Shape<3>& shape = state.shapes[s];
    if (shape.kind == ShapeKind::kTriangle)
      mesh->addTriangle(to_bullet(shape.vertices[0]), to_bullet(shape.vertices[1]),
                        to_bullet(shape.vertices[2]));
  }
  if (mesh->getNumTriangles() == 0) return;
  compound.addChildShape(btTransform::getIdentity(),
                         keep(std::make_unique<btBvhTriangleMeshShape>(mesh.get(), true), into));
  into.meshes.push_back(std::move(mesh));
}

btCollisionShape* make_shape(const solver::WorldState<3>& state, const solver::Body<3>& body,
                             BulletShapes& into) {
  if (body.first_shape == solver::kNone) return nullptr;
  btTransform place;
  const solver::Shape<3>& first = state.shapes[body.first_shape];
  if (first.next == solver::kNone && first.kind != ShapeKind::kTriangle) {
    btCollisionShape* only = make_one(state, first, into, place);
    if (place == btTransform::getIdentity()) return only;
  }
  auto compound = std::make_unique<btCompoundShape>();
  for (std::uint32_t s = body.first_shape; s != solver::kNone; s = state.shapes[s].next)
    if (btCollisionShape* child = make_one(state, state.shapes[s], into, place))
      compound->addChildShape(place, child);
  add_mesh(state, body, into, *compound);
  return keep(std::move(compound), into);
}

}  // namespace cycloid::peers
