#include "bench/accuracy/errors.hpp"

#include <algorithm>
#include <array>

namespace cycloid::accuracy {

static std::optional<double> worst_error(const Measured& measured) {
  const Metrics& metrics = measured.metrics;
  std::optional<double> worst;
  for (const std::optional<Spread>& spread :
       {metrics.penetration_transient_m, metrics.penetration_steady_m, metrics.gap_transient_m,
        metrics.gap_steady_m})
    if (spread) worst = std::max(spread->max, worst.value_or(0.0));
  return worst;
}

std::span<const ErrorKind> error_kinds() {
  using M = const Measured&;
  static const std::array<ErrorKind, 9> kKinds = {{
      {"position", "overlap and gap at the end (95th percentile), m",
       [](M measured) { return std::optional(position_error_m(measured)); }},
      {"worst", "largest overlap or gap of the run, m", worst_error},
      {"residual", "natural map over impulses",
       [](M measured) { return measured.metrics.natural_map; }},
      {"velocity", "error of velocities against the direct solution",
       [](M measured) { return measured.metrics.velocity_error; }},
      {"wrench", "error of wrenches against the direct solution",
       [](M measured) { return measured.metrics.wrench_error; }},
      {"consistency", "distance from steps 16 times smaller, m",
       [](M measured) { return measured.metrics.consistency_m; }},
      {"energy", "energy gained, J", [](M measured) { return measured.metrics.energy_gained_j; }},
      {"jitter", "speed at the end (root mean square), m/s",
       [](M measured) { return measured.metrics.jitter_m_s; }},
      {"moved", "farthest way of a body, m", [](M measured) { return measured.metrics.moved_m; }},
  }};
  return kKinds;
}

const ErrorKind* find_error_kind(std::string_view name) {
  for (const ErrorKind& kind : error_kinds())
    if (name == kind.name) return &kind;
  return nullptr;
}

}  // namespace cycloid::accuracy
