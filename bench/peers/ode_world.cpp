#include "bench/peers/ode_world.hpp"

#include <algorithm>
#include <cmath>

#include "bench/peers/driven_engine.hpp"
#include "bench/peers/ode_parts.hpp"

namespace cycloid::peers {
namespace {

constexpr int kPointsMax = 8;  ///< Of one pair.

class OdeWorld final : public DrivenEngine<3> {
 public:
  explicit OdeWorld(const EngineInput<3>& input);
  ~OdeWorld() override;
  const std::string& missing() const { return missing_; }  ///< "": nothing.

  solver::Pose<3> pose(std::uint32_t body) const override {
    if (bodies_[body] == nullptr) return starts_[body];
    const dReal* at = dBodyGetPosition(bodies_[body]);
    const dReal* q = dBodyGetQuaternion(bodies_[body]);
    const auto real = [](dReal value) { return static_cast<float>(value); };
    return {{{real(at[0]), real(at[1]), real(at[2])}},
            {{real(q[1]), real(q[2]), real(q[3]), real(q[0])}}};
  }
  Twist<3> twist(std::uint32_t body) const override {
    if (bodies_[body] == nullptr) return {solver::Vec<3>::zero(), solver::Spin<3>::zero()};
    const auto vector = [](const dReal* of) {
      return solver::Vec<3>{
          {static_cast<float>(of[0]), static_cast<float>(of[1]), static_cast<float>(of[2])}};
    };
    return {vector(dBodyGetLinearVel(bodies_[body])), vector(dBodyGetAngularVel(bodies_[body]))};
  }
  std::uint32_t contacts() const override { return pairs_; }

 protected:
  void advance() override {
    for (int i = 0; i < substeps_; ++i) step_once();
  }
  void push(std::uint32_t body, const solver::Vec<3>& force_n) override {
    const solver::Vec<3> f = static_cast<float>(substeps_) * force_n;
    dBodyAddForce(bodies_[body], f[0], f[1], f[2]);
  }
  void kick(std::uint32_t body, const solver::Vec<3>& impulse_n_s) override {
    push(body, (1.0f / tick_s_) * impulse_n_s);
  }
  void turn(std::uint32_t body, const solver::Spin<3>& torque_n_m) override {
    const solver::Spin<3> t = static_cast<float>(substeps_) * torque_n_m;
    dBodyAddTorque(bodies_[body], t[0], t[1], t[2]);
  }
  void set_motor_speed(std::uint32_t joint, float speed) override {
    if (dJointGetType(joints_[joint]) == dJointTypeHinge)
      dJointSetHingeParam(joints_[joint], dParamVel, speed);
  }
  void set_steering(std::uint32_t, float) override {}
  std::size_t spawn(const solver::WorldState<3>& made) override;
  void remove_spawned(std::size_t number) override;

 private:
  struct Spawned {
    dBodyID body;
    std::vector<dGeomID> geoms;
  };
  float step_s() const { return tick_s_ / static_cast<float>(substeps_); }
  void step_once() {
    pairs_ = 0;
    dSpaceCollide(space_, this, [](void* self, dGeomID a, dGeomID b) {
      static_cast<OdeWorld*>(self)->meet(a, b);
    });
    dWorldQuickStep(world_, step_s());
    dJointGroupEmpty(contacts_);
  }
  void meet(dGeomID a, dGeomID b);
  void add_bodies(const solver::WorldState<3>& state);
  void add_joints(const solver::WorldState<3>& state);

  dWorldID world_ = dWorldCreate();
  dSpaceID space_ = dSweepAndPruneSpaceCreate(nullptr, dSAP_AXES_XZY);
  dJointGroupID contacts_ = dJointGroupCreate(0);
  std::deque<OdeShape> shapes_;
  std::vector<dBodyID> bodies_;
  std::vector<solver::Pose<3>> starts_;
  std::vector<dJointID> joints_;
  std::vector<std::pair<dBodyID, dBodyID>> apart_;  ///< Sorted; bodies that a joint keeps apart.
  std::vector<Spawned> spawned_;
  float tick_s_;
  int substeps_;  ///< What acts in a tick acts in the first: the engine forgets it there.
  std::uint32_t pairs_ = 0;
  std::string missing_;
};

OdeWorld::OdeWorld(const EngineInput<3>& input)
    : DrivenEngine(input.built),
      tick_s_(input.built.world.tick_s()),
      substeps_(std::max(1, input.settings.substeps)) {
  const solver::WorldState<3>& state = input.built.world.state();
  if (input.settings.iterations > 0)
    dWorldSetQuickStepNumIterations(world_, input.settings.iterations);
  const solver::Vec<3>& gravity = state.header.gravity;
  dWorldSetGravity(world_, gravity[0], gravity[1], gravity[2]);
  dWorldSetAutoDisableFlag(world_, input.settings.sleep ? 1 : 0);
  add_bodies(state);
  add_joints(state);
}

void OdeWorld::add_bodies(const solver::WorldState<3>& state) {
  const OdePlace place{world_, space_, shapes_};
  std::vector<dGeomID> geoms;
  for (const solver::Body<3>& body : state.bodies) {
    starts_.push_back({body.position, body.rotation});
    bodies_.push_back(add_ode_body(body, step_s(), world_));
    if (!add_ode_geoms(state, body, bodies_.back(), place, geoms))
      missing_ = "a shape is of a kind that is not mapped";
  }
}

void OdeWorld::add_joints(const solver::WorldState<3>& state) {
  for (const solver::Joint<3>& joint : state.joints) {
    joints_.push_back(add_ode_joint(
        joint, {starts_[joint.body_a], bodies_[joint.body_a], bodies_[joint.body_b]}, world_));
    if (joints_.back() == nullptr)
      missing_ = "joint " + std::to_string(joints_.size() - 1) + " is of a kind that is not mapped";
    if (joint.collide_connected == 0)
      apart_.push_back(std::minmax(bodies_[joint.body_a], bodies_[joint.body_b]));
  }
  // Total order: a pair twice is the same pair.
  std::sort(apart_.begin(), apart_.end());
}

OdeWorld::~OdeWorld() {
  dJointGroupDestroy(contacts_);
  dSpaceDestroy(space_);
  dWorldDestroy(world_);
}

void OdeWorld::meet(dGeomID geom_a, dGeomID geom_b) {
  dBodyID a = dGeomGetBody(geom_a);
  dBodyID b = dGeomGetBody(geom_b);
  if (a == b) return;  // Also two that never move.
  const auto& shape_a = *static_cast<const OdeShape*>(dGeomGetData(geom_a));
  const auto& shape_b = *static_cast<const OdeShape*>(dGeomGetData(geom_b));
  if (!filters_meet(shape_a.filter, shape_b.filter)) return;
  if (std::binary_search(apart_.begin(), apart_.end(),
                         std::pair<dBodyID, dBodyID>(std::minmax(a, b))))
    return;
  dContact points[kPointsMax];
  const int count = dCollide(geom_a, geom_b, kPointsMax, &points[0].geom, sizeof(dContact));
  if (count > 0) ++pairs_;
  for (int i = 0; i < count; ++i) {
    dSurfaceParameters& surface = points[i].surface;
    surface.mode = dContactApprox1;
    surface.mu = std::sqrt(shape_a.material.friction * shape_b.material.friction);
    surface.bounce = std::max(shape_a.material.restitution, shape_b.material.restitution);
    surface.bounce_vel = 1.0;
    if (surface.bounce > 0.0) surface.mode |= dContactBounce;
    dJointAttach(dJointCreateContact(world_, contacts_, &points[i]), a, b);
  }
}

std::size_t OdeWorld::spawn(const solver::WorldState<3>& made) {
  const solver::Body<3>& body = made.bodies[0];
  Spawned& spawned = spawned_.emplace_back();
  spawned.body = add_ode_body(body, step_s(), world_);
  add_ode_geoms(made, body, spawned.body, {world_, space_, shapes_}, spawned.geoms);
  return spawned_.size() - 1;
}

void OdeWorld::remove_spawned(std::size_t number) {
  for (dGeomID geom : spawned_[number].geoms) dGeomDestroy(geom);
  dBodyDestroy(spawned_[number].body);
}

}  // namespace

std::unique_ptr<Engine<3>> make_ode_world(const EngineInput<3>& input, std::string& why) {
  static const int kReady = dInitODE2(0);
  if (kReady == 0 || !input.scene.cloths.empty() || !input.scene.characters.empty()) {
    why = kReady == 0 ? "ODE does not start" : "cloths and characters are not mapped to ODE";
    return nullptr;
  }
  auto world = std::make_unique<OdeWorld>(input);
  why = world->missing();
  if (!why.empty()) return nullptr;
  return world;
}

}  // namespace cycloid::peers
