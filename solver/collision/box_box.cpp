#include "solver/collision/solid_clip.hpp"

namespace cycloid::solver {

/// b's place and axes in a's axes.
struct Relative {
  float turn[3][3];      ///< dot(axis i of a, axis j of b).
  float absolute[3][3];  ///< |turn|.
  float offset[3];       ///< Of b's centre, m.
};

static Relative relative_of(const Solid& a, const Solid& b) {
  Relative relative;
  const Vec<3> between = b.centre - a.centre;
  for (int i = 0; i < 3; ++i) {
    relative.offset[i] = dot(a.axes[i], between);
    for (int j = 0; j < 3; ++j) {
      relative.turn[i][j] = dot(a.axes[i], b.axes[j]);
      relative.absolute[i][j] = abs(relative.turn[i][j]);
    }
  }
  return relative;
}

/// The best of the six faces, three of which look at the other box.
struct BoxFaceAxis {
  std::uint32_t face = 0;
  float separation = kNoSeparation;
};

/// Faces 2 k and 2 k + 1 of a box that look along axis k, the other's centre at `offset` along it.
static void try_face(int axis, float offset, float radius, const AxisTolerance& tolerance,
                     BoxFaceAxis& best) {
  const float separation = abs(offset) - radius;
  if (separation <= tolerance.beyond(best.separation)) return;
  best = {static_cast<std::uint32_t>(2 * axis + (offset < 0.0f ? 0 : 1)), separation};
}

static BoxFaceAxis best_face_of_a(const Solid& a, const Solid& b, const Relative& relative,
                                  const AxisTolerance& tolerance) {
  BoxFaceAxis best;
  for (int i = 0; i < 3; ++i) {
    const float* row = relative.absolute[i];
    const float radius = a.half[i] + (b.half[0] * row[0] + b.half[1] * row[1] + b.half[2] * row[2]);
    try_face(i, relative.offset[i], radius, tolerance, best);
  }
  return best;
}

/// Seen from b, whose centre is then the other's: hence the minus.
static BoxFaceAxis best_face_of_b(const Solid& a, const Solid& b, const Relative& relative,
                                  const AxisTolerance& tolerance) {
  BoxFaceAxis best;
  for (int j = 0; j < 3; ++j) {
    float offset = 0.0f;
    float radius = b.half[j];
    for (int i = 0; i < 3; ++i) {
      offset -= relative.offset[i] * relative.turn[i][j];
      radius += a.half[i] * relative.absolute[i][j];
    }
    try_face(j, offset, radius, tolerance, best);
  }
  return best;
}

/// The axis across axis i of a and axis j of b.
struct CrossAxis {
  int i = 0;
  int j = 0;
  float separation = kNoSeparation;
  float length;  ///< Of the cross product: the sine between the axes.
  bool forth;    ///< It points from a to b as it is.
};

/// The first edge pair that exceeds `threshold`, and of later ones what is better beyond tolerance.
static CrossAxis best_edges(const Solid& a, const Solid& b, const Relative& relative,
                            const AxisTolerance& tolerance, float threshold) {
  CrossAxis best;
  for (int i = 0; i < 3; ++i) {
    const int i1 = i == 2 ? 0 : i + 1;
    const int i2 = i == 0 ? 2 : i - 1;
    for (int j = 0; j < 3; ++j) {
      const int j1 = j == 2 ? 0 : j + 1;
      const int j2 = j == 0 ? 2 : j - 1;
      const float x = relative.turn[i1][j];
      const float y = relative.turn[i2][j];
      const float squared = x * x + y * y;
      if (squared < kParallelSquared) continue;
      const float offset = relative.offset[i2] * x - relative.offset[i1] * y;
      const float radius_a =
          a.half[i1] * relative.absolute[i2][j] + a.half[i2] * relative.absolute[i1][j];
      const float radius_b =
          b.half[j1] * relative.absolute[i][j2] + b.half[j2] * relative.absolute[i][j1];
      const float scaled = abs(offset) - (radius_a + radius_b);
      const float sine = sqrt(squared);
      if (scaled <= threshold * sine) continue;
      best = {i, j, scaled / sine, sine, !(offset < 0.0f)};
      threshold = tolerance.beyond(best.separation);
    }
  }
  return best;
}

/// The half-edge along `axis` from the corner `origin`.
static std::uint32_t edge_from(const Solid& box, std::uint32_t origin, int axis) {
  std::uint32_t edge = 0;
  while (box.edges[edge].origin != origin ||
         box.edges[box.edges[edge].twin].origin != (origin | 1u << axis))
    ++edge;
  return edge;
}

/// The edges that support both boxes along the axis: of two that do the one on the positive side.
static EdgePair edges_on(const CrossAxis& axis, const Solid& a, const Solid& b,
                         const Relative& relative) {
  const int i1 = axis.i == 2 ? 0 : axis.i + 1;
  const int i2 = axis.i == 0 ? 2 : axis.i - 1;
  const int j1 = axis.j == 2 ? 0 : axis.j + 1;
  const int j2 = axis.j == 0 ? 2 : axis.j - 1;
  const float sign = axis.forth ? 1.0f : -1.0f;
  const auto corner = [](int k, float along_k, int l, float along_l) {
    return (along_k >= 0.0f ? 1u << k : 0u) | (along_l >= 0.0f ? 1u << l : 0u);
  };
  const float x = sign * relative.turn[i1][axis.j];
  const float y = sign * relative.turn[i2][axis.j];
  const std::uint32_t corner_a = corner(i1, -y, i2, x);
  const std::uint32_t corner_b =
      corner(j1, -sign * relative.turn[axis.i][j2], j2, sign * relative.turn[axis.i][j1]);
  const Vec<3> across = x * a.axes[i2] - y * a.axes[i1];
  return {a,
          b,
          edge_from(a, corner_a, axis.i),
          edge_from(b, corner_b, axis.j),
          (1.0f / axis.length) * across,
          axis.separation};
}

/// Axes in the order: faces of a, faces of b, edges of a across edges of b, a's first; a later one
/// has to be better by AxisTolerance. Source: Gottschalk, Lin and Manocha, "OBBTree" (1996).
Manifold<3> box_against_box(const Solid& a, const Solid& b, float margin) {
  const Relative relative = relative_of(a, b);
  const AxisTolerance tolerance(
      min(min(min(a.half[0], a.half[1]), a.half[2]), min(min(b.half[0], b.half[1]), b.half[2])));
  const BoxFaceAxis face_a = best_face_of_a(a, b, relative, tolerance);
  if (face_a.separation > margin) return {};
  const BoxFaceAxis face_b = best_face_of_b(a, b, relative, tolerance);
  if (face_b.separation > margin) return {};
  const bool on_b = face_b.separation > tolerance.beyond(face_a.separation);
  const BoxFaceAxis& face = on_b ? face_b : face_a;
  const CrossAxis edges =
      best_edges(a, b, relative, tolerance, tolerance.beyond_faces(face.separation));
  if (edges.separation > margin) return {};
  if (edges.separation > kNoSeparation)
    return touch_edges(edges_on(edges, a, b, relative), tolerance, margin);
  return touch_faces(opposed_to(a, b, face.face, on_b, face.separation), tolerance, margin);
}

}  // namespace cycloid::solver
