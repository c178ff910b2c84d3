#include "solver/collision/rod.hpp"

namespace cycloid::solver {

/// Midway between the surfaces of two rods at a pair of points on their axes.
static Vec<3> midway(const Rod& a, const Rod& b, const Vec<3>& on_a, const Vec<3>& on_b,
                     const Vec<3>& normal) {
  return 0.5f * (on_a + on_b) + (0.5f * (a.radius - b.radius)) * normal;
}

Manifold<3> rod_against_rod(const Rod& a, const Rod& b, float margin) {
  const float reach = a.radius + b.radius;
  const SegmentPair pair = nearest_points(a.from, a.to, b.from, b.to);
  if (pair.distance - reach > margin) return {};
  Manifold<3> manifold;
  manifold.normal = normal_between(a, b, pair);
  AxisPoints ends[2];
  if (parallel_points(a, b, manifold.normal, ends)) {
    for (std::uint32_t k = 0; k < 2; ++k) {
      const float separation = ends[k].height - reach;
      if (separation > margin) continue;
      add_point(midway(a, b, ends[k].on_a, ends[k].on_b, manifold.normal), separation, 1 + k,
                manifold);
    }
    if (manifold.point_count > 0) return manifold;
  }
  add_point(midway(a, b, pair.on_a, pair.on_b, manifold.normal), pair.distance - reach, 0,
            manifold);
  return manifold;
}

}  // namespace cycloid::solver
