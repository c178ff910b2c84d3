#include "bench/peers/bullet_world.hpp"

#include <malloc.h>

#include <cstdlib>
#include <deque>

#include "bench/peers/bullet_joints.hpp"
#include "bench/peers/bullet_shapes.hpp"

namespace cycloid::peers {

static std::size_t held_bytes = 0;

static void* count_allocation(std::size_t size) {
  void* memory = std::malloc(size);
  held_bytes += malloc_usable_size(memory);
  return memory;
}
static void count_release(void* memory) {
  held_bytes -= malloc_usable_size(memory);
  std::free(memory);
}

std::size_t BulletWorld::bytes() {
  return held_bytes;
}

struct BulletWorld::Parts {
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher{&configuration};
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world{&dispatcher, &broadphase, &solver, &configuration};
  BulletShapes shapes;
  std::vector<std::unique_ptr<btRigidBody>> bodies;  ///< By slot; null: free.
  std::vector<std::unique_ptr<btTypedConstraint>> joints;
  std::vector<scenes::BoundSeat> seats;
  std::vector<std::uint16_t> buttons;  ///< Of each seat in the tick before.
  std::deque<std::unique_ptr<btRigidBody>> spawned;
  std::vector<std::unique_ptr<btRigidBody>> prefabs;
  float tick_s;
  bool sleep;
};

static std::unique_ptr<btRigidBody> make_body(const solver::WorldState<3>& state,
                                              const solver::Body<3>& body, BulletShapes& shapes) {
  const solver::Inertia<3>& i = body.inertia;
  const bool turns = body.inverse_inertia.m[0] > 0.0f;
  btRigidBody::btRigidBodyConstructionInfo info(
      body.mass, nullptr, make_shape(state, body, shapes),
      turns ? btVector3(i.m[0], i.m[4], i.m[8]) : btVector3(0, 0, 0));
  info.m_startWorldTransform = btTransform(to_bullet(body.rotation), to_bullet(body.position));
  info.m_linearDamping = body.linear_damping;
  info.m_angularDamping = body.angular_damping;
  if (body.first_shape != solver::kNone) {
    const auto& material = state.materials[state.shapes[body.first_shape].material];
    info.m_friction = std::sqrt(material.friction);
    info.m_restitution = material.restitution;
    info.m_rollingFriction = material.rolling_resistance;
  }
  auto made = std::make_unique<btRigidBody>(info);
  made->setLinearVelocity(to_bullet(body.velocity));
  made->setAngularVelocity(to_bullet(body.spin));
  made->setFlags(BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY);
  return made;
}

/// Bodies of one negative group do not meet one another; all else does in these scenes.
struct GroupFilter : btOverlapFilterCallback {
  bool needBroadphaseCollision(btBroadphaseProxy* a, btBroadphaseProxy* b) const override {
    const auto* body_a = static_cast<btCollisionObject*>(a->m_clientObject);
    const auto* body_b = static_cast<btCollisionObject*>(b->m_clientObject);
    if (body_a->isStaticOrKinematicObject() && body_b->isStaticOrKinematicObject()) return false;
    const int group = body_a->getUserIndex();
    return group >= 0 || group != body_b->getUserIndex();
  }
};
static GroupFilter group_filter;

BulletWorld::BulletWorld(const scenes::Built<3>& built, bool sleep) {
  btAlignedAllocSetCustom(count_allocation, count_release);
  parts_ = std::make_unique<Parts>();
  Parts& parts = *parts_;
  const solver::WorldState<3>& state = built.world.state();
  parts.tick_s = state.header.tick_s;
  parts.sleep = sleep;
  parts.seats = built.seats;
  parts.buttons.resize(built.seats.size());
  parts.world.setGravity(to_bullet(state.header.gravity));
  parts.world.getPairCache()->setOverlapFilterCallback(&group_filter);
  for (const solver::Body<3>& body : state.bodies) {
    parts.bodies.push_back(make_body(state, body, parts.shapes));
    btRigidBody& made = *parts.bodies.back();
    if (body.first_shape != solver::kNone)
      made.setUserIndex(state.shapes[body.first_shape].filter.group);
    if (!sleep) made.setActivationState(DISABLE_DEACTIVATION);
    if (made.getCollisionShape() != nullptr) parts.world.addRigidBody(&made);
  }
  for (const solver::Joint<3>& joint : state.joints) {
    parts.joints.push_back(
        make_joint(joint, parts.tick_s, *parts.bodies[joint.body_a], *parts.bodies[joint.body_b]));
    if (parts.joints.back() != nullptr)
      parts.world.addConstraint(parts.joints.back().get(), joint.collide_connected == 0);
  }
  for (const scenes::Prefab<3>& prefab : built.prefabs) {
    // Its mass and shapes come from a world of its own, where it is body 0.
    auto world = solver::World<3>::create({});
    const auto id = world.value().create_body(prefab.body, prefab.shapes);
    if (!id.ok()) continue;
    const solver::WorldState<3>& made = world.value().state();
    parts.prefabs.push_back(make_body(made, made.bodies[id.value().index], parts.shapes));
  }
}

BulletWorld::~BulletWorld() {
  for (auto& joint : parts_->joints)
    if (joint != nullptr) parts_->world.removeConstraint(joint.get());
  for (auto& body : parts_->spawned) parts_->world.removeRigidBody(body.get());
  for (auto& body : parts_->bodies) parts_->world.removeRigidBody(body.get());
}

static void spawn(const scenes::Control& control, const btRigidBody& prefab,
                  btDiscreteDynamicsWorld& world,
                  std::deque<std::unique_ptr<btRigidBody>>& spawned) {
  btRigidBody::btRigidBodyConstructionInfo info(
      1.0f / prefab.getInvMass(), nullptr,
      const_cast<btCollisionShape*>(prefab.getCollisionShape()), prefab.getLocalInertia());
  info.m_startWorldTransform.setIdentity();
  info.m_startWorldTransform.setOrigin(
      {control.position[0], control.position[1], control.position[2]});
  info.m_friction = prefab.getFriction();
  auto body = std::make_unique<btRigidBody>(info);
  body->setLinearVelocity({control.velocity[0], control.velocity[1], control.velocity[2]});
  world.addRigidBody(body.get());
  spawned.push_back(std::move(body));
  if (spawned.size() <= control.limit) return;
  world.removeRigidBody(spawned.front().get());
  spawned.pop_front();
}

void BulletWorld::step(std::span<const scenes::SeatInput> inputs) {
  Parts& parts = *parts_;
  for (std::size_t seat = 0; seat < inputs.size(); ++seat) {
    const auto fresh = static_cast<std::uint16_t>(inputs[seat].buttons & ~parts.buttons[seat]);
    parts.buttons[seat] = inputs[seat].buttons;
    for (const scenes::BoundControl& bound : parts.seats[seat].controls) {
      const scenes::Control& control = bound.control;
      const bool button = control.source == scenes::Source::kButton;
      const bool pressed = button && (fresh >> control.index & 1) != 0;
      const float level =
          button ? 0.0f : static_cast<float>(inputs[seat].axes[control.index]) / 32767.0f;
      const btVector3 value(control.value[0], control.value[1], control.value[2]);
      if (control.effect == scenes::Effect::kSpawn && pressed)
        spawn(control, *parts.prefabs[bound.prefab], parts.world, parts.spawned);
      if (control.effect == scenes::Effect::kImpulse && pressed) {
        parts.bodies[bound.body.index]->activate(true);
        parts.bodies[bound.body.index]->applyCentralImpulse(value);
      }
      if (control.effect == scenes::Effect::kForce && level != 0.0f) {
        parts.bodies[bound.body.index]->activate(true);
        parts.bodies[bound.body.index]->applyCentralForce(level * value);
      }
      if (control.effect == scenes::Effect::kTorque && level != 0.0f)
        parts.bodies[bound.body.index]->applyTorque(level * value);
      auto* wheel =
          dynamic_cast<btHinge2Constraint*>(control.effect == scenes::Effect::kMotorSpeed ||
                                                    control.effect == scenes::Effect::kSteering
                                                ? parts.joints[bound.joint.index].get()
                                                : nullptr);
      if (wheel == nullptr) continue;
      if (control.effect == scenes::Effect::kMotorSpeed) {
        wheel->setTargetVelocity(3, -level * control.value[0]);
      } else {
        wheel->setLowerLimit(level * control.value[0]);
        wheel->setUpperLimit(level * control.value[0]);
      }
    }
  }
  parts.world.stepSimulation(parts.tick_s, 0, parts.tick_s);
}

solver::Pose<3> BulletWorld::pose(std::uint32_t body) const {
  const btTransform& at = parts_->bodies[body]->getCenterOfMassTransform();
  const btQuaternion q = at.getRotation();
  return {{{at.getOrigin().x(), at.getOrigin().y(), at.getOrigin().z()}},
          {{q.x(), q.y(), q.z(), q.w()}}};
}

}  // namespace cycloid::peers
