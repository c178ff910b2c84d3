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
#include "scenes/generators/generators.hpp"

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
template <int D>
struct Contestant {
  peers::EngineKind<D> kind;
  bool soft_step = false;
};

template <int D>
std::vector<Contestant<D>> contestants() {
  std::vector<Contestant<D>> all;
  for (const peers::EngineKind<D>& kind : peers::engines<D>()) {
    all.push_back({kind});
    if (all.size() == 1) all.push_back({kind, true});
  }
  return all;
}

scenes::Scene heap_of_start(int start, int starts) {
  const int sizes = std::min(starts, kSizes);
  const int size =
      kBodiesMin + (kBodiesMax - kBodiesMin) * (start % sizes) / std::max(1, sizes - 1);
  scenes::Scene scene = worlds::heap(size);
  trials::perturb(scene, {1, static_cast<std::uint32_t>(start / sizes)});
  return scene;
}

scenes::Scene pit_of_start(int start) {
  scenes::Scene scene = worlds::make_scene(*worlds::find_bench_world("ball-pit-3d"));
  trials::perturb(scene, {1, static_cast<std::uint32_t>(start)});
  return scene;
}

/// Makes bodies heavier, each as likely as not, by the same choice in each start of a scene.
void make_unequal(float mass_ratio, scenes::Scene& scene) {
  scenes::Random random{17};
  for (scenes::SceneBody& body : scene.bodies) {
    const bool is_heavy = random.between(0.0f, 1.0f) < 0.5f;
    if (!is_heavy || body.kind != solver::BodyKind::kDynamic) continue;
    for (scenes::SceneShape& shape : body.shapes) shape.density *= mass_ratio;
  }
}

template <int D>
scenes::Scene scene_of_start(int start, int starts, float mass_ratio) {
  scenes::Scene scene = D == 2 ? heap_of_start(start, starts) : pit_of_start(start);
  make_unequal(mass_ratio, scene);
  scene.tuning.sleep_s = 0.0f;
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

[[noreturn]] void give_up(const std::string& why) {
  std::fprintf(stderr, "cycloid_bench: --heaps: %s\n", why.c_str());
  std::exit(1);
}

template <int D>
std::unique_ptr<scenes::Built<D>> built_or_exit(const scenes::Scene& scene) {
  std::vector<scenes::Mistake> mistakes;
  auto built = scenes::build<D>(scene, mistakes);
  if (built != nullptr) return built;
  give_up(mistakes[0].path + ": " + mistakes[0].reason);
}

/// The greatest speed of any body, m/s.
template <int D>
double fastest_of(const solver::WorldState<D>& state, const peers::Engine<D>& engine) {
  double fastest = 0.0;
  for (std::uint32_t body = 0; body < state.bodies.size(); ++body)
    if (state.bodies[body].inverse_mass > 0.0f)
      fastest = std::max(fastest, double{solver::length(engine.twist(body).velocity)});
  return fastest;
}

template <int D>
void drop(scenes::Scene scene, const Contestant<D>& contestant, HeapOverlaps& overlaps) {
  if (contestant.soft_step) scene.tuning.contact_block = solver::ContactBlockRows::kNone;
  const auto built = built_or_exit<D>(scene);
  std::string why;
  const auto engine = contestant.kind.make({scene, *built, {}}, why);
  if (engine == nullptr) give_up(why);
  const solver::WorldState<D>& state = built->world.state();
  RootMeanSquare landing;
  RootMeanSquare resting;
  double fastest_m_s = 0.0;
  for (int tick = 1; tick <= kEnd_ticks; ++tick) {
    engine->step({});
    fastest_m_s = std::max(fastest_m_s, fastest_of(state, *engine));
    if (tick < kLandingFrom_ticks || tick % kEvery_ticks != 0) continue;
    const peers::Poses<D> pose_of = [&](std::uint32_t body) { return engine->pose(body); };
    if (!peers::are_finite<D>(state, pose_of))
      give_up(contestant.kind.name + std::string(" has lost a body"));
    for (const float depth_m : peers::overlaps_of<D>(state, pose_of))
      (tick < kRestFrom_ticks ? landing : resting).add(1.0e3 * double{depth_m});
  }
  overlaps.landing_mm.push_back(landing.value());
  overlaps.resting_mm.push_back(resting.value());
  overlaps.fastest_m_s.push_back(fastest_m_s);
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

std::string cell(const char* format, double value) {
  char text[32];
  std::snprintf(text, sizeof text, format, value);
  return text;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// "+0.100 +- 0.030": of the differences from what the first engine has at the same start.
std::string difference(const std::vector<double>& values, const std::vector<double>& first) {
  std::vector<double> apart;
  for (std::size_t i = 0; i < values.size(); ++i) apart.push_back(values[i] - first[i]);
  const double mean = mean_of(apart);
  double square = 0.0;
  for (const double value : apart) square += (value - mean) * (value - mean);
  const auto count = static_cast<double>(apart.size());
  char text[64];
  std::snprintf(text, sizeof text, "%+.3f +- %.3f", mean,
                std::sqrt(square / (count - 1.0) / count));
  return text;
}

}  // namespace

template <int D>
std::vector<HeapOverlaps> measure_heaps(int starts, float mass_ratio) {
  const std::vector<Contestant<D>> all = contestants<D>();
  std::vector<HeapOverlaps> engines;
  for (const Contestant<D>& contestant : all) {
    const std::string name = contestant.kind.name;
    engines.push_back({contestant.soft_step ? name + ", Soft Step" : name, {}, {}, {}});
  }
  for (int start = 0; start < starts; ++start) {
    const scenes::Scene scene = scene_of_start<D>(start, starts, mass_ratio);
    for (std::size_t i = 0; i < all.size(); ++i) drop<D>(scene, all[i], engines[i]);
    if ((start + 1) % 10 == 0 || start + 1 == starts)
      std::fprintf(stderr, "%d of %d starts in %s\n", start + 1, starts,
                   D == 2 ? "the plane" : "space");
  }
  return engines;
}

template std::vector<HeapOverlaps> measure_heaps<2>(int starts, float mass_ratio);
template std::vector<HeapOverlaps> measure_heaps<3>(int starts, float mass_ratio);

std::string heaps_markdown(const std::vector<HeapOverlaps>& engines, const std::string& what) {
  std::string table =
      std::to_string(engines[0].landing_mm.size()) + " " + what +
      "; root of the mean square of all overlaps, mm, and the speed of "
      "the fastest, m/s.\n\n"
      "| engine | landing | beside ours | at rest | beside ours | fastest, median | "
      "the greatest |\n"
      "|---|---|---|---|---|---|---|\n";
  for (const HeapOverlaps& engine : engines) {
    const bool is_ours = &engine == &engines[0];
    const auto apart = [&](const std::vector<double>& values, const std::vector<double>& first) {
      return is_ours ? std::string() : difference(values, first);
    };
    const double fastest = *std::max_element(engine.fastest_m_s.begin(), engine.fastest_m_s.end());
    table += "| " + engine.engine + " | " + cell("%.3f", mean_of(engine.landing_mm)) + " | " +
             apart(engine.landing_mm, engines[0].landing_mm) + " | " +
             cell("%.3f", mean_of(engine.resting_mm)) + " | " +
             apart(engine.resting_mm, engines[0].resting_mm) + " | " +
             cell("%.0f", median_of(engine.fastest_m_s)) + " | " + cell("%.0f", fastest) + " |\n";
  }
  return table;
}

}  // namespace cycloid::bench
