#include "bench/accuracy/measure.hpp"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <limits>
#include <stdexcept>

#include "bench/accuracy/observer.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::accuracy {

/// How much smaller the steps of the run are with which a setting is compared.
static constexpr std::uint32_t kFiner = 16;

static const solver::World<2>* world_of(const scenes::Simulation& run,
                                        std::integral_constant<int, 2>) {
  return run.planar();
}
static const solver::World<3>* world_of(const scenes::Simulation& run,
                                        std::integral_constant<int, 3>) {
  return run.spatial();
}
template <int D>
static const solver::WorldState<D>& state_of(const scenes::Simulation& run) {
  return world_of(run, std::integral_constant<int, D>{})->state();
}

bool is_acted_on(const Subject& subject) {
  for (const scenes::Seat& seat : subject.scene.seats)
    if (!seat.script.empty()) return true;
  return !subject.scene.characters.empty() || subject.act != nullptr;
}

/// A scene under a setting, stepped by its script.
class Run {
 public:
  Run(const Subject& subject, const Setting& setting, bool sleep, std::uint32_t finer = 1)
      : subject_(subject), finer_(finer), scene_(with_setting(subject.scene, setting)) {
    if (!sleep) scene_.tuning.sleep_s = 0.0f;
    scene_.tick_hz *= static_cast<float>(finer);
    auto made = scenes::Simulation::create(scene_);
    if (!made.ok()) throw std::logic_error(scene_.name + ": " + made.error().field);
    simulation_.emplace(std::move(made.value()));
  }

  /// What the seats say in a tick of the scene. @param tick  from 1.
  std::vector<scenes::SeatInput> inputs_of(std::uint32_t tick) const {
    std::vector<scenes::SeatInput> inputs;
    for (int seat = 0; seat < simulation_->seats(); ++seat)
      inputs.push_back(scenes::scripted_input(scene_, seat, tick));
    return inputs;
  }
  /// Those of all ticks up to the last.
  std::vector<std::vector<scenes::SeatInput>> inputs(std::uint32_t last) const {
    std::vector<std::vector<scenes::SeatInput>> all;
    for (std::uint32_t tick = 1; tick <= last; ++tick) all.push_back(inputs_of(tick));
    return all;
  }
  /// A tick of the scene, as many smaller ones where the run is finer.
  bool step(std::uint32_t tick, const std::vector<scenes::SeatInput>& inputs) {
    if (subject_.act != nullptr && simulation_->planar() != nullptr)
      subject_.act(*simulation_->planar(), tick);
    for (std::uint32_t i = 0; i < finer_; ++i)
      if (!simulation_->step(inputs).ok()) return false;
    return true;
  }
  bool step(std::uint32_t tick) { return step(tick, inputs_of(tick)); }
  const scenes::Simulation& simulation() const { return *simulation_; }
  const scenes::Scene& scene() const { return scene_; }

 private:
  const Subject& subject_;
  std::uint32_t finer_;
  scenes::Scene scene_;
  std::optional<scenes::Simulation> simulation_;
};

double rows_of_tick(const solver::Statistics& statistics, const solver::Tuning& tuning) {
  const double direct =
      static_cast<double>(statistics.direct_rows) * static_cast<double>(sweeps_per_tick(tuning));
  return static_cast<double>(statistics.rows) + direct;
}

/// Squared distances between where the bodies of two runs are.
template <int D>
static void compare(const solver::WorldState<D>& a, const solver::WorldState<D>& b, double& squares,
                    std::uint64_t& count) {
  for (std::size_t i = 0; i < std::min(a.bodies.size(), b.bodies.size()); ++i) {
    if (!trials::responds(a.bodies[i]) || !trials::responds(b.bodies[i])) continue;
    for (int k = 0; k < D; ++k) {
      const double off = static_cast<double>(a.bodies[i].position[k]) -
                         static_cast<double>(b.bodies[i].position[k]);
      squares += off * off;
    }
    ++count;
  }
}

template <int D>
static std::optional<double> consistency_of(const Subject& subject, const Setting& setting,
                                            const MeasureOptions& options) {
  Run coarse(subject, setting, options.sleep);
  Run fine(subject, setting, options.sleep, kFiner);
  const auto second = static_cast<std::uint32_t>(std::lround(subject.scene.tick_hz));
  double squares = 0.0;
  std::uint64_t count = 0;
  for (std::uint32_t tick = 1; tick <= std::min(second, subject.ticks); ++tick) {
    if (!coarse.step(tick) || !fine.step(tick)) return {};
    compare(state_of<D>(coarse.simulation()), state_of<D>(fine.simulation()), squares, count);
  }
  if (count == 0) return {};
  return std::sqrt(squares / static_cast<double>(count));
}

template <int D>
static Measured measure_in(const Subject& subject, const Setting& setting,
                           const MeasureOptions& options) {
  Measured measured{setting, true, {}, {}, 0};
  Run run(subject, setting, options.sleep);
  Observer<D> observer(state_of<D>(run.simulation()), subject.ticks, is_acted_on(subject), options);
  double rows = 0.0;
  std::uint32_t ticks = 0;
  for (std::uint32_t tick = 1; tick <= subject.ticks && measured.ended; ++tick) {
    measured.ended = run.step(tick) && observer.look(state_of<D>(run.simulation()), tick);
    if (!measured.ended) break;
    rows += rows_of_tick(run.simulation().statistics(), run.scene().tuning);
    ++ticks;
  }
  measured.metrics = observer.finish(state_of<D>(run.simulation()));
  if (options.consistency)
    measured.metrics.consistency_m = consistency_of<D>(subject, setting, options);
  if (ticks > 0) measured.price.rows_per_tick = rows / ticks;
  measured.price.state_bytes = run.simulation().encoded_bytes();
  measured.digest = run.simulation().digest();
  return measured;
}

double position_error_m(const Measured& measured) {
  const Metrics& metrics = measured.metrics;
  if (!measured.ended || !metrics.penetration_steady_m)
    return std::numeric_limits<double>::infinity();
  const double overlap = metrics.penetration_steady_m->p95;
  return metrics.gap_steady_m ? std::max(overlap, metrics.gap_steady_m->p95) : overlap;
}

Measured measure(const Subject& subject, const Setting& setting, const MeasureOptions& options) {
  if (subject.scene.dimension == 3) return measure_in<3>(subject, setting, options);
  return measure_in<2>(subject, setting, options);
}

double time_ticks(const Subject& subject, const Setting& setting, const MeasureOptions& options) {
  Run run(subject, setting, options.sleep);
  const auto inputs = run.inputs(subject.ticks);
  std::uint32_t ticks = 0;
  const std::clock_t before = std::clock();
  for (bool steps = true; steps && ticks < subject.ticks; ++ticks)
    steps = run.step(ticks + 1, inputs[ticks]);
  const std::clock_t spent = std::clock() - before;
  return 1e9 * static_cast<double>(spent) / CLOCKS_PER_SEC / std::max(ticks, std::uint32_t{1});
}

}  // namespace cycloid::accuracy
