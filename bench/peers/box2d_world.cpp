#include "bench/peers/box2d_world.hpp"

#include <algorithm>
#include <deque>

#include "bench/peers/box2d_parts.hpp"
#include "bench/peers/driven_engine.hpp"

namespace cycloid::peers {
namespace {

constexpr int kVelocityIterations = 8;  ///< And three of positions, as the engine's manual says.

/// Of positions, rounded up.
constexpr int position_iterations(int of_velocities) {
  return (3 * of_velocities + kVelocityIterations - 1) / kVelocityIterations;
}

class Box2dWorld final : public DrivenEngine<2> {
 public:
  explicit Box2dWorld(const EngineInput<2>& input);
  /// Of the first joint that is not there; -1: all are.
  int missing_joint() const { return missing_joint_; }

  solver::Pose<2> pose(std::uint32_t body) const override {
    const b2Body& at = *bodies_[body];
    const b2Rot turn(at.GetAngle());
    return {{{at.GetWorldCenter().x, at.GetWorldCenter().y}}, {{turn.c, turn.s}}};
  }
  Twist<2> twist(std::uint32_t body) const override {
    const b2Body& at = *bodies_[body];
    return {{{at.GetLinearVelocity().x, at.GetLinearVelocity().y}}, {{at.GetAngularVelocity()}}};
  }
  std::uint32_t contacts() const override {
    std::uint32_t count = 0;
    for (const b2Contact* c = world_.GetContactList(); c != nullptr; c = c->GetNext())
      count += c->IsTouching() ? 1 : 0;
    return count;
  }

 protected:
  void advance() override {
    const float step_s = tick_s_ / static_cast<float>(substeps_);
    for (int i = 0; i < substeps_; ++i)
      world_.Step(step_s, iterations_, position_iterations(iterations_));
    world_.ClearForces();
  }
  void push(std::uint32_t body, const solver::Vec<2>& force_n) override {
    bodies_[body]->ApplyForceToCenter(to_box2d(force_n), true);
  }
  void kick(std::uint32_t body, const solver::Vec<2>& impulse_n_s) override {
    bodies_[body]->ApplyLinearImpulseToCenter(to_box2d(impulse_n_s), true);
  }
  void turn(std::uint32_t body, const solver::Spin<2>& torque_n_m) override {
    bodies_[body]->ApplyTorque(torque_n_m[0], true);
  }
  void set_motor_speed(std::uint32_t joint, float speed) override {
    if (joints_[joint]->GetType() == e_revoluteJoint)
      static_cast<b2RevoluteJoint*>(joints_[joint])->SetMotorSpeed(speed);
    else if (joints_[joint]->GetType() == e_prismaticJoint)
      static_cast<b2PrismaticJoint*>(joints_[joint])->SetMotorSpeed(speed);
  }
  void set_steering(std::uint32_t, float) override {}
  std::size_t spawn(const solver::WorldState<2>& made) override;
  void remove_spawned(std::size_t number) override {
    world_.DestroyBody(spawned_[number]);
    spawned_[number] = nullptr;
  }

 private:
  b2World world_;
  float tick_s_;
  int substeps_;
  int iterations_;
  std::vector<b2Body*> bodies_;
  std::vector<b2Joint*> joints_;
  std::vector<b2Body*> spawned_;
  int missing_joint_ = -1;
};

Box2dWorld::Box2dWorld(const EngineInput<2>& input)
    : DrivenEngine(input.built),
      world_(to_box2d(input.built.world.state().header.gravity)),
      tick_s_(input.built.world.tick_s()),
      substeps_(std::max(1, input.settings.substeps)),
      iterations_(input.settings.iterations > 0 ? input.settings.iterations : kVelocityIterations) {
  const solver::WorldState<2>& state = input.built.world.state();
  world_.SetAllowSleeping(input.settings.sleep);
  world_.SetAutoClearForces(false);  // Of all substeps of a tick.
  for (const solver::Body<2>& body : state.bodies) {
    bodies_.push_back(add_box2d_body(body, world_));
    add_box2d_fixtures(state, body, *bodies_.back());
    if (input.settings.exact_shapes) take_box2d_skin_off(*bodies_.back());
  }
  for (const solver::Joint<2>& joint : state.joints) {
    joints_.push_back(add_box2d_joint(joint, bodies_[joint.body_a], bodies_[joint.body_b], world_));
    if (joints_.back() == nullptr && missing_joint_ < 0)
      missing_joint_ = static_cast<int>(joints_.size()) - 1;
  }
}

std::size_t Box2dWorld::spawn(const solver::WorldState<2>& made) {
  const solver::Body<2>& body = made.bodies[0];
  spawned_.push_back(add_box2d_body(body, world_));
  add_box2d_fixtures(made, body, *spawned_.back());
  return spawned_.size() - 1;
}

}  // namespace

std::unique_ptr<Engine<2>> make_box2d_world(const EngineInput<2>& input, std::string& why) {
  if (!input.scene.cloths.empty() || !input.scene.characters.empty()) {
    why = "Box2D has no particles and no characters";
    return nullptr;
  }
  if (!takes_box2d_polygons(input.built.world.state())) {
    why = "a polygon is smaller than what Box2D takes for a point, or has too many corners";
    return nullptr;
  }
  auto world = std::make_unique<Box2dWorld>(input);
  if (world->missing_joint() < 0) return world;
  why = "joint " + std::to_string(world->missing_joint()) + " is of a kind that is not mapped";
  return nullptr;
}

}  // namespace cycloid::peers
