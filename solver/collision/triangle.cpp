#include "solver/collision/triangle.hpp"

namespace cycloid::solver {

static Vec<3> unit(const Vec<3>& vector, const Vec<3>& fallback) {
  const float size = length(vector);
  return size > 0.0f ? (1.0f / size) * vector : fallback;
}

Border border_of(const Solid& triangle, std::uint32_t edge) {
  const Vec<3> normal = triangle.normals[0];
  const Vec<3> origin = triangle.vertices[edge];
  const Vec<3> along = triangle.vertices[next_corner(edge)] - origin;
  Border border;
  border.outward = unit(cross(along, normal), normal);
  border.into = border.outward;
  border.shared = (triangle.ghosts >> edge & 1u) != 0;
  border.convex = false;
  if (!border.shared) return border;
  const Vec<3> direction = unit(along, border.outward);
  const Vec<3> far = triangle.ghost_points[edge] - origin;
  border.into = unit(far - dot(far, direction) * direction, border.outward);
  border.convex = dot(border.into, normal) < -kFlat;
  return border;
}

Leaning leaning_of(const Solid& triangle, std::uint32_t edges, const Vec<3>& normal) {
  Leaning leaning = Leaning::kAllowed;
  for (std::uint32_t i = 0; i < 3; ++i) {
    if ((edges & triangle.ghosts & (1u << i)) == 0) continue;
    const Border border = border_of(triangle, i);
    if (!border.convex && dot(normal, border.outward) > kFlat) return Leaning::kOwnOnly;
    if (border.convex && dot(normal, border.into) > kFlat) leaning = Leaning::kNeighbour;
  }
  return leaning;
}

}  // namespace cycloid::solver
