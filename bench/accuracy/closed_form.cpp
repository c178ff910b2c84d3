#include <cmath>

#include "bench/accuracy/chart.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::accuracy {

/// Centres may lie so far beside each other, m: they come with rounding.
static constexpr float kAside_m = 1e-3f;

/// The lower and the upper of exactly two bodies that fall onto something fixed; else nothing.
static std::optional<std::pair<solver::Body<2>, solver::Body<2>>> two_bodies(
    const solver::WorldState<2>& state) {
  std::vector<solver::Body<2>> found;
  for (const solver::Body<2>& body : state.bodies) {
    if (body.kind == solver::BodyKind::kKinematic) return {};
    if (body.kind == solver::BodyKind::kDynamic) found.push_back(body);
  }
  if (found.size() != 2) return {};
  const float aside = found[0].position[0] - found[1].position[0];
  if (aside * aside > kAside_m * kAside_m) return {};
  if (found[0].position[1] > found[1].position[1]) std::swap(found[0], found[1]);
  return std::pair(found[0], found[1]);
}

std::optional<ClosedForm> closed_form(const Subject& subject) {
  const scenes::Scene& scene = subject.scene;
  if (scene.dimension != 2 || !scene.joints.empty() || !scene.seats.empty() ||
      subject.act != nullptr || scene.gravity[0] != 0.0f || !(scene.gravity[1] < 0.0f))
    return {};
  auto made = scenes::Simulation::create(with_setting(scene, Setting{}));
  if (!made.ok()) return {};
  scenes::Simulation& run = made.value();
  const auto bodies = two_bodies(run.planar()->state());
  if (!bodies || !run.step({}).ok()) return {};
  const double rows = run.statistics().rows_per_sweep;
  const double r =
      static_cast<double>(bodies->second.mass) / static_cast<double>(bodies->first.mass);
  if (!(r > 1.0) || rows == 0.0) return {};
  const double h = 1.0 / static_cast<double>(scene.tick_hz);
  const double fallen = -static_cast<double>(scene.gravity[1]) * h * h;
  const double rho = r / (1.0 + r);
  ClosedForm form;
  for (int sweeps = 1; sweeps <= 128; sweeps *= 2) {
    const double left = std::pow(rho, sweeps);
    form.by_sweeps.emplace_back(rows * sweeps, fallen * left / (1.0 - left));
    form.by_substeps.emplace_back(rows * sweeps,
                                  fallen * r / (static_cast<double>(sweeps) * sweeps));
  }
  return form;
}

}  // namespace cycloid::accuracy
