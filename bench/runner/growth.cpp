#include "bench/runner/growth.hpp"

#include <map>

#include "bench/figures/gnuplot.hpp"

namespace cycloid::bench {

std::string draw_growth(const std::vector<SceneResult>& results, const std::string& folder) {
  experiments::Figure figure;
  figure.name = "growth";
  figure.title = "Time per step and body, one thread";
  figure.x_label = "bodies";
  figure.y_label = "ns per body";
  figure.log_x = true;
  figure.log_y = true;
  std::map<std::string, std::vector<std::pair<double, double>>> curves;
  for (const SceneResult& result : results) {
    // "grow-pyramids-500" is of kind "pyramids".
    const std::string kind = result.world.name.substr(5, result.world.name.rfind('-') - 5);
    for (const EngineResult& engine : result.engines)
      if (engine.why_not.empty())
        curves[kind + ", " + engine.engine].emplace_back(
            result.bodies, 1e3 * engine.step_us / static_cast<double>(result.bodies));
  }
  for (const auto& [name, points] : curves) figure.curves.push_back({name, points});
  return figures::draw(figure, folder);
}

}  // namespace cycloid::bench
