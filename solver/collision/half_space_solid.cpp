#include "solver/collision/rod.hpp"

namespace cycloid::solver {

Manifold<3> half_space_against_solid(const Vec<3>& normal, float offset, const Solid& solid,
                                     float margin) {
  std::array<Candidate, kHullVerticesMax> found;
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < solid.vertex_count; ++i) {
    const float separation = dot(normal, solid.vertices[i]) - offset;
    if (separation > margin) continue;
    found[count++] = {solid.vertices[i] - (0.5f * separation) * normal, separation, i};
  }
  Manifold<3> manifold;
  manifold.normal = normal;
  reduce(std::span(found).first(count), manifold);
  return manifold;
}

Manifold<3> half_space_against_rod(const Vec<3>& normal, float offset, const Rod& rod,
                                   float margin) {
  Manifold<3> manifold;
  manifold.normal = normal;
  const Vec<3> ends[2] = {rod.from, rod.to};
  for (std::uint32_t i = 0; i < (is_ball(rod) ? 1u : 2u); ++i) {
    const float separation = dot(normal, ends[i]) - offset - rod.radius;
    if (separation > margin) continue;
    add_point(ends[i] - (rod.radius + 0.5f * separation) * normal, separation, i, manifold);
  }
  return manifold;
}

}  // namespace cycloid::solver
