// Time per tick of every catalogue scene under its script, with 1 and 2 workers. The label is a
// digest: equal for both worker counts, or the timing is of two different things.

#include <benchmark/benchmark.h>

#include <cinttypes>
#include <cstdio>
#include <string>
#include <vector>

#include "scenes/catalogue.hpp"
#include "scenes/simulation.hpp"

namespace {

namespace scenes = cycloid::scenes;
namespace solver = cycloid::solver;

constexpr int kWarmTicks = 120;   ///< Contacts have formed, and buffers have their size.
constexpr int kTimedTicks = 120;  ///< Then back to the warm state, so that each run does the same.

/// Steps so many ticks; false where the world refuses.
bool step(const scenes::Scene& scene, scenes::Simulation& simulation, int ticks) {
  std::vector<scenes::SeatInput> inputs(simulation.seats());
  for (int i = 0; i < ticks; ++i) {
    const std::uint64_t tick = simulation.tick() + 1;
    for (int seat = 0; seat < simulation.seats(); ++seat)
      inputs[seat] = scenes::scripted_input(scene, seat, tick);
    if (!simulation.step(inputs).ok()) return false;
  }
  return true;
}

void step_scene(benchmark::State& state, const std::string& name) {
  const scenes::Loaded loaded = scenes::find(name);
  if (!loaded.scene) return state.SkipWithError("no such scene");
  solver::Result<scenes::Simulation> created = scenes::Simulation::create(*loaded.scene);
  if (!created.ok()) return state.SkipWithError(created.error().field);
  scenes::Simulation& simulation = created.value();
  if (!simulation.set_workers(static_cast<int>(state.range(0))).ok())
    return state.SkipWithError("set_workers");
  if (!step(*loaded.scene, simulation, kWarmTicks)) return state.SkipWithError("warming up");

  scenes::Simulation::Saved warm;
  simulation.save(warm);
  while (state.KeepRunningBatch(kTimedTicks)) {
    if (!step(*loaded.scene, simulation, kTimedTicks)) return state.SkipWithError("stepping");
    state.PauseTiming();
    char label[17];
    std::snprintf(label, sizeof label, "%016" PRIx64, simulation.digest());
    state.SetLabel(label);
    simulation.restore(warm);
    state.ResumeTiming();
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  for (const scenes::CatalogueEntry& entry : scenes::catalogue()) {
    benchmark::RegisterBenchmark(entry.name.c_str(), step_scene, entry.name)
        ->ArgName("workers")
        ->Arg(1)
        ->Arg(2)
        ->UseRealTime()  // The other workers' time is not this thread's.
        ->Unit(benchmark::kMicrosecond);
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
