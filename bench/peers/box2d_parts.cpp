#include "bench/peers/box2d_parts.hpp"

#include <cmath>

namespace cycloid::peers {

using solver::JointKind;
using solver::ShapeKind;

float angle_of(const solver::Rotation<2>& rotation) {
  return std::atan2(rotation[1], rotation[0]);
}

b2Body* add_box2d_body(const solver::Body<2>& body, b2World& world) {
  b2BodyDef def;
  def.type = body.kind == solver::BodyKind::kStatic      ? b2_staticBody
             : body.kind == solver::BodyKind::kKinematic ? b2_kinematicBody
                                                         : b2_dynamicBody;
  def.position = to_box2d(body.position);
  def.angle = angle_of(body.rotation);
  def.linearVelocity = to_box2d(body.velocity);
  def.angularVelocity = body.spin[0];
  def.linearDamping = body.linear_damping;
  def.angularDamping = body.angular_damping;
  def.gravityScale = body.gravity_scale;
  def.fixedRotation = body.inverse_inertia.m[0] == 0.0f && def.type == b2_dynamicBody;
  return world.CreateBody(&def);
}

static void add_capsule(const solver::Shape<2>& shape, b2FixtureDef& def, b2Body& into) {
  const b2Vec2 from = to_box2d(shape.vertices[0]);
  const b2Vec2 to = to_box2d(shape.vertices[1]);
  b2CircleShape end;
  end.m_radius = shape.radius;
  def.shape = &end;
  for (const b2Vec2& at : {from, to}) {
    end.m_p = at;
    into.CreateFixture(&def);
  }
  const b2Vec2 along = to - from;
  b2PolygonShape middle;
  middle.SetAsBox(0.5f * along.Length(), shape.radius, 0.5f * (from + to),
                  std::atan2(along.y, along.x));
  def.shape = &middle;
  into.CreateFixture(&def);
}

/// A segment is stored with its free side to its right, as Box2D has it; the ghosts of its ends are
/// its third and fourth corner.
static b2EdgeShape edge_of(const solver::Shape<2>& shape) {
  const b2Vec2 from = to_box2d(shape.vertices[0]);
  const b2Vec2 to = to_box2d(shape.vertices[1]);
  const b2Vec2 along = to - from;
  const b2Vec2 before = (shape.ghosts & 1u) != 0 ? to_box2d(shape.vertices[2]) : from - along;
  const b2Vec2 after = (shape.ghosts & 2u) != 0 ? to_box2d(shape.vertices[3]) : to + along;
  b2EdgeShape edge;
  edge.SetOneSided(before, from, to, after);
  return edge;
}

static void add_fixture(const solver::Shape<2>& shape, b2FixtureDef& def, b2Body& into) {
  switch (shape.kind) {
    case ShapeKind::kBall: {
      b2CircleShape circle;
      circle.m_p = to_box2d(shape.vertices[0]);
      circle.m_radius = shape.radius;
      def.shape = &circle;
      into.CreateFixture(&def);
      return;
    }
    case ShapeKind::kCapsule:
      return add_capsule(shape, def, into);
    case ShapeKind::kPolygon: {
      b2Vec2 corners[b2_maxPolygonVertices];
      for (std::uint32_t i = 0; i < shape.vertex_count; ++i)
        corners[i] = to_box2d(shape.vertices[i]);
      b2PolygonShape polygon;
      polygon.Set(corners, static_cast<int>(shape.vertex_count));
      polygon.m_radius += shape.radius;
      def.shape = &polygon;
      into.CreateFixture(&def);
      return;
    }
    case ShapeKind::kSegment: {
      const b2EdgeShape edge = edge_of(shape);
      def.shape = &edge;
      into.CreateFixture(&def);
      return;
    }
    case ShapeKind::kHalfSpace: {
      const b2Vec2 normal = to_box2d(shape.normal);
      const b2Vec2 along(2000.0f * normal.y, -2000.0f * normal.x);
      const b2Vec2 middle = shape.offset * normal;
      b2EdgeShape edge;
      edge.SetTwoSided(middle - along, middle + along);
      def.shape = &edge;
      into.CreateFixture(&def);
      return;
    }
    default:
      return;
  }
}

void add_box2d_fixtures(const solver::WorldState<2>& state, const solver::Body<2>& body,
                        b2Body& into) {
  for (std::uint32_t s = body.first_shape; s != solver::kNone; s = state.shapes[s].next) {
    const solver::Shape<2>& shape = state.shapes[s];
    const solver::Material& material = state.materials[shape.material];
    b2FixtureDef def;
    def.friction = material.friction;
    def.restitution = material.restitution;
    def.filter.categoryBits = static_cast<std::uint16_t>(shape.filter.category);
    def.filter.maskBits = static_cast<std::uint16_t>(shape.filter.mask);
    def.filter.groupIndex = static_cast<std::int16_t>(shape.filter.group);
    add_fixture(shape, def, into);
  }
  if (body.mass <= 0.0f) return;
  const b2MassData mass = {body.mass, {0.0f, 0.0f}, body.inertia.m[0]};
  into.SetMassData(&mass);
}

static bool takes_polygon(const solver::Shape<2>& shape) {
  if (shape.vertex_count > b2_maxPolygonVertices) return false;
  std::uint32_t apart = 0;
  for (std::uint32_t i = 0; i < shape.vertex_count; ++i) {
    bool is_new = true;
    for (std::uint32_t j = 0; j < i; ++j)
      if (length(shape.vertices[i] - shape.vertices[j]) <= 0.5f * b2_linearSlop) is_new = false;
    if (is_new) ++apart;
  }
  return apart >= 3;
}

bool takes_box2d_polygons(const solver::WorldState<2>& state) {
  for (const solver::Shape<2>& shape : state.shapes)
    if (shape.kind == ShapeKind::kPolygon && !takes_polygon(shape)) return false;
  return true;
}

void take_box2d_skin_off(b2Body& body) {
  for (b2Fixture* fixture = body.GetFixtureList(); fixture != nullptr; fixture = fixture->GetNext())
    if (fixture->GetType() != b2Shape::e_circle) fixture->GetShape()->m_radius -= b2_polygonRadius;
}

static b2Joint* add_pin(const solver::Joint<2>& joint, b2RevoluteJointDef def, b2World& world) {
  def.referenceAngle = angle_of(joint.reference);
  def.enableLimit = joint.limit_enabled != 0;
  def.lowerAngle = joint.lower;
  def.upperAngle = joint.upper;
  def.enableMotor = joint.motor == solver::MotorKind::kSpeed;
  def.motorSpeed = joint.motor_speed;
  def.maxMotorTorque = joint.motor_max;
  return world.CreateJoint(&def);
}

static b2Joint* add_slide(const solver::Joint<2>& joint, b2PrismaticJointDef def, b2World& world) {
  def.referenceAngle = angle_of(joint.reference);
  def.localAxisA = to_box2d(joint.axis);
  def.enableLimit = joint.limit_enabled != 0;
  def.lowerTranslation = joint.lower;
  def.upperTranslation = joint.upper;
  def.enableMotor = joint.motor == solver::MotorKind::kSpeed;
  def.motorSpeed = joint.motor_speed;
  def.maxMotorForce = joint.motor_max;
  return world.CreateJoint(&def);
}

static b2Joint* add_rod(const solver::Joint<2>& joint, b2DistanceJointDef def, b2World& world) {
  const bool rope = joint.limit_enabled != 0;
  def.length = joint.length;
  def.minLength = rope ? joint.lower : joint.length;
  def.maxLength = rope ? joint.upper : joint.length;
  if (joint.hertz > 0.0f)
    b2LinearStiffness(def.stiffness, def.damping, joint.hertz, joint.damping_ratio, def.bodyA,
                      def.bodyB);
  return world.CreateJoint(&def);
}

/// What every definition begins with.
template <class Def>
static Def joint_def(const solver::Joint<2>& joint, b2Body* a, b2Body* b) {
  Def def;
  def.bodyA = a;
  def.bodyB = b;
  def.localAnchorA = to_box2d(joint.anchor_a);
  def.localAnchorB = to_box2d(joint.anchor_b);
  def.collideConnected = joint.collide_connected != 0;
  return def;
}

b2Joint* add_box2d_joint(const solver::Joint<2>& joint, b2Body* a, b2Body* b, b2World& world) {
  const bool held = joint.motor == solver::MotorKind::kPosition || joint.hertz > 0.0f;
  switch (joint.kind) {
    case JointKind::kRevolute:
      return held ? nullptr : add_pin(joint, joint_def<b2RevoluteJointDef>(joint, a, b), world);
    case JointKind::kPrismatic:
      return held ? nullptr : add_slide(joint, joint_def<b2PrismaticJointDef>(joint, a, b), world);
    case JointKind::kDistance:
      return add_rod(joint, joint_def<b2DistanceJointDef>(joint, a, b), world);
    case JointKind::kWeld: {
      auto def = joint_def<b2WeldJointDef>(joint, a, b);
      def.referenceAngle = angle_of(joint.reference);
      return world.CreateJoint(&def);
    }
    default:
      return nullptr;
  }
}

}  // namespace cycloid::peers
