#include "solver/world.hpp"

#include <cstring>

#include "solver/floating_point_mode.hpp"
#include "solver/step_memory.hpp"
#include "solver/validate.hpp"
#include "solver/visit.hpp"
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
std::shared_ptr<StepMemory<D>> make_step_memory() {
  return std::make_shared<StepMemory<D>>();
}
template std::shared_ptr<StepMemory<2>> make_step_memory();
template std::shared_ptr<StepMemory<3>> make_step_memory();

template <int D>
World<D>::World()
    : workers_(std::make_unique<Workers>(1)),
      kept_(std::make_unique<KeptByWorld<D>>()),
      step_memory_(make_step_memory<D>()) {}
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
void World<D>::rest_workers(bool rests) {
  workers_->rest(rests);
}

template <int D>
Error World<D>::set_lanes(int lanes) {
  if (lanes != 0 && lanes != 1 && lanes != 4 && lanes != 8 && lanes != 16)
    return {Code::kInvalid, "lanes"};
  lanes_ = lanes;
  return {};
}

template <int D>
std::optional<Fault> World<D>::fault() const {
  if (state_.header.fault.field == kFaultNone) return std::nullopt;
  return state_.header.fault;
}

template <int D>
void World<D>::trim() {
  // Shared arrays apart: to visit them as arrays of its own would copy what others hold, too.
  SharedArray<Shape<D>> shapes = std::move(state_.shapes);
  SharedArray<Link> links = std::move(state_.links);
  visit_arrays(state_, [](const char*, auto& array) { array.shrink_to_fit(); });
  shapes.shrink_to_fit();
  links.shrink_to_fit();
  state_.shapes = std::move(shapes);
  state_.links = std::move(links);
}

template <class T>
static bool same_bits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// Whether both states have the same static shapes in the same places. A landscape costs many times
/// what a rollback takes, and hardly ever changes.
template <int D>
static bool statics_are_same(const WorldState<D>& a, const WorldState<D>& b) {
  if (!a.shapes.is_same_as(b.shapes) || a.bodies.size() != b.bodies.size()) return false;
  for (std::size_t i = 0; i < a.bodies.size(); ++i) {
    const Body<D>& body_a = a.bodies[i];
    const Body<D>& body_b = b.bodies[i];
    if (body_a.kind != BodyKind::kStatic && body_b.kind != BodyKind::kStatic) continue;
    if (body_a.kind != body_b.kind || !same_bits(body_a.position, body_b.position) ||
        !same_bits(body_a.rotation, body_b.rotation))
      return false;
  }
  return true;
}

template <int D>
void World<D>::restore(const WorldState<D>& from) {
  const bool statics_stay = kept_->pair_cache.statics_are_known && statics_are_same(state_, from);
  state_ = from;
  kept_->pair_cache.forget_all();
  kept_->active_bodies.forget_all();
  kept_->active_contacts.is_known = false;
  kept_->pair_cache.statics_are_known = statics_stay;
  events_.clear();
  ended_.clear();
  statistics_ = {};
}

template <int D>
BodyMotion<D>& World<D>::touched(BodyId id) {
  kept_->active_bodies.touch(id.index);
  return state_.bodies.moved(id.index);
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
