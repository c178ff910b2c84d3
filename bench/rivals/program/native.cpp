#include "bench/rivals/program/native.hpp"

#include <ctime>

#include "bench/peers/engine.hpp"

namespace cycloid::rivals {
namespace {

using accuracy::ChartPoint;
using accuracy::Contender;
using accuracy::MeasureOptions;
using accuracy::SceneChart;
using accuracy::Setting;

template <int D>
class NativeRun final : public RivalRun<D> {
 public:
  NativeRun(const solver::WorldState<D>& start, std::unique_ptr<peers::Engine<D>> engine)
      : state_(without_contacts(start)), engine_(std::move(engine)) {}

  bool step(std::uint32_t) override {
    engine_->step({});
    for (std::uint32_t i = 0; i < state_.bodies.size(); ++i) {
      if (state_.bodies[i].kind == solver::BodyKind::kFree) continue;
      solver::BodyMotion<D>& body = state_.bodies.moved(i);
      const solver::Pose<D> pose = engine_->pose(i);
      const peers::Twist<D> twist = engine_->twist(i);
      body.position = pose.position;
      body.rotation = pose.rotation;
      body.velocity = twist.velocity;
      body.spin = twist.spin;
    }
    return true;
  }
  const solver::WorldState<D>& state() const override { return state_; }

 private:
  solver::WorldState<D> state_;
  std::unique_ptr<peers::Engine<D>> engine_;
};

/// A scene as its engines take it.
template <int D>
struct Start {
  std::unique_ptr<scenes::Built<D>> built;
  std::unique_ptr<peers::Engine<D>> engine;  ///< Null where it cannot hold the scene.
};

template <int D>
Start<D> start_of(const SceneChart& chart, const peers::EngineKind<D>& kind,
                  const Setting& setting) {
  const scenes::Scene& scene = chart.subject.scene;
  if (scene.dimension != D || !scene.seats.empty() || chart.subject.act != nullptr) return {};
  std::vector<scenes::Mistake> mistakes;
  Start<D> start{scenes::build<D>(scene, mistakes), nullptr};
  if (start.built == nullptr) return start;
  peers::EngineSettings settings;
  settings.substeps = static_cast<int>(setting.substeps);
  settings.iterations = static_cast<int>(setting.sweeps);
  settings.exact_shapes = true;
  std::string why;
  start.engine = kind.make({scene, *start.built, settings}, why);
  return start;
}

template <int D>
std::optional<ChartPoint> measure_native(const SceneChart& chart, const peers::EngineKind<D>& kind,
                                         const Setting& setting, const MeasureOptions& options) {
  Start<D> start = start_of(chart, kind, setting);
  if (start.engine == nullptr) return {};
  NativeRun<D> run(start.built->world.state(), std::move(start.engine));
  return measure_rival(chart, run, setting, options);
}

template <int D>
double time_native(const SceneChart& chart, const peers::EngineKind<D>& kind,
                   const Setting& setting) {
  const Start<D> start = start_of(chart, kind, setting);
  const std::clock_t before = std::clock();
  for (std::uint32_t tick = 0; tick < chart.subject.ticks; ++tick) start.engine->step({});
  const std::clock_t spent = std::clock() - before;
  return 1e9 * static_cast<double>(spent) / CLOCKS_PER_SEC / chart.subject.ticks;
}

template <int D>
void add_contenders(const std::vector<std::uint32_t>& substeps,
                    const std::vector<std::uint32_t>& iterations,
                    std::vector<Contender>& contenders) {
  for (const peers::EngineKind<D>& kind : peers::engines<D>().subspan(1))  // The first is ours.
    for (const std::uint32_t s : substeps)
      for (const std::uint32_t i : iterations) {
        const std::uint32_t sweeps = i > 0 ? i : static_cast<std::uint32_t>(kind.iterations);
        const Setting setting{kind.name, s, sweeps, 0};
        contenders.push_back({setting,
                              [=](const SceneChart& chart, const MeasureOptions& options) {
                                return measure_native<D>(chart, kind, setting, options);
                              },
                              [=](const SceneChart& chart, std::uint32_t) {
                                return time_native<D>(chart, kind, setting);
                              }});
      }
}

}  // namespace

std::vector<Contender> native_contenders(const std::vector<std::uint32_t>& substeps,
                                         const std::vector<std::uint32_t>& iterations) {
  std::vector<Contender> contenders;
  add_contenders<2>(substeps, iterations, contenders);
  add_contenders<3>(substeps, iterations, contenders);
  return contenders;
}

}  // namespace cycloid::rivals
