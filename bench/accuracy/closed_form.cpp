#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "bench/accuracy/chart.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::accuracy {

/// Centres may lie so far beside each other, m: they come with rounding.
static constexpr float kAside_m = 1e-3f;

/// Two bodies by their slots.
struct Pile {
  std::uint32_t lower = 0;
  std::uint32_t upper = 0;
};

/// Of exactly two bodies that move, one right above the other; else nothing.
static std::optional<Pile> two_bodies(const solver::WorldState<2>& state) {
  std::vector<std::uint32_t> found;
  for (std::uint32_t i = 0; i < state.bodies.size(); ++i) {
    if (state.bodies[i].kind == solver::BodyKind::kKinematic) return {};
    if (state.bodies[i].kind == solver::BodyKind::kDynamic) found.push_back(i);
  }
  if (found.size() != 2) return {};
  const solver::Vec<2> apart = state.bodies[found[1]].position - state.bodies[found[0]].position;
  if (apart[0] * apart[0] > kAside_m * kAside_m) return {};
  if (apart[1] < 0.0f) std::swap(found[0], found[1]);
  return Pile{found[0], found[1]};
}

/// Whether the lower one meets something fixed and the upper one the lower one alone, or they are
/// as near as contacts foresee.
static bool lies_on_ground(const solver::WorldState<2>& state, const Pile& pile) {
  bool on_ground = false;
  bool on_lower = false;
  for (const solver::Contact<2>& contact : state.contacts) {
    if (contact.point_count == 0) continue;
    const std::uint32_t a = state.shapes[contact.shape_a].body;
    const std::uint32_t b = state.shapes[contact.shape_b].body;
    const bool of_upper = a == pile.upper || b == pile.upper;
    const bool of_lower = a == pile.lower || b == pile.lower;
    if (of_upper && !of_lower) return false;
    on_lower = on_lower || (of_upper && of_lower);
    on_ground = on_ground || (of_lower && !of_upper);
  }
  return on_ground && on_lower;
}

std::optional<ClosedForm> closed_form(const Subject& subject) {
  const scenes::Scene& scene = subject.scene;
  if (scene.dimension != 2 || !scene.joints.empty() || !scene.seats.empty() ||
      subject.act != nullptr || scene.gravity[0] != 0.0f || !(scene.gravity[1] < 0.0f))
    return {};
  auto made = scenes::Simulation::create(with_setting(scene, Setting{}));
  if (!made.ok()) return {};
  scenes::Simulation& run = made.value();
  const solver::WorldState<2>& state = run.planar()->state();
  const auto pile = two_bodies(state);
  if (!pile || !run.step({}).ok() || !lies_on_ground(state, *pile)) return {};
  const double rows = run.statistics().rows_per_sweep;
  const double r = static_cast<double>(state.bodies[pile->upper].mass) /
                   static_cast<double>(state.bodies[pile->lower].mass);
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
