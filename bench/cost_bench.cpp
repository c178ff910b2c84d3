// cycloid_cost SCENE WARM TICKS RUNS: steps a scene WARM ticks under its script, then
// times the next TICKS, RUNS times from the same state. Prints processor microseconds per tick of
// the fastest run, the rows that were solved, and the digest at the end. bench/cost.py runs it,
// built with several sets of flags.

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "bench/worlds/bench_worlds.hpp"
#include "scenes/catalogue.hpp"
#include "scenes/simulation.hpp"

#ifdef CYCLOID_FREE_ARITHMETIC
namespace cycloid::solver {
const bool kMeasuresFreeArithmetic = true;
}
#endif

namespace {

namespace scenes = cycloid::scenes;

/// Steps so many ticks and adds up the rows; false where the world refuses.
bool step(const scenes::Scene& scene, scenes::Simulation& simulation, int ticks,
          std::uint64_t& rows) {
  std::vector<scenes::SeatInput> inputs(static_cast<std::size_t>(simulation.seats()));
  for (int i = 0; i < ticks; ++i) {
    const std::uint64_t tick = simulation.tick() + 1;
    for (int seat = 0; seat < simulation.seats(); ++seat)
      inputs[static_cast<std::size_t>(seat)] = scenes::scripted_input(scene, seat, tick);
    if (!simulation.step(inputs).ok()) return false;
    rows += simulation.statistics().rows;
  }
  return true;
}

}  // namespace

/// A name of its own, by which callgrind counts these ticks and no others.
extern "C" [[gnu::noinline]] bool cycloid_cost_timed(const scenes::Scene& scene,
                                                     scenes::Simulation& simulation, int ticks,
                                                     std::uint64_t& rows) {
  return step(scene, simulation, ticks, rows);
}

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fprintf(stderr, "usage: cycloid_cost SCENE WARM TICKS RUNS\n");
    return 2;
  }
  const int ticks = std::atoi(argv[3]);
  const auto world = cycloid::worlds::find_bench_world(argv[1]);
  if (!world || ticks < 1) {
    std::fprintf(stderr, "cycloid_cost: no such scene, or no ticks\n");
    return 2;
  }
  const scenes::Scene scene = cycloid::worlds::make_scene(*world);
  auto created = scenes::Simulation::create(scene);
  std::uint64_t rows = 0;
  // Of every processor alike; the choice by itself would count another set of instructions on each.
  constexpr int kLanes = 4;
  if (!created.ok() || !created.value().set_lanes(kLanes).ok() ||
      !step(scene, created.value(), std::atoi(argv[2]), rows)) {
    std::fprintf(stderr, "cycloid_cost: %s\n", created.ok() ? "a step" : created.error().field);
    return 1;
  }
  scenes::Simulation::Saved warm;
  created.value().save(warm);
  double fastest_s = 1e9;
  for (int run = 0; run < std::atoi(argv[4]); ++run) {
    created.value().restore(warm);
    rows = 0;
    const std::clock_t start = std::clock();  // Of this process: others share the machine.
    if (!cycloid_cost_timed(scene, created.value(), ticks, rows)) return 1;
    const double taken_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    fastest_s = taken_s < fastest_s ? taken_s : fastest_s;
  }
  std::printf("%.4f %" PRIu64 " %016" PRIx64 "\n", fastest_s * 1e6 / ticks, rows,
              created.value().digest());
  return 0;
}
