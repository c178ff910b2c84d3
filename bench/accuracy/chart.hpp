#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "bench/accuracy/errors.hpp"
#include "bench/trials/judges.hpp"

namespace cycloid::accuracy {

/// A setting of a scene on a chart.
struct ChartPoint {
  Measured measured;
  std::optional<trials::Outcome> outcome;  ///< Of the trial's judge, where the scene is a trial.
  bool failed = false;                     ///< `run_chart` says of which.
  std::vector<double> times;               ///< ns per tick of each round.
  int contender = -1;                      ///< Of ChartPlan::contenders; -1: ours.
};

/// A scene and every setting that it was solved with.
struct SceneChart {
  std::string name;
  Subject subject;
  std::optional<scenes::Trial> trial;
  /// A body that ends farther than this from where it began, m, has fallen; 0: it may.
  double moved_max_m = 0.0;
  std::vector<ChartPoint> points;
};

/// Another engine on the chart, with a setting of its own: `method` is its name.
struct Contender {
  Setting setting;
  /// As `measure`, from poses and velocities alone; nothing where the engine cannot hold the scene.
  std::function<std::optional<ChartPoint>(const SceneChart& chart, const MeasureOptions& options)>
      measure;
  /// As `time_ticks`, of one round, for a scene that `measure` took.
  std::function<double(const SceneChart& chart, std::uint32_t round)> time_ticks;
};

/// What to chart.
struct ChartPlan {
  std::vector<SceneChart> scenes;  ///< Without points.
  std::vector<Setting> settings;
  std::vector<Contender> contenders;
  MeasureOptions measure;
  std::uint32_t repeats = 3;  ///< Rounds of timing; 0: nothing is timed.
};

/// How far it has come. Shares are of rows to solve, which is what takes the time.
struct ChartProgress {
  double done = 0.0;  ///< 0 to 1
  std::string what;   ///< The scene and the setting that come next.
};

/// Measures every scene under every setting, then times them in rounds: one run of each setting of
/// each scene, then the next round, so that what slows the machine for a while slows all alike.
/// The time is the median of the rounds. Calls `tell` before each run. A setting has failed where
/// its run did not end, the trial's judge says so, a body has moved too far, or it gained energy:
/// a share of 0.05 more than the setting that gained least.
void run_chart(ChartPlan& plan, const std::function<void(const ChartProgress&)>& tell);

enum class CostAxis { kRows, kTime };

/// Rows or ns of a tick; 0 where nobody has counted them.
double cost_of(const ChartPoint& point, CostAxis axis);

/// Indices of the points that no other point beats in one and equals in the other, of cost and of
/// error, by rising cost; of equals the first. Without those that failed, have no such error or
/// no such cost.
std::vector<std::size_t> pareto_front(const SceneChart& chart, const ErrorKind& error,
                                      CostAxis axis);

/// What tables list the front of: rows, which repeat exactly; time where there are other engines,
/// whose rows nobody counts.
CostAxis table_axis(const SceneChart& chart);

/// Rows of a tick against the depth to which it lets a heavy body sink into a light one, m.
using Line = std::vector<std::pair<double, double>>;

/// For a scene of two bodies, the upper one r times as heavy as the lower one that lies on fixed
/// ground from the first tick, one straight above the other: by so much sequential impulses that
/// start from the last solution let it sink, g h^2 rho^K / (1 - rho^K) after K sweeps of one step,
/// rho = r / (1 + r); g (h / s)^2 r after one sweep in each of s substeps. Nothing for other
/// scenes. Derived from Gauss-Seidel's fixed point.
struct ClosedForm {
  Line by_sweeps;
  Line by_substeps;
};
std::optional<ClosedForm> closed_form(const Subject& subject);

}  // namespace cycloid::accuracy
