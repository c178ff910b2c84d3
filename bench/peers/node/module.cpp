// Our solver as a WebAssembly module that a page or Node calls: worlds by number, scenes as JSON,
// and the ruler for the poses of any engine. Built by the toolchains of WebAssembly alone.

#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <vector>

#include "bench/peers/accuracy.hpp"
#include "scenes/build.hpp"
#include "scenes/simulation.hpp"

namespace {

namespace peers = cycloid::peers;
namespace scenes = cycloid::scenes;
namespace solver = cycloid::solver;

std::vector<char> buffer;  ///< What goes in and comes out: JSON, or poses as floats.
std::vector<std::optional<scenes::Simulation>> simulations;
std::optional<scenes::Simulation> reference;  ///< The ruler's scene, at tick 0.
peers::Accuracy measured;

/// Where the caller says its bodies are: x, y, z and a quaternion each, of the frames of bodies.
template <int D>
solver::Pose<D> told_pose(const solver::WorldState<D>& state, std::uint32_t body) {
  float values[7];
  if (sizeof values * (body + std::size_t{1}) > buffer.size()) std::abort();
  std::memcpy(values, buffer.data() + sizeof values * body, sizeof values);
  solver::Pose<D> pose;
  for (int i = 0; i < D; ++i) pose.position[i] = values[i];
  if constexpr (solver::Dim<D>::kRotation == 2)
    pose.rotation = {{values[6] * values[6] - values[5] * values[5], 2.0f * values[5] * values[6]}};
  else
    pose.rotation = {{values[3], values[4], values[5], values[6]}};
  pose.position += rotate(pose.rotation, state.bodies[body].local_center);
  return pose;
}

template <int D>
peers::Accuracy accuracy_of(const solver::WorldState<D>& state) {
  return peers::measure_accuracy<D>(state,
                                    [&](std::uint32_t body) { return told_pose(state, body); });
}

/// Velocities and spins to the buffer, six floats behind each pose; in the plane the last one is
/// the spin.
template <int D>
void write_twists(const std::vector<solver::BodyView<D>>& bodies) {
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    float values[6] = {};
    for (int i = 0; i < D; ++i) values[i] = bodies[b].velocity[i];
    for (int i = 0; i < solver::Dim<D>::kSpin; ++i)
      values[solver::Dim<D>::kSpin == 1 ? 5 : 3 + i] = bodies[b].spin[i];
    std::memcpy(buffer.data() + 52 * b + 28, values, sizeof values);
  }
}

std::optional<scenes::Simulation> simulation_of(std::size_t bytes) {
  if (bytes > buffer.size()) std::abort();
  const scenes::Loaded loaded = scenes::from_json(std::string_view(buffer.data(), bytes));
  if (!loaded.scene) return std::nullopt;
  auto created = scenes::Simulation::create(*loaded.scene);
  if (!created.ok()) return std::nullopt;
  return std::move(created.value());
}

/// Where a world is, if the number is one's that was made and not destroyed; else a trap, for there
/// is nothing that a call could do then.
std::optional<scenes::Simulation>& place_of(int world) {
  const auto place = static_cast<std::size_t>(world);
  if (place >= simulations.size() || !simulations[place]) std::abort();
  return simulations[place];
}

}  // namespace

extern "C" {

// There are no exceptions here: what would throw ends the module, and its caller sees a trap.
void* __cxa_allocate_exception(std::size_t bytes) noexcept {
  return std::malloc(bytes);
}
[[noreturn]] void __cxa_throw(void*, void*, void (*)(void*)) {
  std::abort();
}

/// The buffer, of so many bytes from now on: those that it held stay, as far as they fit. Where it
/// lies holds until the next call of this, `poses` or `motions`.
__attribute__((export_name("buffer"))) char* module_buffer(std::size_t bytes) {
  buffer.resize(bytes);
  return buffer.data();
}

/// A world of the scene whose JSON is the first `bytes` of the buffer: its number, or -1 where the
/// JSON is no scene that runs. Text that is no JSON, and more bytes than there are, are traps.
__attribute__((export_name("create"))) int module_create(std::size_t bytes) {
  auto made = simulation_of(bytes);
  if (!made) return -1;
  simulations.push_back(std::move(made));
  return static_cast<int>(simulations.size()) - 1;
}

/// Here and below, a number that is no world's is a trap.
__attribute__((export_name("destroy"))) void module_destroy(int world) {
  place_of(world).reset();
}

/// One tick of a scene without seats; 0, or 1 where the world refuses.
__attribute__((export_name("step"))) int module_step(int world) {
  return place_of(world)->step({}).ok() ? 0 : 1;
}

__attribute__((export_name("digest"))) std::uint64_t module_digest(int world) {
  return place_of(world)->digest();
}

/// Writes the poses of all bodies to the buffer, in their order; returns how many there are.
__attribute__((export_name("poses"))) std::size_t module_poses(int world) {
  const std::vector<scenes::Pose> poses = place_of(world)->poses();
  buffer.resize(poses.size() * 7 * sizeof(float));
  for (std::size_t i = 0; i < poses.size(); ++i) {
    std::memcpy(buffer.data() + 28 * i, poses[i].position.data(), 12);
    std::memcpy(buffer.data() + 28 * i + 12, poses[i].rotation.data(), 16);
  }
  return poses.size();
}

/// Writes to the buffer of every body its pose, velocity and spin, 13 floats; returns how many
/// bodies there are.
__attribute__((export_name("motions"))) std::size_t module_motions(int world) {
  const std::size_t count = module_poses(world);
  const std::vector<char> poses = buffer;
  buffer.resize(count * 52);
  for (std::size_t i = 0; i < count; ++i)
    std::memcpy(buffer.data() + 52 * i, poses.data() + 28 * i, 28);
  const scenes::Simulation& simulation = *place_of(world);
  if (simulation.dimension() == 3)
    write_twists(simulation.spatial()->bodies());
  else
    write_twists(simulation.planar()->bodies());
  return count;
}

/// Takes the scene of the buffer as that which the ruler measures; 0, or 1 where the JSON is none,
/// and then the ruler has none. Traps as `create` does.
__attribute__((export_name("rule"))) int module_rule(std::size_t bytes) {
  reference = simulation_of(bytes);
  return reference ? 0 : 1;
}

/// Measures the poses in the buffer: the deepest overlap, m, or -1 where a body is nowhere. Without
/// a scene of `rule`, or with fewer poses than it has bodies, a trap.
__attribute__((export_name("overlap"))) float module_overlap() {
  if (!reference) std::abort();
  measured = reference->dimension() == 3 ? accuracy_of(reference->spatial()->state())
                                         : accuracy_of(reference->planar()->state());
  return measured.finite ? measured.overlap_m : -1.0f;
}

/// The widest gap of a joint at the last `overlap`, m.
__attribute__((export_name("gap"))) float module_gap() {
  return measured.gap_m;
}
}
