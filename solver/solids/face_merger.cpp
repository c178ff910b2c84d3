#include "solver/solids/face_merger.hpp"

namespace cycloid::solver {

class FaceMerger {
 public:
  FaceMerger(std::span<const GridPoint> points, std::span<const GridTriangle> triangles)
      : points_(points),
        triangles_(triangles),
        triangle_at_(points.size() * points.size(), kAbsent) {
    for (std::uint32_t t = 0; t < triangles.size(); ++t) {
      face_of_.push_back(t);
      areas_.push_back(triangles[t].area);
      for (std::size_t k = 0; k < 3; ++k)
        triangle_at(triangles[t].corners[k], triangles[t].corners[(k + 1) % 3]) = t;
    }
  }

  void merge_all(float tolerance) {
    // A merge may make room for one that was refused before; each pass but the last makes one.
    for (bool changed = true; changed;) {
      changed = false;
      for (std::uint32_t a = 0; a < points_.size(); ++a)
        for (std::uint32_t b = a + 1; b < points_.size(); ++b)
          if (is_edge(a, b) && may_merge(a, b, tolerance)) {
            merge(a, b);
            changed = true;
          }
    }
  }

  void write(PolyhedronData& out) {
    std::vector<std::uint32_t> edge_at(points_.size() * points_.size());
    for (std::uint32_t a = 0; a < points_.size(); ++a)
      for (std::uint32_t b = a + 1; b < points_.size(); ++b)
        if (is_edge(a, b)) {
          const auto index = static_cast<std::uint32_t>(out.edges.size());
          edge_at[a * points_.size() + b] = index;
          edge_at[b * points_.size() + a] = index + 1;
          out.edges.push_back({a, index + 1, 0, face_at(a, b)});
          out.edges.push_back({b, index, 0, face_at(b, a)});
        }
    std::vector<std::uint32_t> number_of(triangles_.size(), kAbsent);
    for (std::uint32_t e = 0; e < out.edges.size(); ++e) {
      PolyhedronEdge& edge = out.edges[e];
      const std::uint32_t end = out.edges[edge.twin].origin;
      edge.next = edge_at[end * points_.size() + after(edge.face, end)];
      std::uint32_t& number = number_of[edge.face];
      if (number == kAbsent) {
        number = static_cast<std::uint32_t>(out.faces.size());
        out.faces.push_back({unit_normal(areas_[edge.face]), 0.0f, e});
      }
      edge.face = number;
    }
    for (std::size_t e = out.edges.size(); e-- > 0;)
      out.vertices[out.edges[e].origin].edge = static_cast<std::uint32_t>(e);
  }

 private:
  static constexpr std::uint32_t kAbsent = 0xffffffffu;

  std::uint32_t& triangle_at(std::uint32_t from, std::uint32_t to) {
    return triangle_at_[from * points_.size() + to];
  }
  std::uint32_t face_at(std::uint32_t from, std::uint32_t to) {
    const std::uint32_t triangle = triangle_at(from, to);
    return triangle == kAbsent ? kAbsent : face_of_[triangle];
  }
  bool is_edge(std::uint32_t a, std::uint32_t b) { return face_at(a, b) != face_at(b, a); }

  /// The corner that follows, or precedes, `corner` around a face.
  std::uint32_t after(std::uint32_t face, std::uint32_t corner) {
    std::uint32_t next = 0;
    while (face_at(corner, next) != face || !is_edge(corner, next)) ++next;
    return next;
  }
  std::uint32_t before(std::uint32_t face, std::uint32_t corner) {
    std::uint32_t previous = 0;
    while (face_at(previous, corner) != face || !is_edge(previous, corner)) ++previous;
    return previous;
  }

  std::uint32_t degree(std::uint32_t corner) {
    std::uint32_t count = 0;
    for (std::uint32_t other = 0; other < points_.size(); ++other)
      if (is_edge(corner, other)) ++count;
    return count;
  }

  std::uint32_t shared_edges(std::uint32_t face, std::uint32_t other) {
    std::uint32_t count = 0;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (face_of_[t] != face) continue;
      const std::array<std::uint32_t, 3>& corners = triangles_[t].corners;
      for (std::size_t k = 0; k < 3; ++k)
        if (face_at(corners[(k + 1) % 3], corners[k]) == other) ++count;
    }
    return count;
  }

  static GridArea sum(const GridArea& a, const GridArea& b) {
    return {{a.v[0] + b.v[0], a.v[1] + b.v[1], a.v[2] + b.v[2]}};
  }

  bool is_flat(std::uint32_t face, std::uint32_t other, std::uint32_t origin, const Vec<3>& normal,
               float tolerance) {
    float lowest = 0.0f;
    float highest = 0.0f;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      if (face_of_[t] != face && face_of_[t] != other) continue;
      for (const std::uint32_t corner : triangles_[t].corners) {
        const float height = dot(normal, grid_difference(points_[corner], points_[origin]));
        lowest = min(lowest, height);
        highest = max(highest, height);
      }
    }
    return highest - lowest <= 2.0f * tolerance;
  }

  /// Whether the way p, q, r turns to the left by so much that q is clear of the line p r.
  bool is_corner(std::uint32_t p, std::uint32_t q, std::uint32_t r, const Vec<3>& normal,
                 float tolerance) {
    const Vec<3> u = grid_difference(points_[q], points_[p]);
    const Vec<3> w = grid_difference(points_[r], points_[q]);
    return dot(normal, cross(u, w)) > tolerance * length(u + w);
  }

  /// Whether the faces beside the edge may be one: flat, strictly convex, without a hole, and with
  /// three edges left at both ends.
  bool may_merge(std::uint32_t a, std::uint32_t b, float tolerance) {
    const std::uint32_t left = face_at(a, b);
    const std::uint32_t right = face_at(b, a);
    if (degree(a) < 4 || degree(b) < 4 || shared_edges(left, right) != 1) return false;
    const Vec<3> normal = unit_normal(sum(areas_[left], areas_[right]));
    return is_flat(left, right, a, normal, tolerance) &&
           is_corner(before(left, a), a, after(right, a), normal, tolerance) &&
           is_corner(before(right, b), b, after(left, b), normal, tolerance);
  }

  void merge(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t left = face_at(a, b);
    const std::uint32_t right = face_at(b, a);
    areas_[left] = sum(areas_[left], areas_[right]);
    for (std::uint32_t& face : face_of_)
      if (face == right) face = left;
  }

  std::span<const GridPoint> points_;
  std::span<const GridTriangle> triangles_;
  std::vector<std::uint32_t> triangle_at_;
  std::vector<std::uint32_t> face_of_;  ///< By triangle; a face has the number of one of its own.
  std::vector<GridArea> areas_;         ///< By face.
};

void link_faces(std::span<const GridPoint> points, std::span<const GridTriangle> triangles,
                float tolerance, PolyhedronData& out) {
  FaceMerger merger(points, triangles);
  merger.merge_all(tolerance);
  merger.write(out);
}

}  // namespace cycloid::solver
