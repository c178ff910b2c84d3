#include "bench/peers/box2d3_parts.hpp"

namespace cycloid::peers {

using solver::JointKind;
using solver::ShapeKind;

static b2BodyDef body_def(const solver::Body<2>& body) {
  b2BodyDef def = b2DefaultBodyDef();
  def.type = body.kind == solver::BodyKind::kStatic      ? b2_staticBody
             : body.kind == solver::BodyKind::kKinematic ? b2_kinematicBody
                                                         : b2_dynamicBody;
  def.position = to_box2d3(body.position);
  def.rotation = {body.rotation[0], body.rotation[1]};
  def.linearVelocity = to_box2d3(body.velocity);
  def.angularVelocity = body.spin[0];
  def.linearDamping = body.linear_damping;
  def.angularDamping = body.angular_damping;
  def.gravityScale = body.gravity_scale;
  def.motionLocks.angularZ = body.inverse_inertia.m[0] == 0.0f && def.type == b2_dynamicBody;
  return def;
}

static b2Hull hull_of(const solver::Shape<2>& shape) {
  b2Vec2 corners[B2_MAX_POLYGON_VERTICES];
  for (std::uint32_t i = 0; i < shape.vertex_count; ++i) corners[i] = to_box2d3(shape.vertices[i]);
  return b2ComputeHull(corners, static_cast<int>(shape.vertex_count));
}

/// A segment is stored with its free side to its right, as Box2D has it; the ghosts of its ends are
/// its third and fourth corner.
static b2ChainSegment edge_of(const solver::Shape<2>& shape) {
  const b2Vec2 from = to_box2d3(shape.vertices[0]);
  const b2Vec2 to = to_box2d3(shape.vertices[1]);
  const b2Vec2 along = b2Sub(to, from);
  b2ChainSegment edge = {};
  edge.ghost1 = (shape.ghosts & 1u) != 0 ? to_box2d3(shape.vertices[2]) : b2Sub(from, along);
  edge.segment = {from, to};
  edge.ghost2 = (shape.ghosts & 2u) != 0 ? to_box2d3(shape.vertices[3]) : b2Add(to, along);
  return edge;
}

static void add_shape(const solver::Shape<2>& shape, const b2ShapeDef& def, b2BodyId into) {
  switch (shape.kind) {
    case ShapeKind::kBall: {
      const b2Circle circle = {to_box2d3(shape.vertices[0]), shape.radius};
      b2CreateCircleShape(into, &def, &circle);
      return;
    }
    case ShapeKind::kCapsule: {
      const b2Capsule capsule = {to_box2d3(shape.vertices[0]), to_box2d3(shape.vertices[1]),
                                 shape.radius};
      b2CreateCapsuleShape(into, &def, &capsule);
      return;
    }
    case ShapeKind::kPolygon: {
      const b2Hull hull = hull_of(shape);
      const b2Polygon polygon = b2MakePolygon(&hull, shape.radius);
      b2CreatePolygonShape(into, &def, &polygon);
      return;
    }
    case ShapeKind::kSegment: {
      const b2ChainSegment edge = edge_of(shape);
      b2CreateChainSegmentShape(into, &def, &edge);
      return;
    }
    case ShapeKind::kHalfSpace: {
      const b2Vec2 along = {2000.0f * shape.normal[1], -2000.0f * shape.normal[0]};
      const b2Vec2 middle = to_box2d3(shape.offset * shape.normal);
      const b2Segment segment = {b2Sub(middle, along), b2Add(middle, along)};
      b2CreateSegmentShape(into, &def, &segment);
      return;
    }
    default:
      return;
  }
}

b2BodyId add_box2d3_body(const solver::WorldState<2>& state, const solver::Body<2>& body,
                         b2WorldId world) {
  const b2BodyDef def = body_def(body);
  const b2BodyId id = b2CreateBody(world, &def);
  for (std::uint32_t s = body.first_shape; s != solver::kNone; s = state.shapes[s].next) {
    const solver::Shape<2>& shape = state.shapes[s];
    b2ShapeDef of_shape = b2DefaultShapeDef();
    of_shape.material.friction = state.materials[shape.material].friction;
    of_shape.material.restitution = state.materials[shape.material].restitution;
    of_shape.filter.categoryBits = shape.filter.category;
    of_shape.filter.maskBits = shape.filter.mask;
    of_shape.filter.groupIndex = shape.filter.group;
    of_shape.updateBodyMass = false;
    add_shape(shape, of_shape, id);
  }
  b2Body_SetMassData(id, {body.mass, {0.0f, 0.0f}, body.inertia.m[0]});
  return id;
}

bool takes_box2d3_polygons(const solver::WorldState<2>& state) {
  for (const solver::Shape<2>& shape : state.shapes) {
    if (shape.kind != ShapeKind::kPolygon) continue;
    if (shape.vertex_count > B2_MAX_POLYGON_VERTICES) return false;
    if (hull_of(shape).count != static_cast<int>(shape.vertex_count)) return false;
  }
  return true;
}

/// What every definition begins with. The frame of `a` is turned by `axis_a`, and that of `b` so
/// that both agree where the joint is at rest.
static void set_base(b2JointDef& base, const solver::Joint<2>& joint, b2BodyId a, b2BodyId b,
                     b2Rot axis_a) {
  base.bodyIdA = a;
  base.bodyIdB = b;
  const b2Rot reference = {joint.reference[0], joint.reference[1]};
  base.localFrameA = {to_box2d3(joint.anchor_a), axis_a};
  base.localFrameB = {to_box2d3(joint.anchor_b), b2InvMulRot(reference, axis_a)};
  base.collideConnected = joint.collide_connected != 0;
}

static b2JointId add_pin(const solver::Joint<2>& joint, b2BodyId a, b2BodyId b, b2WorldId world) {
  b2RevoluteJointDef def = b2DefaultRevoluteJointDef();
  set_base(def.base, joint, a, b, b2Rot_identity);
  def.enableLimit = joint.limit_enabled != 0;
  def.lowerAngle = joint.lower;
  def.upperAngle = joint.upper;
  def.enableMotor = joint.motor == solver::MotorKind::kSpeed;
  def.motorSpeed = joint.motor_speed;
  def.maxMotorTorque = joint.motor_max;
  return b2CreateRevoluteJoint(world, &def);
}

static b2JointId add_slide(const solver::Joint<2>& joint, b2BodyId a, b2BodyId b, b2WorldId world) {
  b2PrismaticJointDef def = b2DefaultPrismaticJointDef();
  set_base(def.base, joint, a, b, {joint.axis[0], joint.axis[1]});
  def.enableLimit = joint.limit_enabled != 0;
  def.lowerTranslation = joint.lower;
  def.upperTranslation = joint.upper;
  def.enableMotor = joint.motor == solver::MotorKind::kSpeed;
  def.motorSpeed = joint.motor_speed;
  def.maxMotorForce = joint.motor_max;
  return b2CreatePrismaticJoint(world, &def);
}

static b2JointId add_rod(const solver::Joint<2>& joint, b2BodyId a, b2BodyId b, b2WorldId world) {
  const bool rope = joint.limit_enabled != 0;
  b2DistanceJointDef def = b2DefaultDistanceJointDef();
  set_base(def.base, joint, a, b, b2Rot_identity);
  def.length = joint.length;
  def.enableLimit = rope;
  def.minLength = rope ? joint.lower : joint.length;
  def.maxLength = rope ? joint.upper : joint.length;
  // A limit counts only beside a spring; one without stiffness is a rope.
  def.enableSpring = joint.hertz > 0.0f || rope;
  def.hertz = joint.hertz;
  def.dampingRatio = joint.damping_ratio;
  return b2CreateDistanceJoint(world, &def);
}

static b2JointId add_weld(const solver::Joint<2>& joint, b2BodyId a, b2BodyId b, b2WorldId world) {
  b2WeldJointDef def = b2DefaultWeldJointDef();
  set_base(def.base, joint, a, b, b2Rot_identity);
  return b2CreateWeldJoint(world, &def);
}

b2JointId add_box2d3_joint(const solver::Joint<2>& joint, b2BodyId a, b2BodyId b, b2WorldId world) {
  const bool held = joint.motor == solver::MotorKind::kPosition || joint.hertz > 0.0f;
  switch (joint.kind) {
    case JointKind::kRevolute:
      return held ? b2_nullJointId : add_pin(joint, a, b, world);
    case JointKind::kPrismatic:
      return held ? b2_nullJointId : add_slide(joint, a, b, world);
    case JointKind::kDistance:
      return add_rod(joint, a, b, world);
    case JointKind::kWeld:
      return add_weld(joint, a, b, world);
    default:
      return b2_nullJointId;
  }
}

}  // namespace cycloid::peers
