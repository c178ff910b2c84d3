#include "bench/runner/heaps.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <numeric>

#include "bench/peers/accuracy.hpp"
#include "bench/peers/engine.hpp"
#include "bench/trials/perturb.hpp"
#include "bench/worlds/bench_worlds.hpp"

namespace cycloid::bench {
namespace {

constexpr int kBodiesMin = 40;
constexpr int kBodiesMax = 400;
constexpr int kSizes = 181;

constexpr int kLandingFrom_ticks = 30;
constexpr int kRestFrom_ticks = 180;
constexpr int kEnd_ticks = 300;
constexpr int kEvery_ticks = 3;

/// An engine, and whether it is ours by Soft Step.
struct Contestant {
  peers::EngineKind<2> kind;
  bool soft_step = false;
};

std::vector<Contestant> contestants() {
  std::vector<Contestant> all;
  for (const peers::EngineKind<2>& kind : peers::engines<2>()) {
    all.push_back({kind});
    if (all.size() == 1) all.push_back({kind, true});
  }
  return all;
}

scenes::Scene scene_of_start(int start, int starts) {
  const int sizes = std::min(starts, kSizes);
  const int size =
      kBodiesMin + (kBodiesMax - kBodiesMin) * (start % sizes) / std::max(1, sizes - 1);
  scenes::Scene scene = worlds::heap(size);
  scene.tuning.sleep_s = 0.0f;
  trials::perturb(scene, {1, static_cast<std::uint32_t>(start / sizes)});
  return scene;
}

/// Root of the mean square of what is added; 0 of nothing.
class RootMeanSquare {
 public:
  void add(double value) {
    sum_ += value * value;
    ++count_;
  }
  double value() const { return count_ == 0 ? 0.0 : std::sqrt(sum_ / static_cast<double>(count_)); }

 private:
  double sum_ = 0.0;
  std::uint64_t count_ = 0;
};

bool is_finite(const solver::Pose<2>& pose) {
  return std::isfinite(pose.position[0]) && std::isfinite(pose.position[1]) &&
         std::isfinite(pose.rotation[0]) && std::isfinite(pose.rotation[1]);
}

void expect_finite(const peers::Engine<2>& engine, std::size_t bodies, const char* name) {
  for (std::uint32_t body = 0; body < bodies; ++body) {
    if (is_finite(engine.pose(body))) continue;
    std::fprintf(stderr, "cycloid_bench: --heaps: %s has lost body %u\n", name, body);
    std::exit(1);
  }
}

std::unique_ptr<scenes::Built<2>> built_or_exit(const scenes::Scene& scene) {
  std::vector<scenes::Mistake> mistakes;
  auto built = scenes::build<2>(scene, mistakes);
  if (built != nullptr) return built;
  std::fprintf(stderr, "cycloid_bench: --heaps: %s: %s\n", mistakes[0].path.c_str(),
               mistakes[0].reason.c_str());
  std::exit(1);
}

void drop(scenes::Scene scene, const Contestant& contestant, HeapOverlaps& overlaps) {
  if (contestant.soft_step) scene.tuning.contact_block = solver::ContactBlockRows::kNone;
  const auto built = built_or_exit(scene);
  std::string why;
  const auto engine = contestant.kind.make({scene, *built, {}}, why);
  if (engine == nullptr) {
    std::fprintf(stderr, "cycloid_bench: --heaps: %s\n", why.c_str());
    std::exit(1);
  }
  const solver::WorldState<2>& state = built->world.state();
  RootMeanSquare landing;
  RootMeanSquare resting;
  for (int tick = 1; tick <= kEnd_ticks; ++tick) {
    engine->step({});
    if (tick < kLandingFrom_ticks || tick % kEvery_ticks != 0) continue;
    expect_finite(*engine, state.bodies.size(), contestant.kind.name);
    const auto pose_of = [&](std::uint32_t body) { return engine->pose(body); };
    for (const float depth_m : peers::overlaps_of<2>(state, pose_of))
      (tick < kRestFrom_ticks ? landing : resting).add(1.0e3 * double{depth_m});
  }
  overlaps.landing_mm.push_back(landing.value());
  overlaps.resting_mm.push_back(resting.value());
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::string cell(const std::vector<double>& values) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f", mean_of(values));
  return text;
}

/// "+0.10 +- 0.03": of the differences from what the first engine has at the same start.
std::string difference(const std::vector<double>& values, const std::vector<double>& first) {
  std::vector<double> apart;
  for (std::size_t i = 0; i < values.size(); ++i) apart.push_back(values[i] - first[i]);
  const double mean = mean_of(apart);
  double square = 0.0;
  for (const double value : apart) square += (value - mean) * (value - mean);
  const auto count = static_cast<double>(apart.size());
  char text[64];
  std::snprintf(text, sizeof text, "%+.2f +- %.2f", mean,
                std::sqrt(square / (count - 1.0) / count));
  return text;
}

}  // namespace

std::vector<HeapOverlaps> measure_heaps(int starts) {
  const std::vector<Contestant> all = contestants();
  std::vector<HeapOverlaps> engines;
  for (const Contestant& contestant : all) {
    const std::string name = contestant.kind.name;
    engines.push_back({contestant.soft_step ? name + ", Soft Step" : name, {}, {}});
  }
  for (int start = 0; start < starts; ++start) {
    const scenes::Scene scene = scene_of_start(start, starts);
    for (std::size_t i = 0; i < all.size(); ++i) drop(scene, all[i], engines[i]);
    if ((start + 1) % 10 == 0 || start + 1 == starts)
      std::fprintf(stderr, "%d of %d heaps\n", start + 1, starts);
  }
  return engines;
}

std::string heaps_markdown(const std::vector<HeapOverlaps>& engines) {
  std::string table =
      std::to_string(engines[0].landing_mm.size()) +
      " heaps of 40 to 400 bodies; root of the mean square of all overlaps, mm.\n\n"
      "| engine | landing | beside ours | at rest | beside ours |\n|---|---|---|---|---|\n";
  for (const HeapOverlaps& engine : engines) {
    const bool is_ours = &engine == &engines[0];
    const auto apart = [&](const std::vector<double>& values, const std::vector<double>& first) {
      return is_ours ? std::string() : difference(values, first);
    };
    table += "| " + engine.engine + " | " + cell(engine.landing_mm) + " | " +
             apart(engine.landing_mm, engines[0].landing_mm) + " | " + cell(engine.resting_mm) +
             " | " + apart(engine.resting_mm, engines[0].resting_mm) + " |\n";
  }
  return table;
}

}  // namespace cycloid::bench
