#include "solver/queries/solid_queries.hpp"

namespace cycloid::solver {

/// A corner of the Minkowski difference a - b.
struct DifferenceCorner {
  Vec<3> at;
  std::uint32_t a;
  std::uint32_t b;
};

/// The corners whose hull holds `nearest`, its point nearest to the origin, with their shares.
struct Simplex {
  std::uint32_t count = 0;
  bool encloses = false;
  DifferenceCorner corners[4];
  float weights[4];
  Vec<3> nearest;
};

static Simplex of_point(const DifferenceCorner& p) {
  Simplex simplex;
  simplex.count = 1;
  simplex.corners[0] = p;
  simplex.weights[0] = 1.0f;
  simplex.nearest = p.at;
  return simplex;
}

static Simplex of_line(const DifferenceCorner& p, const DifferenceCorner& q) {
  const Vec<3> span = q.at - p.at;
  const float square = dot(span, span);
  const float along = -dot(p.at, span);
  if (!(along > 0.0f)) return of_point(p);
  if (along >= square) return of_point(q);
  Simplex simplex;
  simplex.count = 2;
  simplex.corners[0] = p;
  simplex.corners[1] = q;
  simplex.weights[1] = along / square;
  simplex.weights[0] = 1.0f - simplex.weights[1];
  simplex.nearest = p.at + simplex.weights[1] * span;
  return simplex;
}

static bool nearer(const Simplex& a, const Simplex& b) {
  return dot(a.nearest, a.nearest) < dot(b.nearest, b.nearest);
}

static Simplex of_triangle(const DifferenceCorner& p, const DifferenceCorner& q,
                           const DifferenceCorner& r) {
  const Vec<3> to_q = q.at - p.at;
  const Vec<3> to_r = r.at - p.at;
  const Vec<3> normal = cross(to_q, to_r);
  const float square = dot(normal, normal);
  // Each is the share of the corner across the edge, times the square.
  const float share_r = -dot(cross(normal, to_q), p.at);
  const float share_p = -dot(cross(normal, r.at - q.at), q.at);
  const float share_q = dot(cross(normal, to_r), r.at);
  const bool flat = square <= 1.0e-12f * dot(to_q, to_q) * dot(to_r, to_r);
  if (!flat && share_p > 0.0f && share_q > 0.0f && share_r > 0.0f) {
    Simplex simplex;
    simplex.count = 3;
    simplex.corners[0] = p;
    simplex.corners[1] = q;
    simplex.corners[2] = r;
    const float sum = share_p + share_q + share_r;
    simplex.weights[0] = share_p / sum;
    simplex.weights[1] = share_q / sum;
    simplex.weights[2] = share_r / sum;
    simplex.nearest = (dot(normal, p.at) / square) * normal;
    return simplex;
  }
  Simplex best = of_line(p, q);
  const Simplex second = of_line(q, r);
  if (nearer(second, best)) best = second;
  const Simplex third = of_line(r, p);
  return nearer(third, best) ? third : best;
}

/// Whether the origin is on the other side of the triangle than `apex`; a flat tetrahedron, whose
/// sides rounding decides, has everything outside.
static bool outside(const Vec<3>& p, const Vec<3>& q, const Vec<3>& r, const Vec<3>& apex) {
  const Vec<3> normal = cross(q - p, r - p);
  const Vec<3> up = apex - p;
  const float height = dot(normal, up);
  if (height * height <= 1.0e-12f * dot(normal, normal) * dot(up, up)) return true;
  const float side = -dot(normal, p);
  return height > 0.0f ? side < 0.0f : side > 0.0f;
}

static Simplex of_tetrahedron(const DifferenceCorner (&c)[4]) {
  constexpr int kFaces[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
  Simplex best;
  best.encloses = true;
  for (const auto& face : kFaces) {
    const DifferenceCorner& p = c[face[0]];
    const DifferenceCorner& q = c[face[1]];
    const DifferenceCorner& r = c[face[2]];
    if (!outside(p.at, q.at, r.at, c[face[3]].at)) continue;
    const Simplex simplex = of_triangle(p, q, r);
    if (best.encloses || nearer(simplex, best)) best = simplex;
  }
  return best;
}

static Simplex extended(const Simplex& simplex, const DifferenceCorner& corner) {
  DifferenceCorner c[4];
  for (std::uint32_t i = 0; i < simplex.count; ++i) c[i] = simplex.corners[i];
  c[simplex.count] = corner;
  if (simplex.count == 1) return of_line(c[0], c[1]);
  if (simplex.count == 2) return of_triangle(c[0], c[1], c[2]);
  return of_tetrahedron(c);
}

/// The corner farthest along `direction`; of equals the first.
static std::uint32_t farthest(const Core<3>& core, const Vec<3>& direction) {
  std::uint32_t best = 0;
  float highest = dot(direction, core.vertices[0]);
  for (std::uint32_t i = 1; i < core.count; ++i) {
    const float height = dot(direction, core.vertices[i]);
    if (height <= highest) continue;
    highest = height;
    best = i;
  }
  return best;
}

static DifferenceCorner corner_along(const Core<3>& a, const Core<3>& b, const Vec<3>& direction) {
  const std::uint32_t i = farthest(a, direction);
  const std::uint32_t j = farthest(b, -direction);
  return {a.vertices[i] - b.vertices[j], i, j};
}

static float size_of(const Vec<3>& v) {
  return max(abs(v[0]), max(abs(v[1]), abs(v[2])));
}

static NearestPoints points_of(const Core<3>& a, const Core<3>& b, const Simplex& simplex,
                               float scale) {
  NearestPoints result;
  bool one_of_a = true;
  Vec<3> on_b = Vec<3>::zero();
  for (std::uint32_t i = 0; i < simplex.count; ++i) {
    one_of_a = one_of_a && simplex.corners[i].a == simplex.corners[0].a;
    on_b += simplex.weights[i] * b.vertices[simplex.corners[i].b];
  }
  // One side from its corners and the other from the distance, so that both agree.
  const Vec<3> corner = a.vertices[simplex.corners[0].a];
  result.on_a = one_of_a ? corner : on_b + simplex.nearest;
  result.on_b = one_of_a ? corner - simplex.nearest : on_b;
  result.distance = length(simplex.nearest);
  result.touching = !(result.distance > max(1.0e-6f * scale, 1.0e-7f));
  if (!result.touching) result.normal = (-1.0f / result.distance) * simplex.nearest;
  return result;
}

/// Two points or lines. The nearest ends stand in where both are parallel.
/// Source: Ericson, "Real-Time Collision Detection" (2005), 5.1.9.
static NearestPoints of_lines(const Core<3>& a, const Core<3>& b) {
  const Vec<3> from_a = a.vertices[0];
  const Vec<3> from_b = b.vertices[0];
  const Vec<3> span_a = a.count > 1 ? a.vertices[1] - from_a : Vec<3>::zero();
  const Vec<3> span_b = b.count > 1 ? b.vertices[1] - from_b : Vec<3>::zero();
  const Vec<3> back = from_a - from_b;
  const float square_a = dot(span_a, span_a);
  const float square_b = dot(span_b, span_b);
  const float along_a = -dot(span_a, back);
  const float along_b = dot(span_b, back);
  const float both = dot(span_a, span_b);
  const Vec<3> across = cross(span_a, span_b);
  const float area = dot(across, across);
  float s = 0.0f;
  if (area > 1.0e-10f * square_a * square_b)
    s = clamp(dot(cross(span_b, back), across) / area, 0.0f, 1.0f);
  else if (square_a > 0.0f)
    s = clamp(along_a / square_a, 0.0f, 1.0f);
  float t = square_b > 0.0f ? clamp((along_b + s * both) / square_b, 0.0f, 1.0f) : 0.0f;
  // The last word has the end that was clamped, or the point if one of both is.
  if (square_a > 0.0f) s = clamp((along_a + t * both) / square_a, 0.0f, 1.0f);
  if (square_b > 0.0f) t = clamp((along_b + s * both) / square_b, 0.0f, 1.0f);
  NearestPoints result;
  result.on_a = s < 1.0f ? from_a + s * span_a : from_a + span_a;
  result.on_b = t < 1.0f ? from_b + t * span_b : from_b + span_b;
  const Vec<3> between = result.on_b - result.on_a;
  result.distance = length(between);
  result.gap = result.distance;
  result.touching = !(result.distance > 1.0e-6f);
  if (!result.touching) result.normal = (1.0f / result.distance) * between;
  return result;
}

/// How far the lowest corner along a normal keeps the cores apart, from its height times the
/// distance. Less by no more than rounding counts as the distance.
static float gap_of(float distance, float height, float scale) {
  const float gap = height / distance;
  return gap < distance - 1.0e-6f * scale ? gap : distance;
}

NearestPoints nearest_points(const Core<3>& a, const Core<3>& b) {
  if (a.count <= 2 && b.count <= 2) return of_lines(a, b);
  constexpr int kSteps = 64;
  Simplex simplex = of_point({a.vertices[0] - b.vertices[0], 0, 0});
  float scale = size_of(simplex.nearest);
  float height = 3.0e38f;
  for (int step = 0; step < kSteps; ++step) {
    const Vec<3> nearest = simplex.nearest;
    const float square = dot(nearest, nearest);
    if (square <= 1.0e-12f * scale * scale) break;
    const DifferenceCorner next = corner_along(a, b, -nearest);
    scale = max(scale, size_of(next.at));
    height = dot(nearest, next.at);
    // The distance is between dot(nearest, next) / |nearest| and |nearest|.
    if (square - height <= 1.0e-7f * sqrt(square) * scale) break;
    bool again = false;
    for (std::uint32_t i = 0; i < simplex.count; ++i)
      again = again || (simplex.corners[i].a == next.a && simplex.corners[i].b == next.b);
    if (again) break;
    const Simplex better = extended(simplex, next);
    if (better.encloses) {
      NearestPoints result;
      result.enclosed = true;
      return result;
    }
    if (!nearer(better, simplex)) break;
    simplex = better;
    height = 3.0e38f;
  }
  NearestPoints result = points_of(a, b, simplex, scale);
  if (!result.touching) result.gap = gap_of(result.distance, height, scale);
  return result;
}

}  // namespace cycloid::solver
