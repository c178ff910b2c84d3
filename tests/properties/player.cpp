#include "tests/properties/player.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "solver/queries/query.hpp"
#include "solver/trace.hpp"

namespace cycloid::properties {

using solver::BodyId;
using solver::Error;
using solver::Result;
using solver::World;

Answer answer_of(const Error& error) {
  return {error.code, error.field, error.index, 0, 0};
}

std::string text_of(const Answer& answer) {
  return std::string(solver::code_name(answer.code)) + " \"" + answer.field + "\" " +
         std::to_string(answer.index) + ", id " + std::to_string(answer.id_index) + "." +
         std::to_string(answer.id_generation);
}

static Setting setting_of(std::uint32_t choice) {
  constexpr int kWorkers[] = {1, 2, 3, 8};
  constexpr int kLanes[] = {4, 1, 8, 16};
  constexpr int kLots[] = {0, 1, 3, 12};
  return {kWorkers[choice % 4], kLanes[choice / 4 % 4], kLots[choice / 16 % 4]};
}

template <int D>
Player<D>::Player(const Case& example, const Setting& setting, bool revisits, Flaw flaw)
    : example_(example), setting_(setting), revisits_(revisits), flaw_(flaw) {
  world_ = make_world();
  const Piece<D> ground = ground_of<D>(example.ground);
  if (!ground.shapes.empty()) (void)create(ground);
}

template <int D>
std::unique_ptr<World<D>> Player<D>::make_world() const {
  auto world =
      std::make_unique<World<D>>(std::move(World<D>::create(world_of<D>(example_)).value()));
  register_shelf(*world);
  (void)world->set_workers(setting_.workers);
  (void)world->set_lanes(setting_.lanes);
  world->set_lot_contacts(static_cast<std::uint32_t>(setting_.lot_contacts));
  // Steps of all cases, one after the other, in one memory: what is left in it must not show.
  static const auto kMemory = solver::make_step_memory<D>();
  if (revisits_) world->use_step_memory(kMemory);
  return world;
}

template <int D>
Answer Player<D>::create(const Piece<D>& piece) {
  return keep(world_->create_body(piece.body, piece.shapes), alive_.bodies);
}

template <int D>
Answer Player<D>::step() {
  if (stranger_ != nullptr) (void)stranger_->step();
  if (past_ != nullptr) past_->since.push_back({});
  solver::StepTrace trace;
  const Answer answer = answer_of(traced_ > 0 ? world_->step_traced(trace) : world_->step());
  traced_ -= traced_ > 0 ? 1 : 0;
  destroyed_ = restored_ = false;
  return answer;
}

template <int D>
void Player<D>::forget() {
  // As bytes: a state in memory shares its shapes with the world, which by that knows them again.
  std::vector<std::byte> bytes;
  world_->encode(bytes);
  if (!world_->decode(bytes).ok()) complaint_ = "its own bytes are refused";
  restored_ = true;
}

template <int D>
Answer Player<D>::obey_body(const Command& command, BodyId id) {
  World<D>& world = *world_;
  const solver::Vec<D> vector = vector_of<D>(command, 0);
  const solver::Spin<D> spin = spin_of<D>(command, 3);
  const float number = number_of(command, 6);
  // Now and then as fast as to go through things, or to leave what float can hold.
  const float factor = command.b % 16 == 15 ? 900.0f : 1.0f;
  switch (command.op) {
    case Op::kSetPose:
      return answer_of(world.set_pose(id, vector, rotation_of<D>(command.v[7])));
    case Op::kSetVelocity:
      return answer_of(world.set_velocity(id, factor * vector, factor * spin));
    case Op::kForce:
      return answer_of(world.apply_force(id, (30.0f * factor) * vector));
    case Op::kTorque:
      return answer_of(world.apply_torque(id, 10.0f * spin));
    case Op::kImpulse:
      return answer_of(world.apply_impulse(id, factor * vector));
    case Op::kAngularImpulse:
      return answer_of(world.apply_angular_impulse(id, spin));
    case Op::kGravityScale:
      return answer_of(world.set_gravity_scale(id, number));
    case Op::kDamping:
      return answer_of(world.set_damping(id, number, 0.4f));
    case Op::kMass:
      return answer_of(world.set_mass(id, number));
    default: {
      solver::Filter filter;
      filter.mask = static_cast<std::uint32_t>(command.v[6] + 100);
      filter.category = 1 + command.b % 3;
      return answer_of(world.set_filter(id, command.b % 2, filter));
    }
  }
}

template <int D>
Answer Player<D>::obey_joint(const Command& command) {
  World<D>& world = *world_;
  const solver::JointId id = one_of(alive_.joints, command.a);
  const float first = number_of(command, 0);
  const float second = number_of(command, 1);
  const bool enabled = command.b % 4 != 0;
  switch (command.op) {
    case Op::kCreateJoint: {
      solver::JointDef<D> def = joint_of<D>(command);
      def.body_a = one_of(alive_.bodies, command.a);
      def.body_b = one_of(alive_.bodies, command.b);
      return keep(world.create_joint(def), alive_.joints);
    }
    case Op::kDestroyJoint:
      return drop(world.destroy_joint(id), command.a, alive_.joints);
    case Op::kMotor:
      return answer_of(world.set_motor(id, enabled, first, 50.0f));
    case Op::kTarget:
      return answer_of(world.set_target(id, first, 60.0f));
    case Op::kSteering:
      return answer_of(world.set_steering(id, 0.3f * first));
    case Op::kAnchor:
      return answer_of(world.set_anchor(id, vector_of<D>(command, 0)));
    case Op::kLimits:
      return answer_of(world.set_limits(id, enabled, 0.2f * first, 0.2f * second));
    default:
      return answer_of(world.set_spring(id, first, second, 0.5f));
  }
}

template <int D>
Answer Player<D>::obey_particle(const Command& command) {
  World<D>& world = *world_;
  switch (command.op) {
    case Op::kCreateParticle: {
      solver::ParticleDef<D> def;
      def.position = vector_of<D>(command, 0);
      def.velocity = vector_of<D>(command, 3);
      if (command.b % 4 == 3) def.mass = 0.0f;
      def.radius = 0.05f;
      return keep(world.create_particle(def), alive_.particles);
    }
    case Op::kDestroyParticle:
      return drop(world.destroy_particle(one_of(alive_.particles, command.a)), command.a,
                  alive_.particles);
    case Op::kCreateLink: {
      const float length = number_of(command, 0);
      return keep(world.create_link(
                      {one_of(alive_.particles, command.a), one_of(alive_.particles, command.b),
                       length < 0.0f ? -length : length, command.b % 2 == 0 ? 0.0f : 0.001f}),
                  alive_.links);
    }
    case Op::kDestroyLink:
      return drop(world.destroy_link(one_of(alive_.links, command.a)), command.a, alive_.links);
    case Op::kCreatePin:
      return keep(world.create_pin({one_of(alive_.particles, command.a),
                                    one_of(alive_.bodies, command.b), vector_of<D>(command, 0)}),
                  alive_.pins);
    default:
      return drop(world.destroy_pin(one_of(alive_.pins, command.a)), command.a, alive_.pins);
  }
}

template <int D>
Answer Player<D>::obey_world(const Command& command) {
  World<D>& world = *world_;
  switch (command.op) {
    case Op::kGravity:
      return answer_of(world.set_gravity(vector_of<D>(command, 0)));
    case Op::kSurface:
      return answer_of(world.set_material(command.a % 3, surface_of(command)));
    case Op::kMaterial:
      return answer_of(world.set_material(
          command.a % 4, {number_of(command, 0), 0.3f, number_of(command, 1), 0.01f}));
    case Op::kTuning:
      return answer_of(world.set_tuning(tuning_after(world.tuning(), command)));
    default:
      if (command.b % 2 == 0) return answer_of(world.resize_registers(command.a % 20));
      return answer_of(world.set_register(command.a % 18, command.b));
  }
}

template <int D>
std::vector<Answer> Player<D>::obey(const Command& command) {
  if (past_ != nullptr && command.op != Op::kRevisit) past_->since.push_back(command);
  switch (command.op) {
    case Op::kCreateBody:
      return {create(piece_of<D>(command))};
    case Op::kCreateGrid:
      return create_all(grid_of<D>(command));
    case Op::kCreateChain:
      return create_chain(command);
    case Op::kDestroyBody:
      destroyed_ = true;
      return {
          drop(world_->destroy_body(one_of(alive_.bodies, command.a)), command.a, alive_.bodies)};
    case Op::kRevisit:
      if (revisits_) revisit(command);
      return {};
    case Op::kGravity:
    case Op::kMaterial:
    case Op::kTuning:
    case Op::kRegisters:
    case Op::kSurface:
      return {obey_world(command)};
    case Op::kCreateCrowd:
    case Op::kCreateLand:
    case Op::kCreateSolid:
    case Op::kCreateCloth:
    case Op::kCreateDrive:
      return obey_anew(command);
    default:
      if (command.op >= Op::kCreateParticle) return {obey_particle(command)};
      if (command.op >= Op::kCreateJoint) return {obey_joint(command)};
      return {obey_body(command, one_of(alive_.bodies, command.a))};
  }
}

template <int D>
void Player<D>::revisit(const Command& command) {
  const auto how = static_cast<Revisit>(command.b % static_cast<std::uint32_t>(Revisit::kCount));
  if (how <= Revisit::kAfterAnother || how == Revisit::kAfterEdits || how == Revisit::kTwin)
    restored_ = true;
  solver::WorldState<D> saved;
  std::vector<std::byte> bytes;
  const auto decode = [&] {
    if (const Error error = world_->decode(bytes); !error.ok())
      complaint_ = std::string("a world refuses its own encoding: ") + error.field + " " +
                   std::to_string(error.index);
  };
  switch (how) {
    case Revisit::kMemory:
      world_->save(saved);
      world_->restore(saved);
      return damage();
    case Revisit::kBytes:
      world_->encode(bytes);
      decode();
      return damage();
    case Revisit::kFreshWorld:
      world_->encode(bytes);
      world_ = make_world();
      decode();
      return damage();
    case Revisit::kAfterAnother:
      world_->save(saved);
      for (std::uint32_t i = 0; i < 1 + command.a % 3; ++i) {
        (void)world_->destroy_body(one_of(alive_.bodies, command.a + i));
        (void)world_->set_gravity(vector_of<D>(command, 0));
        (void)world_->step();
      }
      world_->restore(saved);
      return damage();
    case Revisit::kMove: {
      World<D> moved = std::move(*world_);
      world_ = std::make_unique<World<D>>(std::move(moved));
      return;
    }
    case Revisit::kSettings:
      setting_ = setting_of(command.a);
      (void)world_->set_workers(setting_.workers);
      (void)world_->set_lanes(setting_.lanes);
      world_->set_lot_contacts(static_cast<std::uint32_t>(setting_.lot_contacts));
      return;
    case Revisit::kStranger:
      stranger_ = make_world();
      for (const Piece<D>& piece : grid_of<D>(command))
        (void)stranger_->create_body(piece.body, piece.shapes);
      return;
    case Revisit::kTrim:
      return rest_and_trim(command);
    case Revisit::kTraced:
      traced_ = 1 + command.a % 2;
      return;
    case Revisit::kAfterEdits:
      edit_and_restore(command);
      return damage();
    case Revisit::kTwin:
      change_places();
      return damage();
    case Revisit::kReplay:
      return replay();
    default:
      return look();
  }
}

/// The flaw, put into a state that has just come back.
template <int D>
void Player<D>::damage() {
  if (flaw_ == Flaw::kNone) return;
  solver::WorldState<D> state = world_->state();
  if (flaw_ == Flaw::kLowestBit && !state.bodies.empty()) {
    float& value = state.bodies.moved(state.bodies.size() - 1).velocity[0];
    value = std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) ^ 1u);
  }
  if (flaw_ == Flaw::kForgottenForces)
    for (std::size_t i = 0; i < state.bodies.size(); ++i)
      state.bodies.moved(i).force = solver::Vec<D>::zero();
  if (flaw_ == Flaw::kFreeListReversed)
    std::reverse(state.free_bodies.begin(), state.free_bodies.end());
  if (flaw_ == Flaw::kForgottenMemory) state.contacts.clear();
  world_->restore(state);
}

template <int D>
void Player<D>::look() const {
  const World<D>& world = *world_;
  std::vector<std::byte> bytes;
  world.encode(bytes);
  (void)world.digest();
  for (const BodyId id : alive_.bodies) (void)world.body(id);
  for (const solver::JointId id : alive_.joints) {
    (void)world.joint_angle(id);
    (void)world.joint_separation(id);
  }
  (void)world.bodies();
  (void)world.statistics();
  solver::Vec<D> down = solver::Vec<D>::zero();
  down[1] = -50.0f;
  (void)solver::ray_cast(world.state(), -down, down, {});
  (void)solver::closest_point(world.state(), down, 100.0f, {});
}

template class Player<2>;
template class Player<3>;

}  // namespace cycloid::properties
