#include "solver/world.hpp"

#include "solver/floating_point_mode.hpp"
#include "solver/step_scratch.hpp"
#include "solver/validate.hpp"
#include "solver/workers.hpp"

namespace cycloid::solver {

const char* fault_field_name(std::uint64_t field) {
  switch (field) {
    case kFaultNone:
      return "";
    case kFaultPosition:
      return "position";
    case kFaultRotation:
      return "rotation";
    case kFaultVelocity:
      return "velocity";
    case kFaultSpin:
      return "spin";
    case kFaultContacts:
      return "limits.contacts";
    case kFaultParticle:
      return "particle";
    default:
      return "unknown";
  }
}

template <int D>
World<D>::World()
    : workers_(std::make_unique<Workers>(1)), scratch_(std::make_unique<StepScratch<D>>()) {}
template <int D>
World<D>::World(World&&) noexcept = default;
template <int D>
World<D>& World<D>::operator=(World&&) noexcept = default;
template <int D>
World<D>::~World() = default;

template <int D>
Result<World<D>> World<D>::create(const WorldDef<D>& def, bool caller_rounds_as_written) {
  if (const Error error = check_arithmetic(caller_rounds_as_written); !error.ok()) return error;
  if (const Error error = validate(def); !error.ok()) return error;
  World world;
  world.state_.header.gravity = def.gravity;
  world.state_.header.tick_s = def.tick_s;
  world.state_.header.tuning = def.tuning;
  world.state_.header.limits = def.limits;
  world.state_.materials = def.materials;
  return world;
}

template <int D>
Error World<D>::set_workers(int workers) {
  if (workers < 1 || workers > 64) return {Code::kInvalid, "workers"};
  if (!floating_point_mode_is_ieee()) return {Code::kInvalid, "floating_point_mode"};
  workers_ = std::make_unique<Workers>(workers);
  return {};
}

template <int D>
Error World<D>::set_lanes(int lanes) {
  if (lanes != 1 && lanes != 4 && lanes != 8 && lanes != 16) return {Code::kInvalid, "lanes"};
  lanes_ = lanes;
  return {};
}

template <int D>
std::optional<Fault> World<D>::fault() const {
  if (state_.header.fault.field == kFaultNone) return std::nullopt;
  return state_.header.fault;
}

template <int D>
void World<D>::restore(const WorldState<D>& from) {
  state_ = from;
  scratch_->statics_are_listed = false;
  events_.clear();
  ended_.clear();
  statistics_ = {};
}

template <int D>
Error World<D>::check(BodyId id) const {
  if (!contains(id)) return {Code::kUnknownId, "body"};
  return {};
}

template <int D>
Error World<D>::check(JointId id) const {
  const bool known = id.index < state_.joints.size() &&
                     state_.joints[id.index].kind != JointKind::kFree &&
                     state_.joints[id.index].generation == id.generation;
  if (!known) return {Code::kUnknownId, "joint"};
  return {};
}

template <int D>
bool World<D>::contains(BodyId id) const {
  return id.index < state_.bodies.size() && state_.bodies[id.index].kind != BodyKind::kFree &&
         state_.bodies[id.index].generation == id.generation;
}

template <int D>
std::uint32_t World<D>::body_count() const {
  return static_cast<std::uint32_t>(state_.bodies.size() - state_.free_bodies.size());
}

template <int D>
static BodyView<D> view_of(const Body<D>& body, std::uint32_t index) {
  BodyView<D> view;
  view.id = {index, body.generation};
  view.kind = body.kind;
  view.position = body.position - rotate(body.rotation, body.local_center);
  view.rotation = body.rotation;
  view.velocity = body.velocity;
  view.spin = body.spin;
  view.mass = body.mass;
  view.tag = (std::uint64_t{body.tag[1]} << 32) | body.tag[0];
  return view;
}

template <int D>
Result<BodyView<D>> World<D>::body(BodyId id) const {
  if (const Error error = check(id); !error.ok()) return error;
  return view_of(state_.bodies[id.index], id.index);
}

template <int D>
std::vector<BodyView<D>> World<D>::bodies() const {
  std::vector<BodyView<D>> views;
  views.reserve(body_count());
  for (std::uint32_t i = 0; i < state_.bodies.size(); ++i)
    if (state_.bodies[i].kind != BodyKind::kFree) views.push_back(view_of(state_.bodies[i], i));
  return views;
}

template <int D>
Error World<D>::resize_registers(std::uint32_t count) {
  if (count > state_.header.limits.registers) return {Code::kCapacity, "limits.registers"};
  state_.registers.resize(count, 0);
  return {};
}

template <int D>
Error World<D>::set_register(std::uint32_t index, std::uint32_t value) {
  if (index >= state_.registers.size()) return {Code::kInvalid, "index"};
  state_.registers[index] = value;
  return {};
}

// Instantiates what is defined in this file; the other files of the class list their members.
template class World<2>;
template class World<3>;

}  // namespace cycloid::solver
