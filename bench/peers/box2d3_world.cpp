#include "bench/peers/box2d3_world.hpp"

#include <algorithm>

#include "bench/peers/box2d3_parts.hpp"
#include "bench/peers/driven_engine.hpp"

namespace cycloid::peers {
namespace {

constexpr int kSubsteps = 4;

class Box2d3World final : public DrivenEngine<2> {
 public:
  explicit Box2d3World(const EngineInput<2>& input);
  ~Box2d3World() override { b2DestroyWorld(world_); }
  Box2d3World(const Box2d3World&) = delete;
  Box2d3World& operator=(const Box2d3World&) = delete;

  /// Of the first joint that is not there; -1: all are.
  int missing_joint() const { return missing_joint_; }

  solver::Pose<2> pose(std::uint32_t body) const override {
    const b2Pos at = b2Body_GetWorldCenter(bodies_[body]);
    const b2Rot turn = b2Body_GetRotation(bodies_[body]);
    return {{{at.x, at.y}}, {{turn.c, turn.s}}};
  }
  Twist<2> twist(std::uint32_t body) const override {
    const b2Vec2 velocity = b2Body_GetLinearVelocity(bodies_[body]);
    return {{{velocity.x, velocity.y}}, {{b2Body_GetAngularVelocity(bodies_[body])}}};
  }
  std::uint32_t contacts() const override;

 protected:
  void advance() override {
    const float step_s = tick_s_ / static_cast<float>(steps_);
    for (int i = 0; i < steps_; ++i) b2World_Step(world_, step_s, substeps_);
  }
  void push(std::uint32_t body, const solver::Vec<2>& force_n) override {
    b2Body_ApplyForceToCenter(bodies_[body], to_box2d3(force_n), true);
  }
  void kick(std::uint32_t body, const solver::Vec<2>& impulse_n_s) override {
    b2Body_ApplyLinearImpulseToCenter(bodies_[body], to_box2d3(impulse_n_s), true);
  }
  void turn(std::uint32_t body, const solver::Spin<2>& torque_n_m) override {
    b2Body_ApplyTorque(bodies_[body], torque_n_m[0], true);
  }
  void set_motor_speed(std::uint32_t joint, float speed) override {
    if (b2Joint_GetType(joints_[joint]) == b2_revoluteJoint)
      b2RevoluteJoint_SetMotorSpeed(joints_[joint], speed);
    else if (b2Joint_GetType(joints_[joint]) == b2_prismaticJoint)
      b2PrismaticJoint_SetMotorSpeed(joints_[joint], speed);
  }
  void set_steering(std::uint32_t, float) override {}
  std::size_t spawn(const solver::WorldState<2>& made) override {
    spawned_.push_back(add_box2d3_body(made, made.bodies[0], world_));
    return spawned_.size() - 1;
  }
  void remove_spawned(std::size_t number) override { b2DestroyBody(spawned_[number]); }

 private:
  b2WorldId world_;
  float tick_s_;
  int steps_;
  int substeps_;
  std::vector<b2BodyId> bodies_;
  std::vector<b2JointId> joints_;
  std::vector<b2BodyId> spawned_;
  int missing_joint_ = -1;
};

Box2d3World::Box2d3World(const EngineInput<2>& input)
    : DrivenEngine(input.built),
      tick_s_(input.built.world.tick_s()),
      steps_(std::max(1, input.settings.substeps)),
      substeps_(input.settings.iterations > 0 ? input.settings.iterations : kSubsteps) {
  const solver::WorldState<2>& state = input.built.world.state();
  b2WorldDef def = b2DefaultWorldDef();
  def.gravity = to_box2d3(state.header.gravity);
  def.enableSleep = input.settings.sleep;
  world_ = b2CreateWorld(&def);
  for (const solver::Body<2>& body : state.bodies)
    bodies_.push_back(add_box2d3_body(state, body, world_));
  for (const solver::Joint<2>& joint : state.joints) {
    joints_.push_back(
        add_box2d3_joint(joint, bodies_[joint.body_a], bodies_[joint.body_b], world_));
    if (B2_IS_NULL(joints_.back()) && missing_joint_ < 0)
      missing_joint_ = static_cast<int>(joints_.size()) - 1;
  }
}

/// A contact is listed with both of its bodies, so it counts with the one that it names first.
std::uint32_t Box2d3World::contacts() const {
  std::uint32_t count = 0;
  std::vector<b2ContactData> of_body;
  for (const b2BodyId body : bodies_) {
    of_body.resize(static_cast<std::size_t>(b2Body_GetContactCapacity(body)));
    const int touching =
        b2Body_GetContactData(body, of_body.data(), static_cast<int>(of_body.size()));
    for (int i = 0; i < touching; ++i) {
      const b2BodyId first = b2Shape_GetBody(of_body[static_cast<std::size_t>(i)].shapeIdA);
      if (B2_ID_EQUALS(first, body)) ++count;
    }
  }
  return count;
}

}  // namespace

std::unique_ptr<Engine<2>> make_box2d3_world(const EngineInput<2>& input, std::string& why) {
  if (!input.scene.cloths.empty() || !input.scene.characters.empty()) {
    why = "Box2D has no particles and no characters";
    return nullptr;
  }
  if (!takes_box2d3_polygons(input.built.world.state())) {
    why = "a polygon has corners that Box2D takes for one, or too many";
    return nullptr;
  }
  auto world = std::make_unique<Box2d3World>(input);
  if (world->missing_joint() < 0) return world;
  why = "joint " + std::to_string(world->missing_joint()) + " is of a kind that is not mapped";
  return nullptr;
}

}  // namespace cycloid::peers
