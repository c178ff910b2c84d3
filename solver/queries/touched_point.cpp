#include "solver/queries/casting.hpp"

namespace cycloid::solver {

template <int D>
static Core<D> without_rounding(const Core<D>& core) {
  Core<D> sharp = core;
  sharp.radius = 0.0f;
  return sharp;
}

template <int D>
Vec<D> touched_point(const Core<D>& a, const Core<D>& probe, const Vec<D>& normal, float depth) {
  constexpr int kTries = 16;
  const Core<D> sharp = without_rounding(a);
  Core<D> moved = without_rounding(probe);
  Separation<D> apart{};
  float beyond = kTouch;
  for (int i = 0; i < kTries; ++i) {
    for (std::uint32_t k = 0; k < probe.count; ++k)
      moved.vertices[k] = probe.vertices[k] + (depth + beyond) * normal;
    apart = separation_of(sharp, moved);
    if (!apart.by_axis) break;
    beyond *= 4.0f;  // Far from the origin rounding swallows more.
  }
  return apart.point_a;
}

/// Whether a point of a plane of the core is one of the core, but for rounding.
template <int D>
static bool lies_on(const Core<D>& core, const Vec<D>& point) {
  Core<D> ball{};
  ball.kind = ShapeKind::kBall;
  ball.count = 1;
  ball.vertices[0] = point;
  const float slack = kTouch + 2.0e-6f * length(point - core.vertices[0]);
  return separation_of(without_rounding(core), ball).distance <= slack;
}

template <int D>
Vec<D> surface_point(const Core<D>& a, const Core<D>& probe, const Separation<D>& between) {
  if (!between.by_axis) return between.point_a;
  const Vec<D> rounding = a.radius * between.normal;
  const bool is_on_a = lies_on(a, between.point_a - rounding);
  if (is_on_a && lies_on(probe, between.point_b + probe.radius * between.normal))
    return between.point_a;
  const float depth = -(between.distance + a.radius + probe.radius);
  return touched_point(a, probe, between.normal, depth) + rounding;
}

template Vec<2> touched_point(const Core<2>&, const Core<2>&, const Vec<2>&, float);
template Vec<3> touched_point(const Core<3>&, const Core<3>&, const Vec<3>&, float);
template Vec<2> surface_point(const Core<2>&, const Core<2>&, const Separation<2>&);
template Vec<3> surface_point(const Core<3>&, const Core<3>&, const Separation<3>&);

}  // namespace cycloid::solver
