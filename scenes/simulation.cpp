#include "scenes/simulation.hpp"

#include <variant>

#include "scenes/accuracy.hpp"
#include "scenes/build.hpp"
#include "scenes/characters.hpp"
#include "scenes/controls.hpp"
#include "scenes/thread_choice.hpp"
#include "solver/encoding.hpp"
#include "solver/floating_point_mode.hpp"

namespace cycloid::scenes {

struct Simulation::Running {
  std::variant<std::unique_ptr<Built<2>>, std::unique_ptr<Built<3>>> built;
  Clock now_ns = nullptr;  ///< Null where no choice is to be made.
  ThreadChoice threads;

  /// Calls f with the `Built` of whichever dimension runs.
  template <class F>
  auto visit(F&& f) const {
    return std::visit([&](const auto& pointer) { return f(*pointer); }, built);
  }
};

struct Simulation::Saved::State {
  int dimension = 0;  ///< Which of the two was saved.
  solver::WorldState<2> planar;
  solver::WorldState<3> spatial;
};

Simulation::Saved::Saved() : state_(std::make_unique<State>()) {}
Simulation::Saved::~Saved() = default;
Simulation::Saved::Saved(Saved&&) noexcept = default;
Simulation::Saved& Simulation::Saved::operator=(Saved&&) noexcept = default;

std::uint64_t Simulation::Saved::digest() const {
  return state_->dimension == 2 ? solver::digest_state(state_->planar)
                                : solver::digest_state(state_->spatial);
}

void Simulation::Saved::encode(std::vector<std::byte>& into) const {
  if (state_->dimension == 2)
    solver::encode_state(state_->planar, into);
  else
    solver::encode_state(state_->spatial, into);
}

Simulation::Simulation(std::unique_ptr<Running> running) : running_(std::move(running)) {}
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;
Simulation::~Simulation() = default;

solver::Result<Simulation> Simulation::create(const Scene& scene) {
  if (const auto error = solver::check_arithmetic(solver::rounds_as_written()); !error.ok())
    return error;
  if (lacks_choice(scene)) return solver::Error{solver::Code::kInvalid, "accuracy"};
  std::vector<Mistake> mistakes;
  auto running = std::make_unique<Running>();
  bool good = false;
  if (scene.dimension == 2) {
    auto built = build<2>(scene, mistakes);
    good = built != nullptr;
    if (good) built->world.trim();
    running->built = std::move(built);
  } else if (scene.dimension == 3) {
    auto built = build<3>(scene, mistakes);
    good = built != nullptr;
    if (good) built->world.trim();
    running->built = std::move(built);
  }
  if (!good) return solver::Error{solver::Code::kInvalid, "scene"};
  return Simulation(std::move(running));
}

int Simulation::dimension() const {
  return std::holds_alternative<std::unique_ptr<Built<2>>>(running_->built) ? 2 : 3;
}

int Simulation::seats() const {
  return running_->visit([](const auto& built) { return static_cast<int>(built.seats.size()); });
}

std::uint64_t Simulation::tick() const {
  return running_->visit([](const auto& built) { return built.world.tick(); });
}

float Simulation::tick_s() const {
  return running_->visit([](const auto& built) { return built.world.tick_s(); });
}

solver::Error Simulation::set_workers_at_most(int workers, Clock now_ns) {
  const solver::Error error = set_workers(workers);
  if (!error.ok() || workers == 1) return error;
  running_->now_ns = now_ns;
  running_->threads = {};
  return error;
}

solver::Error Simulation::set_workers(int workers) {
  const solver::Error error =
      running_->visit([&](auto& built) { return built.world.set_workers(workers); });
  if (error.ok()) running_->now_ns = nullptr;
  return error;
}

void Simulation::use_step_memory(const StepMemories& memories) {
  if (solver::World<2>* world = planar()) world->use_step_memory(memories.planar);
  if (solver::World<3>* world = spatial()) world->use_step_memory(memories.spatial);
}

void Simulation::set_lot_contacts(std::uint32_t contacts) {
  running_->visit([&](auto& built) { built.world.set_lot_contacts(contacts); });
}

solver::Error Simulation::set_lanes(int lanes) {
  return running_->visit([&](auto& built) { return built.world.set_lanes(lanes); });
}

solver::Error Simulation::step(std::span<const SeatInput> inputs) {
  if (running_->now_ns == nullptr) return step_once(inputs);
  running_->visit([&](auto& built) { built.world.rest_workers(running_->threads.is_alone()); });
  const std::uint64_t begin_ns = running_->now_ns();
  const solver::Error error = step_once(inputs);
  running_->threads.took(running_->now_ns() - begin_ns);
  return error;
}

/// What refuses a step before the controls, which compute too.
static solver::Error check_step(const Simulation& of, std::span<const SeatInput> inputs) {
  if (inputs.size() != static_cast<std::size_t>(of.seats()))
    return {solver::Code::kInvalid, "inputs"};
  if (!solver::floating_point_mode_is_ieee())
    return {solver::Code::kInvalid, "floating_point_mode"};
  return {};
}

solver::Error Simulation::step_once(std::span<const SeatInput> inputs) {
  if (const solver::Error error = check_step(*this, inputs); !error.ok()) return error;
  return running_->visit([&](auto& built) {
    if (!built.world.fault()) apply_controls(built, inputs);
    return built.world.step();
  });
}

solver::Error Simulation::step_traced(std::span<const SeatInput> inputs, solver::StepTrace& trace) {
  if (const solver::Error error = check_step(*this, inputs); !error.ok()) return error;
  return running_->visit([&](auto& built) {
    if (!built.world.fault()) apply_controls(built, inputs);
    return built.world.step_traced(trace);
  });
}

void Simulation::trace_state(solver::StepTrace& trace) const {
  running_->visit([&](const auto& built) { built.world.trace_state(trace); });
}

std::uint64_t Simulation::digest() const {
  return running_->visit([](const auto& built) { return built.world.digest(); });
}

std::optional<solver::Fault> Simulation::fault() const {
  return running_->visit([](const auto& built) { return built.world.fault(); });
}

void Simulation::encode(std::vector<std::byte>& into) const {
  running_->visit([&](const auto& built) { built.world.encode(into); });
}

std::size_t Simulation::encoded_bytes() const {
  return running_->visit(
      [](const auto& built) { return solver::encoded_bytes(built.world.state()); });
}

/// The registers hold places in rings and characters; a snapshot from outside may name a place that
/// is not there, or a character nowhere.
template <int D>
static bool registers_fit(const Built<D>& built) {
  const auto registers = built.world.registers();
  if (registers.size() != built.register_count) return false;
  for (const BoundSeat& seat : built.seats)
    for (const BoundControl& bound : seat.controls)
      if (bound.control.effect == Effect::kSpawn &&
          registers[bound.first_register] >= bound.control.limit)
        return false;
  return characters_fit(built);
}

solver::Error Simulation::decode(std::span<const std::byte> bytes) {
  return running_->visit([&](auto& built) {
    const auto before = built.world.state();
    const solver::Error error = built.world.decode(bytes);
    if (!error.ok() || registers_fit(built)) return error;
    built.world.restore(before);
    return solver::Error{solver::Code::kCorrupt, "registers"};
  });
}

solver::Statistics Simulation::statistics() const {
  return running_->visit([](const auto& built) { return built.world.statistics(); });
}

/// The quaternion about z of a planar rotation: half of its angle, with w not negative. The larger
/// part comes from the cosine, because 1 + c loses all digits near half a turn.
static std::array<float, 4> quaternion_of(const solver::Rotation<2>& q) {
  const float larger = solver::sqrt(0.5f * (1.0f + solver::abs(q[0])));
  const float smaller = 0.5f * solver::abs(q[1]) / larger;
  const float z = q[0] < 0.0f ? larger : smaller;
  const float w = q[0] < 0.0f ? smaller : larger;
  return {0.0f, 0.0f, q[1] < 0.0f ? -z : z, w};
}
static std::array<float, 4> quaternion_of(const solver::Rotation<3>& q) {
  return {q[0], q[1], q[2], q[3]};
}

template <int D>
static Pose pose_of(const solver::BodyView<D>& body) {
  Pose pose;
  pose.index = body.id.index;
  pose.generation = body.id.generation;
  for (int i = 0; i < D; ++i) pose.position[static_cast<std::size_t>(i)] = body.position[i];
  pose.rotation = quaternion_of(body.rotation);
  return pose;
}

std::vector<Pose> Simulation::poses() const {
  return running_->visit([](const auto& built) {
    std::vector<Pose> poses;
    for (const auto& body : built.world.bodies()) poses.push_back(pose_of(body));
    return poses;
  });
}

template <int D>
static CharacterPose pose_of(const solver::MoverState<D>& state) {
  CharacterPose pose;
  const solver::Vec<D> velocity = state.velocity + state.ground_velocity;
  for (int i = 0; i < D; ++i) {
    pose.position[static_cast<std::size_t>(i)] = state.position[i];
    pose.velocity[static_cast<std::size_t>(i)] = velocity[i];
  }
  pose.grounded = state.grounded;
  return pose;
}

std::vector<CharacterPose> Simulation::characters() const {
  return running_->visit([](const auto& built) {
    std::vector<CharacterPose> poses;
    for (std::size_t i = 0; i < built.characters.size(); ++i)
      poses.push_back(pose_of(character_state(built, i)));
    return poses;
  });
}

std::vector<solver::Difference> Simulation::differences(const Simulation& other,
                                                        std::size_t limit) const {
  if (dimension() != other.dimension())
    return {{"world", "dimension", std::to_string(dimension()), std::to_string(other.dimension())}};
  return running_->visit([&](const auto& built) {
    using Same = std::remove_cvref_t<decltype(built)>;
    const auto& there = *std::get<std::unique_ptr<Same>>(other.running_->built);
    return solver::differences(built.world.state(), there.world.state(), limit);
  });
}

solver::World<2>* Simulation::planar() {
  return dimension() == 2 ? &std::get<0>(running_->built)->world : nullptr;
}
solver::World<3>* Simulation::spatial() {
  return dimension() == 3 ? &std::get<1>(running_->built)->world : nullptr;
}
const solver::World<2>* Simulation::planar() const {
  return dimension() == 2 ? &std::get<0>(running_->built)->world : nullptr;
}
const solver::World<3>* Simulation::spatial() const {
  return dimension() == 3 ? &std::get<1>(running_->built)->world : nullptr;
}

static solver::WorldState<2>& part_of(solver::WorldState<2>& planar, solver::WorldState<3>&,
                                      const Built<2>&) {
  return planar;
}
static solver::WorldState<3>& part_of(solver::WorldState<2>&, solver::WorldState<3>& spatial,
                                      const Built<3>&) {
  return spatial;
}

void Simulation::save(Saved& into) const {
  into.state_->dimension = dimension();
  running_->visit([&](const auto& built) {
    built.world.save(part_of(into.state_->planar, into.state_->spatial, built));
  });
}

void Simulation::restore(const Saved& from) {
  running_->visit([&](auto& built) {
    built.world.restore(part_of(from.state_->planar, from.state_->spatial, built));
  });
}

}  // namespace cycloid::scenes
