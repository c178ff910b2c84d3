#include "bench/rivals/rival_run.hpp"

#include "bench/accuracy/observer.hpp"

namespace cycloid::rivals {

template <int D>
accuracy::ChartPoint measure_rival(const accuracy::SceneChart& chart, RivalRun<D>& run,
                                   const accuracy::Setting& setting,
                                   accuracy::MeasureOptions options) {
  options.impulses = false;
  const std::uint32_t ticks = chart.subject.ticks;
  accuracy::Observer<D> observer(run.state(), ticks, accuracy::is_acted_on(chart.subject), options);
  trials::CourseWatch<D> watch(run.state(), ticks);
  accuracy::ChartPoint point;
  point.measured.setting = setting;
  bool& ended = point.measured.ended;
  for (std::uint32_t tick = 1; tick <= ticks && ended; ++tick)
    ended = run.step(tick) && observer.look(run.state(), tick) && watch.look(run.state(), tick);
  point.measured.metrics = observer.finish(run.state());
  if (!chart.trial) return point;
  const trials::Judge& judge = trials::judge_of(*chart.trial);
  if (judge.act == nullptr) point.outcome = trials::judged(judge, watch.finish(run.state(), ended));
  return point;
}

template <int D>
solver::WorldState<D> without_contacts(const solver::WorldState<D>& start) {
  solver::WorldState<D> state = start;
  state.contacts.clear();
  return state;
}

template accuracy::ChartPoint measure_rival(const accuracy::SceneChart&, RivalRun<2>&,
                                            const accuracy::Setting&, accuracy::MeasureOptions);
template accuracy::ChartPoint measure_rival(const accuracy::SceneChart&, RivalRun<3>&,
                                            const accuracy::Setting&, accuracy::MeasureOptions);
template solver::WorldState<2> without_contacts(const solver::WorldState<2>&);
template solver::WorldState<3> without_contacts(const solver::WorldState<3>&);

}  // namespace cycloid::rivals
