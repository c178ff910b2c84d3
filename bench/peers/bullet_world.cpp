#include "bench/peers/bullet_world.hpp"

#include "bench/peers/bullet_joints.hpp"
#include "bench/peers/bullet_shapes.hpp"
#include "bench/peers/driven_engine.hpp"

namespace cycloid::peers {
namespace {

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

class BulletWorld final : public DrivenEngine<3> {
 public:
  explicit BulletWorld(const EngineInput<3>& input);
  ~BulletWorld() override;
  /// Of the first joint that is not there; -1: all are.
  int missing_joint() const { return missing_joint_; }

  solver::Pose<3> pose(std::uint32_t body) const override {
    const btTransform& at = bodies_[body]->getCenterOfMassTransform();
    const btQuaternion q = at.getRotation();
    return {{{at.getOrigin().x(), at.getOrigin().y(), at.getOrigin().z()}},
            {{q.x(), q.y(), q.z(), q.w()}}};
  }
  Twist<3> twist(std::uint32_t body) const override {
    const btVector3& velocity = bodies_[body]->getLinearVelocity();
    const btVector3& spin = bodies_[body]->getAngularVelocity();
    return {{{velocity.x(), velocity.y(), velocity.z()}}, {{spin.x(), spin.y(), spin.z()}}};
  }
  std::uint32_t contacts() const override;

 protected:
  void advance() override {
    const float step_s = tick_s_ / static_cast<float>(substeps_);
    for (int i = 0; i < substeps_; ++i) world_.stepSimulation(step_s, 0, step_s);
  }
  void push(std::uint32_t body, const solver::Vec<3>& force_n) override {
    bodies_[body]->activate(true);
    bodies_[body]->applyCentralForce(static_cast<float>(substeps_) * to_bullet(force_n));
  }
  void kick(std::uint32_t body, const solver::Vec<3>& impulse_n_s) override {
    bodies_[body]->activate(true);
    bodies_[body]->applyCentralImpulse(to_bullet(impulse_n_s));
  }
  void turn(std::uint32_t body, const solver::Spin<3>& torque_n_m) override {
    bodies_[body]->activate(true);
    bodies_[body]->applyTorque(static_cast<float>(substeps_) * to_bullet(torque_n_m));
  }
  void set_motor_speed(std::uint32_t joint, float speed) override {
    if (auto* wheel = dynamic_cast<btHinge2Constraint*>(joints_[joint].get()))
      wheel->setTargetVelocity(3, -speed);
    else if (auto* hinge = dynamic_cast<btHingeConstraint*>(joints_[joint].get()))
      hinge->setMotorTargetVelocity(speed);
  }
  void set_steering(std::uint32_t joint, float angle) override {
    auto* wheel = dynamic_cast<btHinge2Constraint*>(joints_[joint].get());
    if (wheel == nullptr) return;
    wheel->setLowerLimit(angle);
    wheel->setUpperLimit(angle);
  }
  std::size_t spawn(const solver::WorldState<3>& made) override;
  void remove_spawned(std::size_t number) override {
    world_.removeRigidBody(spawned_[number].get());
    spawned_[number] = nullptr;
  }

 private:
  std::unique_ptr<btRigidBody> make_body(const solver::WorldState<3>& state,
                                         const solver::Body<3>& body);
  void add_bodies(const solver::WorldState<3>& state);
  void add_joints(const solver::WorldState<3>& state);

  GroupFilter filter_;
  btDefaultCollisionConfiguration configuration_;
  mutable btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &broadphase_, &solver_, &configuration_};
  BulletShapes shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
  std::vector<std::unique_ptr<btRigidBody>> spawned_;
  float tick_s_;
  int substeps_;  ///< What acts in a tick acts in the first: the engine forgets it there.
  bool sleep_;
  int missing_joint_ = -1;
};

std::unique_ptr<btRigidBody> BulletWorld::make_body(const solver::WorldState<3>& state,
                                                    const solver::Body<3>& body) {
  const solver::Inertia<3>& i = body.inertia;
  const bool turns = body.inverse_inertia.m[0] > 0.0f;
  btRigidBody::btRigidBodyConstructionInfo info(
      body.mass, nullptr, make_shape(state, body, shapes_),
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
  if (body.first_shape != solver::kNone)
    made->setUserIndex(state.shapes[body.first_shape].filter.group);
  if (!sleep_) made->setActivationState(DISABLE_DEACTIVATION);
  return made;
}

void BulletWorld::add_bodies(const solver::WorldState<3>& state) {
  for (const solver::Body<3>& body : state.bodies) {
    bodies_.push_back(make_body(state, body));
    if (bodies_.back()->getCollisionShape() != nullptr) world_.addRigidBody(bodies_.back().get());
  }
}

void BulletWorld::add_joints(const solver::WorldState<3>& state) {
  for (const solver::Joint<3>& joint : state.joints) {
    joints_.push_back(make_joint(joint, tick_s_, *bodies_[joint.body_a], *bodies_[joint.body_b]));
    if (joints_.back() != nullptr)
      world_.addConstraint(joints_.back().get(), joint.collide_connected == 0);
    else if (missing_joint_ < 0)
      missing_joint_ = static_cast<int>(joints_.size()) - 1;
  }
}

BulletWorld::BulletWorld(const EngineInput<3>& input)
    : DrivenEngine(input.built),
      tick_s_(input.built.world.tick_s()),
      substeps_(std::max(1, input.settings.substeps)),
      sleep_(input.settings.sleep) {
  const solver::WorldState<3>& state = input.built.world.state();
  if (input.settings.iterations > 0)
    world_.getSolverInfo().m_numIterations = input.settings.iterations;
  world_.setGravity(to_bullet(state.header.gravity));
  world_.getPairCache()->setOverlapFilterCallback(&filter_);
  add_bodies(state);
  add_joints(state);
}

BulletWorld::~BulletWorld() {
  for (auto& joint : joints_)
    if (joint != nullptr) world_.removeConstraint(joint.get());
  for (auto& body : spawned_)
    if (body != nullptr) world_.removeRigidBody(body.get());
  for (auto& body : bodies_) world_.removeRigidBody(body.get());
}

std::uint32_t BulletWorld::contacts() const {
  std::uint32_t count = 0;
  for (int i = 0; i < dispatcher_.getNumManifolds(); ++i)
    count += dispatcher_.getManifoldByIndexInternal(i)->getNumContacts() > 0 ? 1 : 0;
  return count;
}

std::size_t BulletWorld::spawn(const solver::WorldState<3>& made) {
  spawned_.push_back(make_body(made, made.bodies[0]));
  world_.addRigidBody(spawned_.back().get());
  return spawned_.size() - 1;
}

}  // namespace

std::unique_ptr<Engine<3>> make_bullet_world(const EngineInput<3>& input, std::string& why) {
  if (!input.scene.cloths.empty() || !input.scene.characters.empty()) {
    why = "cloths and characters are not mapped to Bullet";
    return nullptr;
  }
  auto world = std::make_unique<BulletWorld>(input);
  if (world->missing_joint() < 0) return world;
  why = "joint " + std::to_string(world->missing_joint()) + " is of a kind that is not mapped";
  return nullptr;
}

}  // namespace cycloid::peers
