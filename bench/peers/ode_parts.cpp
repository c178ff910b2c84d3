#include "bench/peers/ode_parts.hpp"

namespace cycloid::peers {

using solver::JointKind;
using solver::Rotation;
using solver::ShapeKind;
using solver::Vec;

dBodyID add_ode_body(const solver::Body<3>& body, float tick_s, dWorldID world) {
  if (body.kind == solver::BodyKind::kStatic) return nullptr;
  dBodyID made = dBodyCreate(world);
  dBodySetPosition(made, body.position[0], body.position[1], body.position[2]);
  const dQuaternion turn = {body.rotation[3], body.rotation[0], body.rotation[1], body.rotation[2]};
  dBodySetQuaternion(made, turn);
  dBodySetLinearVel(made, body.velocity[0], body.velocity[1], body.velocity[2]);
  dBodySetAngularVel(made, body.spin[0], body.spin[1], body.spin[2]);
  if (body.kind == solver::BodyKind::kKinematic) {
    dBodySetKinematic(made);
    return made;
  }
  const solver::Inertia<3>& i = body.inertia;
  dMass mass;
  dMassSetParameters(&mass, body.mass, 0, 0, 0, i.m[0], i.m[4], i.m[8], i.m[1], i.m[2], i.m[5]);
  dBodySetMass(made, &mass);
  dBodySetGravityMode(made, body.gravity_scale != 0.0f ? 1 : 0);
  dBodySetLinearDampingThreshold(made, 0);
  dBodySetAngularDampingThreshold(made, 0);
  dBodySetLinearDamping(made, body.linear_damping * tick_s);
  dBodySetAngularDamping(made, body.angular_damping * tick_s);
  return made;
}

static dGeomID add_hull(const solver::PolyhedronView& hull, dSpaceID space, OdeShape& into) {
  for (const auto& vertex : hull.vertices)
    for (const float value : vertex.position.v) into.points.push_back(value);
  for (const solver::PolyhedronFace& face : hull.faces) {
    for (const float value : face.normal.v) into.planes.push_back(value);
    into.planes.push_back(face.offset);
    const std::size_t count = into.polygons.size();
    into.polygons.push_back(0);
    std::uint32_t edge = face.edge;
    do {
      into.polygons.push_back(hull.edges[edge].origin);
      ++into.polygons[count];
      edge = hull.edges[edge].next;
    } while (edge != face.edge);
  }
  return dCreateConvex(space, into.planes.data(), static_cast<unsigned>(hull.faces.size()),
                       into.points.data(), static_cast<unsigned>(hull.vertices.size()),
                       into.polygons.data());
}

/// ODE's capsule runs along z: the least turn from there to `along`, which is not 0.
static Rotation<3> turn_from_z(const Vec<3>& along) {
  const float size = length(along);
  if (along[2] <= -0.999999f * size) return {{1.0f, 0.0f, 0.0f, 0.0f}};
  const Rotation<3> turn = {{-along[1], along[0], 0.0f, size + along[2]}};
  return (1.0f / solver::sqrt(dot(turn, turn))) * turn;
}

/// A geom at the origin, and where it lies in the frame of the centre of mass.
static dGeomID make_geom(const solver::WorldState<3>& state, const solver::Shape<3>& shape,
                         const OdePlace& place, solver::Pose<3>& at) {
  at = {shape.vertices[0], shape.rotation};
  switch (shape.kind) {
    case ShapeKind::kBall:
      at.rotation = solver::identity_rotation<3>();
      return dCreateSphere(place.space, shape.radius);
    case ShapeKind::kCapsule: {
      const Vec<3> along = shape.vertices[1] - shape.vertices[0];
      at = {0.5f * (shape.vertices[0] + shape.vertices[1]), turn_from_z(along)};
      return dCreateCapsule(place.space, shape.radius, length(along));
    }
    case ShapeKind::kBox:
      return dCreateBox(place.space, 2.0f * shape.half[0], 2.0f * shape.half[1],
                        2.0f * shape.half[2]);
    case ShapeKind::kHull:
      return add_hull(view_of(state.polyhedra, shape.polyhedron), place.space, place.shapes.back());
    default:
      return nullptr;
  }
}

static void put(dGeomID geom, dBodyID owner, const solver::Body<3>& body,
                const solver::Pose<3>& at) {
  if (owner != nullptr) {
    const dQuaternion turn = {at.rotation[3], at.rotation[0], at.rotation[1], at.rotation[2]};
    dGeomSetBody(geom, owner);
    dGeomSetOffsetPosition(geom, at.position[0], at.position[1], at.position[2]);
    dGeomSetOffsetQuaternion(geom, turn);
    return;
  }
  const Vec<3> position = body.position + rotate(body.rotation, at.position);
  const Rotation<3> whole = compose(body.rotation, at.rotation);
  const dQuaternion turn = {whole[3], whole[0], whole[1], whole[2]};
  dGeomSetPosition(geom, position[0], position[1], position[2]);
  dGeomSetQuaternion(geom, turn);
}

bool add_ode_geoms(const solver::WorldState<3>& state, const solver::Body<3>& body, dBodyID owner,
                   const OdePlace& place, std::vector<dGeomID>& geoms) {
  for (std::uint32_t s = body.first_shape; s != solver::kNone; s = state.shapes[s].next) {
    const solver::Shape<3>& shape = state.shapes[s];
    place.shapes.push_back({state.materials[shape.material], shape.filter, {}, {}, {}});
    dGeomID geom = nullptr;
    if (shape.kind == ShapeKind::kHalfSpace) {
      const Vec<3> normal = rotate(body.rotation, shape.normal);
      geom = dCreatePlane(place.space, normal[0], normal[1], normal[2],
                          shape.offset + dot(normal, body.position));
    } else {
      solver::Pose<3> at;
      geom = make_geom(state, shape, place, at);
      if (geom == nullptr) return false;
      put(geom, owner, body, at);
    }
    dGeomSetData(geom, &place.shapes.back());
    geoms.push_back(geom);
  }
  return true;
}

dJointID add_ode_joint(const solver::Joint<3>& joint, const OdePair& pair, dWorldID world) {
  const Vec<3> anchor = pair.pose_a.position + rotate(pair.pose_a.rotation, joint.anchor_a);
  const Vec<3> axis = rotate(pair.pose_a.rotation, joint.axis);
  dJointID made = nullptr;
  switch (joint.kind) {
    case JointKind::kRevolute:
    case JointKind::kConeTwist:
      made = dJointCreateBall(world, nullptr);
      dJointAttach(made, pair.b, pair.a);
      dJointSetBallAnchor(made, anchor[0], anchor[1], anchor[2]);
      return made;
    case JointKind::kHinge:
      // ODE's angle is that of its first body, ours that of b.
      made = dJointCreateHinge(world, nullptr);
      dJointAttach(made, pair.b, pair.a);
      dJointSetHingeAnchor(made, anchor[0], anchor[1], anchor[2]);
      dJointSetHingeAxis(made, axis[0], axis[1], axis[2]);
      if (joint.limit_enabled != 0) {
        dJointSetHingeParam(made, dParamLoStop, joint.lower);
        dJointSetHingeParam(made, dParamHiStop, joint.upper);
      }
      if (joint.motor == solver::MotorKind::kSpeed) {
        dJointSetHingeParam(made, dParamVel, joint.motor_speed);
        dJointSetHingeParam(made, dParamFMax, joint.motor_max);
      }
      return made;
    case JointKind::kWeld:
      made = dJointCreateFixed(world, nullptr);
      dJointAttach(made, pair.b, pair.a);
      dJointSetFixed(made);
      return made;
    default:
      return nullptr;
  }
}

}  // namespace cycloid::peers
