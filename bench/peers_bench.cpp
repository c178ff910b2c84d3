// Our solver beside Bullet on the scenes of space: the same bodies, controls and tick rate, tick
// for tick in one run, so that both meet the same noise. Prints a table and, with --csv FILE, the
// same as CSV. Time is the median of the runs' times for the same ticks; overlap and gap are
// measured with one ruler on the poses of either.
// --substeps N sets ours, --sleep lets both engines put bodies to sleep, --runs N the repetitions.

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <string>
#include <vector>

#include "bench/peers/accuracy.hpp"
#include "bench/peers/bullet_world.hpp"
#include "scenes/catalogue.hpp"
#include "scenes/controls.hpp"

namespace {

namespace peers = cycloid::peers;
namespace scenes = cycloid::scenes;
namespace solver = cycloid::solver;
using Clock = std::chrono::steady_clock;

constexpr int kWarmTicks = 60;
constexpr int kTicks = 300;  ///< Timed, in chunks of kChunk, ours and theirs in turn.
constexpr int kChunk = 20;

std::size_t our_bytes = 0;  ///< Held by operator new; Bullet counts its own.

struct Row {
  std::string scene;
  std::uint32_t bodies = 0;
  std::uint64_t digest = 0;
  double ours_ms = 0.0;
  double bullet_ms = 0.0;
  double rows = 0.0;
  double ours_bytes = 0.0;  ///< Per body.
  double bullet_bytes = 0.0;
  double ours_overlap_mm = 0.0;  ///< At the end.
  double bullet_overlap_mm = 0.0;
  double ours_gap_mm = 0.0;
  double bullet_gap_mm = 0.0;
};

std::vector<scenes::SeatInput> inputs_of(const scenes::Scene& scene, int tick) {
  std::vector<scenes::SeatInput> inputs(scene.seats.size());
  for (std::size_t seat = 0; seat < inputs.size(); ++seat)
    inputs[seat] =
        scenes::scripted_input(scene, static_cast<int>(seat), static_cast<std::uint64_t>(tick) + 1);
  return inputs;
}

struct Pair {
  std::unique_ptr<scenes::Built<3>> ours;
  std::unique_ptr<peers::BulletWorld> bullet;
};

template <class Step>
double seconds_of(const scenes::Scene& scene, int from, int ticks, Step&& step) {
  double seconds = 0.0;
  for (int tick = from; tick < from + ticks; ++tick) {
    const auto inputs = inputs_of(scene, tick);
    const auto start = Clock::now();
    step(inputs);
    seconds += std::chrono::duration<double>(Clock::now() - start).count();
  }
  return seconds;
}

/// Our solver and the row's counts; exits where the world refuses a step.
void step_ours(scenes::Built<3>& built, std::span<const scenes::SeatInput> inputs, Row& row) {
  scenes::apply_controls(built, inputs);
  if (const solver::Error error = built.world.step(); !error.ok()) {
    std::fprintf(stderr, "%s: our world refused a step: %s\n", row.scene.c_str(), error.field);
    std::exit(1);
  }
  row.rows += static_cast<double>(built.world.statistics().rows);
}

Pair make_pair(const scenes::Scene& scene, bool sleep, Row& row) {
  std::vector<scenes::Mistake> mistakes;
  Pair pair;
  const std::size_t ours_before = our_bytes;
  pair.ours = scenes::build<3>(scene, mistakes);
  row.bodies = pair.ours->world.body_count();
  row.ours_bytes = static_cast<double>(our_bytes - ours_before);
  const std::size_t bullet_before = peers::BulletWorld::bytes();
  pair.bullet = std::make_unique<peers::BulletWorld>(*pair.ours, sleep);
  row.bullet_bytes = static_cast<double>(peers::BulletWorld::bytes() - bullet_before);
  return pair;
}

void measure_accuracy(const solver::WorldState<3>& start, const Pair& pair, Row& row) {
  const solver::WorldState<3>& state = pair.ours->world.state();
  const auto ours = [&](std::uint32_t body) {
    return solver::Pose<3>{state.bodies[body].position, state.bodies[body].rotation};
  };
  const auto theirs = [&](std::uint32_t body) { return pair.bullet->pose(body); };
  row.ours_overlap_mm = 1e3 * peers::deepest_overlap(start, ours);
  row.bullet_overlap_mm = 1e3 * peers::deepest_overlap(start, theirs);
  row.ours_gap_mm = 1e3 * peers::widest_gap(start, ours);
  row.bullet_gap_mm = 1e3 * peers::widest_gap(start, theirs);
}

double median(std::vector<double> values) {
  // Total order: equal numbers are one and the same.
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// @param runs  of the whole scene; the time of a chunk is its median over them.
Row measure(const scenes::Scene& scene, int runs, bool sleep) {
  constexpr int kChunks = kTicks / kChunk;
  std::vector<std::vector<double>> ours(kChunks), theirs(kChunks);
  Row row;
  row.scene = scene.name;
  for (int run = 0; run < runs; ++run) {
    row.rows = 0.0;
    Pair pair = make_pair(scene, sleep, row);
    const solver::WorldState<3> start = pair.ours->world.state();
    const auto our_step = [&](auto inputs) { step_ours(*pair.ours, inputs, row); };
    const auto their_step = [&](auto inputs) { pair.bullet->step(inputs); };
    const std::size_t ours_before = our_bytes;
    const std::size_t bullet_before = peers::BulletWorld::bytes();
    seconds_of(scene, 0, kWarmTicks, our_step);
    seconds_of(scene, 0, kWarmTicks, their_step);
    row.rows = 0.0;
    for (int chunk = 0; chunk < kChunks; ++chunk) {
      const int from = kWarmTicks + chunk * kChunk;
      ours[chunk].push_back(seconds_of(scene, from, kChunk, our_step));
      theirs[chunk].push_back(seconds_of(scene, from, kChunk, their_step));
    }
    row.ours_bytes += static_cast<double>(our_bytes - ours_before);
    row.bullet_bytes += static_cast<double>(peers::BulletWorld::bytes() - bullet_before);
    row.digest = pair.ours->world.digest();
    if (run + 1 == runs) measure_accuracy(start, pair, row);
  }
  for (int chunk = 0; chunk < kChunks; ++chunk) {
    row.ours_ms += 1e3 * median(ours[chunk]) / kTicks;
    row.bullet_ms += 1e3 * median(theirs[chunk]) / kTicks;
  }
  row.rows /= kTicks;
  row.ours_bytes /= row.bodies;
  row.bullet_bytes /= row.bodies;
  return row;
}

void print(std::FILE* file, const char* format, const Row& row) {
  std::fprintf(file, format, row.scene.c_str(), row.bodies, row.ours_ms, row.bullet_ms,
               row.ours_ms / row.bullet_ms, row.rows, row.ours_bytes, row.bullet_bytes,
               row.ours_overlap_mm, row.bullet_overlap_mm, row.ours_gap_mm, row.bullet_gap_mm,
               row.digest);
}

}  // namespace

void* operator new(std::size_t size) {
  void* memory = std::malloc(size);
  if (memory == nullptr) throw std::bad_alloc();
  our_bytes += malloc_usable_size(memory);
  return memory;
}
void operator delete(void* memory) noexcept {
  if (memory == nullptr) return;
  our_bytes -= malloc_usable_size(memory);
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  operator delete(memory);
}

int main(int argc, char** argv) {
  std::FILE* csv = nullptr;
  bool sleep = false;
  int runs = 3;
  int substeps = 0;  // 0: the scene's.
  std::vector<std::string> names;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--csv" && i + 1 < argc) {
      csv = std::fopen(argv[++i], "w");
      if (csv == nullptr) return std::perror(argv[i]), 2;
    } else if (argument == "--runs" && i + 1 < argc) {
      runs = std::max(1, std::atoi(argv[++i]));
    } else if (argument == "--substeps" && i + 1 < argc) {
      substeps = std::clamp(std::atoi(argv[++i]), 1, 64);
    } else if (argument == "--sleep") {
      sleep = true;
    } else {
      names.push_back(argument);
    }
  }
  if (names.empty())
    names = {"stack-10-3d", "pyramid-3d", "wall",      "arch-3d",   "ragdolls-3d", "dzhanibekov",
             "top",         "vehicle-3d", "cubes-901", "bridge-3d", "ball-pit-3d"};
  std::printf("%-14s %6s %9s %9s %6s %9s %8s %8s %17s %17s %s\n", "scene", "bodies", "ours ms",
              "Bullet ms", "ratio", "rows/tick", "B/body", "Bullet", "overlap mm", "joint gap mm",
              "digest");
  if (csv != nullptr)
    std::fprintf(csv,
                 "scene,bodies,ours_ms,bullet_ms,ratio,rows,ours_bytes,bullet_bytes,"
                 "ours_overlap_mm,bullet_overlap_mm,ours_gap_mm,bullet_gap_mm,digest\n");
  for (const std::string& name : names) {
    scenes::Loaded loaded = scenes::find(name);
    if (!loaded.scene || loaded.scene->dimension != 3) {
      std::fprintf(stderr, "no scene of space: %s\n", name.c_str());
      return 2;
    }
    if (!sleep) loaded.scene->tuning.sleep_s = 0.0f;
    if (substeps > 0) loaded.scene->tuning.substeps = static_cast<std::uint32_t>(substeps);
    const Row row = measure(*loaded.scene, runs, sleep);
    print(stdout,
          "%-14s %6u %9.4f %9.4f %6.2f %9.0f %8.0f %8.0f %8.2f %8.2f %8.2f %8.2f %016" PRIx64 "\n",
          row);
    std::fflush(stdout);
    if (csv != nullptr)
      print(csv, "%s,%u,%.5f,%.5f,%.3f,%.0f,%.0f,%.0f,%.3f,%.3f,%.3f,%.3f,%016" PRIx64 "\n", row);
  }
  if (csv != nullptr) std::fclose(csv);
  return 0;
}
