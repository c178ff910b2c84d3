#include "solver/solids/integer_hull.hpp"

#include <algorithm>

namespace cycloid::solver {

using GridStep = std::array<std::int64_t, 3>;

static GridStep difference(const GridPoint& to, const GridPoint& from) {
  return {std::int64_t{to.v[0]} - from.v[0], std::int64_t{to.v[1]} - from.v[1],
          std::int64_t{to.v[2]} - from.v[2]};
}

Vec<3> grid_difference(const GridPoint& to, const GridPoint& from) {
  const GridStep d = difference(to, from);
  return {{static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])}};
}

/// Components below 2^49: differences are below 2^24.
static GridArea area_of(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  const GridStep u = difference(b, a);
  const GridStep w = difference(c, a);
  return {{u[1] * w[2] - u[2] * w[1], u[2] * w[0] - u[0] * w[2], u[0] * w[1] - u[1] * w[0]}};
}

Vec<3> unit_normal(const GridArea& area) {
  const Vec<3> direction = {{static_cast<float>(area.v[0]), static_cast<float>(area.v[1]),
                             static_cast<float>(area.v[2])}};
  return normalized_or(direction, Vec<3>::zero());
}

/// Whether `point` lies strictly outside, exactly. The sum needs 75 bits, so the area is taken as
/// high * 2^28 + low with 0 <= low < 2^28.
static bool is_outside(const GridPoint& point, const GridPoint& corner, const GridArea& area) {
  const GridStep d = difference(point, corner);
  std::int64_t high = 0;
  std::int64_t low = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    high += d[i] * (area.v[i] >> 28);
    low += d[i] * (area.v[i] & 0xfffffff);
  }
  const std::int64_t carried = high + (low >> 28);
  return carried > 0 || (carried == 0 && (low & 0xfffffff) != 0);
}

static float height_over(const GridPoint& point, std::span<const GridPoint> points,
                         const GridTriangle& triangle) {
  return dot(triangle.normal, grid_difference(point, points[triangle.corners[0]]));
}

float height_above(const GridPoint& point, std::span<const GridPoint> points,
                   std::span<const GridTriangle> triangles) {
  float highest = height_over(point, points, triangles[0]);
  for (const GridTriangle& triangle : triangles)
    highest = max(highest, height_over(point, points, triangle));
  return highest;
}

/// A surface that grows point by point.
class Surface {
 public:
  Surface(std::span<const GridPoint> points, std::span<const std::uint32_t> chosen,
          std::vector<GridTriangle>& triangles)
      : points_(points),
        chosen_(chosen),
        triangles_(triangles),
        triangle_at_(points.size() * points.size()) {}

  /// Four points that span a volume; false where there are none.
  bool start(float tolerance) {
    std::array<std::uint32_t, 4> corners;
    corners[0] = chosen_[0];
    for (const std::uint32_t p : chosen_)
      if (points_[p].v < points_[corners[0]].v) corners[0] = p;
    const GridPoint& a = points_[corners[0]];
    corners[1] = farthest([&](const GridPoint& p) { return length(grid_difference(p, a)); });
    const Vec<3> along = grid_difference(points_[corners[1]], a);
    const float span = length(along);
    if (span <= tolerance) return false;
    corners[2] = farthest([&](const GridPoint& p) {
      return length(cross((1.0f / span) * along, grid_difference(p, a)));
    });
    const GridArea base = area_of(a, points_[corners[1]], points_[corners[2]]);
    const Vec<3> normal = unit_normal(base);
    const auto off_plane = [&](const GridPoint& p) {
      return abs(dot(normal, grid_difference(p, a)));
    };
    corners[3] = farthest(off_plane);
    if (!(off_plane(points_[corners[3]]) > tolerance)) return false;
    if (is_outside(points_[corners[3]], a, base)) std::swap(corners[1], corners[2]);
    add({corners[0], corners[1], corners[2]});
    add({corners[0], corners[3], corners[1]});
    add({corners[1], corners[3], corners[2]});
    add({corners[2], corners[3], corners[0]});
    return true;
  }

  /// Adds the farthest point outside of each triangle until none is left outside. Triangles are
  /// appended, so one pass over the growing list sees them all.
  void grow(float tolerance) {
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      while (alive_[t]) {
        const auto height = [&](const GridPoint& p) {
          return height_over(p, points_, triangles_[t]);
        };
        const std::uint32_t p = farthest(height);
        if (!(height(points_[p]) > tolerance) || !replace_visible(p)) break;
      }
    }
    std::size_t kept = 0;
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      if (alive_[t]) triangles_[kept++] = triangles_[t];
    triangles_.resize(kept);
  }

 private:
  template <class Measure>
  std::uint32_t farthest(Measure measure) const {
    std::uint32_t best = chosen_[0];
    float most = measure(points_[best]);
    for (const std::uint32_t p : chosen_) {
      const float value = measure(points_[p]);
      if (value > most) {
        most = value;
        best = p;
      }
    }
    return best;
  }

  std::uint32_t& triangle_at(std::uint32_t from, std::uint32_t to) {
    return triangle_at_[from * points_.size() + to];
  }

  void add(const std::array<std::uint32_t, 3>& corners) {
    const auto index = static_cast<std::uint32_t>(triangles_.size());
    for (std::size_t k = 0; k < 3; ++k) triangle_at(corners[k], corners[(k + 1) % 3]) = index;
    const GridArea area = area_of(points_[corners[0]], points_[corners[1]], points_[corners[2]]);
    triangles_.push_back({corners, area, unit_normal(area)});
    alive_.push_back(true);
  }

  /// Puts a cone over the edge of what `p` sees in its place; false where it sees nothing. A
  /// triangle in the plane of `p` is not seen, so no new one is without area.
  bool replace_visible(std::uint32_t p) {
    std::vector<bool> visible(triangles_.size(), false);
    bool any = false;
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      if (!alive_[t]) continue;
      const GridTriangle& triangle = triangles_[t];
      visible[t] = is_outside(points_[p], points_[triangle.corners[0]], triangle.area);
      any = any || visible[t];
    }
    const std::size_t before = visible.size();
    for (std::size_t t = 0; t < before; ++t) {
      if (!visible[t]) continue;
      alive_[t] = false;
      const std::array<std::uint32_t, 3> corners = triangles_[t].corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t from = corners[k];
        const std::uint32_t to = corners[(k + 1) % 3];
        // What was added in this loop lies beyond an edge that a visible triangle does not have.
        if (!visible[triangle_at(to, from)]) add({from, to, p});
      }
    }
    return any;
  }

  std::span<const GridPoint> points_;
  std::span<const std::uint32_t> chosen_;
  std::vector<GridTriangle>& triangles_;
  std::vector<bool> alive_;
  std::vector<std::uint32_t> triangle_at_;
};

bool triangulate_hull(std::span<const GridPoint> points, std::span<const std::uint32_t> chosen,
                      float tolerance, std::vector<GridTriangle>& triangles) {
  triangles.clear();
  if (chosen.size() < 4) return false;
  Surface surface(points, chosen, triangles);
  if (!surface.start(tolerance)) return false;
  surface.grow(tolerance);
  return true;
}

}  // namespace cycloid::solver
