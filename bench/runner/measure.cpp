#include "bench/runner/measure.hpp"

#include <malloc.h>
#include <time.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "bench/peers/engine.hpp"

namespace cycloid::bench {
namespace {

constexpr int kChunks = 12;  ///< Of the timed ticks; in each of them every engine has its turn.

/// A peer that takes longer to warm up is left out: its table would take hours.
constexpr double kWarmUpMax_s = 60.0;

double median(std::vector<double> values) {
  // Total order: equal numbers are one and the same.
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

double heap_bytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

double seconds_now(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// What the scene's own script says in ticks [from, from + count).
std::vector<std::vector<scenes::SeatInput>> inputs_of(const scenes::Scene& scene, int from,
                                                      int count) {
  std::vector<std::vector<scenes::SeatInput>> inputs;
  for (int tick = from; tick < from + count; ++tick) {
    auto& seats = inputs.emplace_back(scene.seats.size());
    for (std::size_t seat = 0; seat < seats.size(); ++seat)
      seats[seat] = scenes::scripted_input(scene, static_cast<int>(seat),
                                           static_cast<std::uint64_t>(tick) + 1);
  }
  return inputs;
}

/// One engine with its worlds of one run, and what all runs have measured.
template <int D>
struct Contender {
  peers::EngineKind<D> kind;
  peers::EngineSettings settings;
  EngineResult result;
  std::vector<std::unique_ptr<peers::Engine<D>>> worlds;
  std::vector<std::vector<double>> chunk_s;  ///< By chunk, of each run.
};

template <int D>
class Measurement {
 public:
  Measurement(const worlds::BenchWorld& world, const MeasureOptions& options);
  SceneResult run();

 private:
  void build(Contender<D>& contender);
  void warm_up(Contender<D>& contender);
  void run_once();
  int begin_of(std::size_t world) const;
  double step(Contender<D>& contender, int from, int count);
  void look(Contender<D>& contender);
  void summarise(Contender<D>& contender);

  MeasureOptions options_;
  SceneResult result_;
  scenes::Scene scene_;
  std::unique_ptr<scenes::Built<D>> built_;
  std::vector<Contender<D>> contenders_;
};

template <int D>
Measurement<D>::Measurement(const worlds::BenchWorld& world, const MeasureOptions& options)
    : options_(options), scene_(worlds::make_scene(world)) {
  result_.world = world;
  if (options.worlds > 0) result_.world.worlds = options.worlds;
  result_.runs = std::min(options.runs, world.runs_max);
  if (options.sleep && scene_.tuning.sleep_s == 0.0f)
    scene_.tuning.sleep_s = solver::Tuning{}.sleep_s;
  if (options.substeps > 0) scene_.tuning.substeps = options.substeps;
  std::vector<scenes::Mistake> mistakes;
  built_ = scenes::build<D>(scene_, mistakes);
  if (built_ == nullptr) {
    std::fprintf(stderr, "%s: %s: %s\n", world.name.c_str(), mistakes[0].path.c_str(),
                 mistakes[0].reason.c_str());
    std::exit(1);
  }
  result_.bodies = built_->world.body_count();
  result_.joints = static_cast<std::uint32_t>(built_->world.state().joints.size());
  peers::EngineSettings settings;
  settings.sleep = scene_.tuning.sleep_s > 0.0f;
  settings.lanes = options.lanes;
  for (const peers::EngineKind<D>& kind : peers::engines<D>()) {
    const bool ours = contenders_.empty();
    if (!ours && !options.peers) break;
    contenders_.push_back({kind, settings, {}, {}, {}});
    contenders_.back().result.engine = kind.name;
    if (!ours || options.workers < 2) continue;
    settings.workers = options.workers;
    contenders_.push_back({kind, settings, {}, {}, {}});
    contenders_.back().result.engine = "ours, " + std::to_string(options.workers) + " workers";
    settings.workers = 1;
  }
  for (Contender<D>& contender : contenders_)
    contender.chunk_s.resize(static_cast<std::size_t>(kChunks));
}

template <int D>
void Measurement<D>::build(Contender<D>& contender) {
  const double before = heap_bytes();
  for (int i = 0; i < result_.world.worlds; ++i) {
    auto made =
        contender.kind.make({scene_, *built_, contender.settings}, contender.result.why_not);
    if (made == nullptr) return contender.worlds.clear();
    contender.worlds.push_back(std::move(made));
  }
  contender.result.bytes = heap_bytes() - before;
}

/// The tick in which a world begins. Rooms of a server are not of one age: so what the memory of
/// their steps holds of one is not what the next one needs.
template <int D>
int Measurement<D>::begin_of(std::size_t world) const {
  const std::size_t ages = static_cast<std::size_t>(std::max(1, result_.world.warm_ticks / 3));
  return static_cast<int>(37 * world % ages);
}

/// @returns seconds, of ticks [from, from + count) of every world of the engine, in rotation.
template <int D>
double Measurement<D>::step(Contender<D>& contender, int from, int count) {
  const auto inputs = inputs_of(scene_, from, count);
  const double before = heap_bytes();
  const clockid_t clock = options_.workers > 1 ? CLOCK_MONOTONIC : CLOCK_PROCESS_CPUTIME_ID;
  const double start_s = seconds_now(clock);
  for (const auto& tick : inputs)
    for (std::size_t i = 0; i < contender.worlds.size(); ++i)
      if (from >= begin_of(i)) contender.worlds[i]->step(tick);
  const double taken_s = seconds_now(clock) - start_s;
  contender.result.bytes += heap_bytes() - before;
  return taken_s;
}

template <int D>
void Measurement<D>::warm_up(Contender<D>& contender) {
  double taken_s = 0.0;
  for (int tick = 0; tick < result_.world.warm_ticks && !contender.worlds.empty(); ++tick) {
    taken_s += step(contender, tick, 1);
    if (taken_s < kWarmUpMax_s || &contender == &contenders_.front()) continue;
    contender.result.why_not = "more than " + std::to_string(static_cast<int>(kWarmUpMax_s)) +
                               " s for the first " + std::to_string(tick + 1) + " ticks";
    contender.worlds.clear();
  }
}

template <int D>
void Measurement<D>::look(Contender<D>& contender) {
  const peers::Engine<D>& world = *contender.worlds.front();
  const peers::Poses<D> poses = [&](std::uint32_t body) { return world.pose(body); };
  const peers::Accuracy now = peers::measure_accuracy(built_->world.state(), poses);
  peers::Accuracy& worst = contender.result.accuracy;
  worst.overlap_m = std::max(worst.overlap_m, now.overlap_m);
  worst.gap_m = std::max(worst.gap_m, now.gap_m);
  worst.finite = worst.finite && now.finite;
  contender.result.contacts = world.contacts();
  contender.result.digest = world.digest();
}

template <int D>
void Measurement<D>::run_once() {
  for (Contender<D>& contender : contenders_) {
    contender.worlds.clear();
    if (contender.result.why_not.empty()) build(contender);
    warm_up(contender);
    contender.result.accuracy = {};
  }
  const int ticks = std::max(1, result_.world.ticks / kChunks);
  for (int chunk = 0; chunk < kChunks; ++chunk) {
    const int from = result_.world.warm_ticks + chunk * ticks;
    for (Contender<D>& contender : contenders_) {
      if (contender.worlds.empty()) continue;
      contender.chunk_s[static_cast<std::size_t>(chunk)].push_back(step(contender, from, ticks));
    }
    for (Contender<D>& contender : contenders_)
      if (!contender.worlds.empty()) look(contender);
  }
}

template <int D>
void Measurement<D>::summarise(Contender<D>& contender) {
  EngineResult& result = contender.result;
  result.bytes /= result_.world.worlds;
  if (!result.why_not.empty()) {
    result.digest = 0;
    return;
  }
  const int ticks = kChunks * std::max(1, result_.world.ticks / kChunks);
  const double steps = static_cast<double>(ticks) * result_.world.worlds;
  std::vector<double> ratios;
  for (std::size_t chunk = 0; chunk < contender.chunk_s.size(); ++chunk) {
    const std::vector<double>& taken = contender.chunk_s[chunk];
    result.step_us += 1e6 * median(taken) / steps;
    result.least_us += 1e6 * *std::min_element(taken.begin(), taken.end()) / steps;
    for (std::size_t run = 0; run < taken.size(); ++run)
      ratios.push_back(contenders_[0].chunk_s[chunk][run] / taken[run]);
  }
  result.ratio = median(ratios);
}

template <int D>
SceneResult Measurement<D>::run() {
  for (int run = 0; run < result_.runs; ++run) run_once();
  for (Contender<D>& contender : contenders_) summarise(contender);
  if (!contenders_[0].result.why_not.empty()) {
    std::fprintf(stderr, "%s: %s\n", result_.world.name.c_str(),
                 contenders_[0].result.why_not.c_str());
    std::exit(1);
  }
  for (Contender<D>& contender : contenders_) result_.engines.push_back(contender.result);
  return result_;
}

}  // namespace

SceneResult measure_scene(const worlds::BenchWorld& world, const MeasureOptions& options) {
  if (worlds::make_scene(world).dimension == 3) return Measurement<3>(world, options).run();
  return Measurement<2>(world, options).run();
}

}  // namespace cycloid::bench
