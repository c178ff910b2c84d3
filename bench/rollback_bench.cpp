// What the state costs: bytes, saving and restoring beside memcpy, digest, exact encoding,
// rollback, memory and creation. All of a scene in one run, in turn, the best of many rounds.

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "scenes/catalogue.hpp"
#include "scenes/simulation.hpp"
#include "solver/encoding.hpp"

namespace {

namespace scenes = cycloid::scenes;
namespace solver = cycloid::solver;

constexpr int kWarmTicks = 300;
constexpr int kRounds = 400;
constexpr int kRollbackTicks = 8;
constexpr int kIdleWorlds = 20;

constexpr const char* kScenes[] = {
    "room:bodies=20", "room:bodies=60", "room-200", "pyramid:base=10", "pyramid:base=19",
    "half-pipe",      "ragdolls",       "cloth",    "cubes-901",       "ball-pit-3d"};

[[noreturn]] void fail(const std::string& why) {
  std::fprintf(stderr, "%s\n", why.c_str());
  std::exit(1);
}

/// The least of what was measured, us.
class Least {
 public:
  template <class Run>
  void time(int repeats, Run&& run) {
    const auto start = std::chrono::steady_clock::now();
    for (int i = 0; i < repeats; ++i) run();
    const std::chrono::duration<double, std::micro> took = std::chrono::steady_clock::now() - start;
    us_ = std::min(us_, took.count() / repeats);
  }
  double us() const { return us_; }

 private:
  double us_ = 1.0e9;
};

std::size_t heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

scenes::Simulation create(const scenes::Scene& scene) {
  auto created = scenes::Simulation::create(scene);
  if (!created.ok()) fail(created.error().field);
  return std::move(created.value());
}

void step(const scenes::Scene& scene, scenes::Simulation& simulation,
          std::vector<scenes::SeatInput>& inputs) {
  inputs.resize(static_cast<std::size_t>(simulation.seats()));
  for (int seat = 0; seat < simulation.seats(); ++seat)
    inputs[static_cast<std::size_t>(seat)] =
        scenes::scripted_input(scene, seat, simulation.tick() + 1);
  if (!simulation.step(inputs).ok()) fail("step");
}

struct Times {
  Least copy, save, restore, digest, encode, step, rollback;
  Least create;  ///< Of the scene with all its bodies.
  Least make;    ///< Of an empty world.
};

/// What is kept between rounds, so that nothing is allocated in them.
struct KeptForRounds {
  std::vector<std::byte> encoding;
  std::vector<std::byte> copy;
  std::vector<scenes::SeatInput> inputs;
  scenes::Simulation::Saved saved;
  scenes::Simulation::Saved late;
};

std::size_t saved_bytes(const scenes::Simulation& simulation) {
  return simulation.dimension() == 2 ? solver::saved_bytes(simulation.planar()->state())
                                     : solver::saved_bytes(simulation.spatial()->state());
}

/// Memory of one idle world after so many ticks, beside what all of them share.
std::size_t idle_bytes(const scenes::Scene& scene) {
  const scenes::StepMemories memories;
  std::vector<scenes::SeatInput> inputs;
  std::vector<scenes::Simulation> worlds;
  worlds.reserve(1 + kIdleWorlds);
  std::size_t before = 0;
  for (int i = 0; i <= kIdleWorlds; ++i) {
    if (i == 1) before = heap_bytes();
    worlds.push_back(create(scene));
    worlds.back().use_step_memory(memories);
    for (int tick = 0; tick < kWarmTicks; ++tick) step(scene, worlds.back(), inputs);
  }
  return (heap_bytes() - before) / kIdleWorlds;
}

void time_round(const scenes::Scene& scene, scenes::Simulation& simulation, KeptForRounds& kept,
                Times& times) {
  volatile std::uint64_t sink = 0;
  times.copy.time(20, [&] {
    std::memcpy(kept.copy.data(), kept.encoding.data(), kept.encoding.size());
    sink = sink + static_cast<std::uint64_t>(kept.copy[0]);
  });
  times.save.time(20, [&] { simulation.save(kept.saved); });
  times.restore.time(20, [&] { simulation.restore(kept.saved); });
  times.digest.time(5, [&] { sink = sink + simulation.digest(); });
  times.encode.time(5, [&] { simulation.encode(kept.encoding); });
  times.step.time(1, [&] { step(scene, simulation, kept.inputs); });
  times.rollback.time(1, [&] {
    simulation.restore(kept.saved);
    for (int i = 0; i < kRollbackTicks; ++i) {
      step(scene, simulation, kept.inputs);
      simulation.save(kept.late);
    }
  });
  simulation.restore(kept.saved);
}

void measure(const char* name) {
  const scenes::Loaded loaded = scenes::find(name);
  if (!loaded.scene) fail(std::string("no scene ") + name);
  scenes::Scene scene = *loaded.scene;
  scene.tuning.sleep_s = 0.0f;  // Beside a step of who sleeps a digest is no small share.
  const std::size_t idle = idle_bytes(scene);
  scenes::Simulation simulation = create(scene);
  KeptForRounds kept;
  for (int i = 0; i < kWarmTicks; ++i) step(scene, simulation, kept.inputs);
  simulation.digest();  // What no tick changes is hashed in the first, and saves keep that.
  const std::uint32_t contacts = simulation.statistics().contacts;
  simulation.encode(kept.encoding);
  kept.copy.resize(kept.encoding.size());
  simulation.save(kept.saved);
  simulation.save(kept.late);
  Times times;
  for (int round = 0; round < kRounds; ++round) {
    time_round(scene, simulation, kept, times);
    if (round % 20 == 0) times.create.time(1, [&] { create(scene); });
    times.make.time(1, [&] {
      if (!solver::World<2>::create({}).ok()) fail("World::create");
    });
  }
  const double bodies = static_cast<double>(simulation.poses().size());
  const double bytes = static_cast<double>(kept.encoding.size());
  const double step_us = times.step.us();
  std::printf(
      "%-16s %5.0f %5u %8.0f %7zu %4.0f | %7.2f %7.2f %7.2f %5.2f | %7.2f %5.1f | %7.2f %5.1f "
      "| %8.1f %5.2f | %8.1f | %7.1f %5.2f\n",
      name, bodies, contacts, bytes, saved_bytes(simulation),
      static_cast<double>(saved_bytes(simulation)) / bodies, times.copy.us(), times.save.us(),
      times.restore.us(), (times.save.us() + times.restore.us()) / times.copy.us(),
      times.digest.us(), 100.0 * times.digest.us() / step_us, times.encode.us(),
      bytes / times.encode.us() / 1e3, step_us, times.rollback.us() / step_us,
      static_cast<double>(idle) / 1000.0, times.create.us(), times.make.us());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  std::printf(
      "us, the least of %d rounds. memcpy: of the exact encoding. rollback: restore and %d "
      "ticks with a save each, in steps.\n",
      kRounds, kRollbackTicks);
  std::printf(
      "%-16s %5s %5s %8s %7s %4s | %7s %7s %7s %5s | %7s %5s | %7s %5s | %8s %5s | %8s | %7s "
      "%5s\n",
      "scene", "body", "cont", "encoded", "saved", "/bdy", "memcpy", "save", "restore", "ratio",
      "digest", "%step", "encode", "GB/s", "step", "rollb", "idle kB", "scene", "world");
  for (int i = 1; i < argc; ++i) measure(argv[i]);
  if (argc > 1) return 0;
  for (const char* name : kScenes) measure(name);
}
