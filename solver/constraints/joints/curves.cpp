#include "solver/constraints/joints/curves.hpp"

#include "solver/trig.hpp"

namespace cycloid::solver {

static constexpr Vec<2> kUp = {{0.0f, 1.0f}};

static CurvePoint nearest_on_circle(float radius, const Vec<2>& point) {
  return {radius - length(point), -normalized_or(point, -kUp)};
}

/// f = (x/a)^2 + (y/b)^2 - 1; inside f < 0.
static CurvePoint nearest_on_ellipse(float a, float b, const Vec<2>& point) {
  const Vec<2> gradient = {{2.0f * point[0] / (a * a), 2.0f * point[1] / (b * b)}};
  const float f = point[0] * point[0] / (a * a) + point[1] * point[1] / (b * b) - 1.0f;
  const float steepness = length(gradient);
  // At the centre the gradient vanishes; the nearest point is then along the shorter axis.
  if (steepness < 1.0e-6f / min(a, b)) return {min(a, b), kUp};
  return {-f / steepness, -((1.0f / steepness) * gradient)};
}

/// The foot of the perpendicular at t: (p - c(t)) . T(t) = 0 with the unit tangent T = (cos t/2,
/// sin t/2). The left side falls with t between the cusps for points below the centres of
/// curvature, so halving finds the foot; 32 halvings leave 1.5e-9 rad.
static CurvePoint nearest_on_cycloid(float radius, const Vec<2>& point) {
  float lower = -kPi;
  float upper = kPi;
  Vec<2> tangent = {{1.0f, 0.0f}};
  Vec<2> to_point = point;
  for (int i = 0; i < 32; ++i) {
    const float t = 0.5f * (lower + upper);
    sin_cos(0.5f * t, tangent[1], tangent[0]);
    float sine = 0.0f;
    float cosine = 0.0f;
    sin_cos(t, sine, cosine);
    to_point = point - radius * Vec<2>{{t + sine, -(1.0f + cosine)}};
    (dot(to_point, tangent) > 0.0f ? lower : upper) = t;
  }
  const Vec<2> normal = {{-tangent[1], tangent[0]}};
  return {dot(to_point, normal), normal};
}

CurvePoint nearest_on_curve(CurveKind kind, const std::array<float, 2>& size, const Vec<2>& point) {
  switch (kind) {
    case CurveKind::kEllipse:
      return nearest_on_ellipse(size[0], size[1], point);
    case CurveKind::kCycloid:
      return nearest_on_cycloid(size[0], point);
    default:
      return nearest_on_circle(size[0], point);
  }
}

/// A point against an edge.
struct EdgePoint {
  CurvePoint at;
  float height;  ///< From the line of the edge, without sign, m.
  float digits;  ///< What rounding may add to the distance, m; 0 on the edge.
};

static EdgePoint nearest_on_edge(const Vec<2>& start, const Vec<2>& end, const Vec<2>& normal,
                                 const Vec<2>& point) {
  const Vec<2> edge = end - start;
  const float share = clamp(dot(point - start, edge) / dot(edge, edge), 0.0f, 1.0f);
  const Vec<2> between = point - (start + share * edge);
  const float height = dot(between, normal);
  const float side = height < 0.0f ? -1.0f : 1.0f;
  const float distance = length(between);
  const float digits = 1.0e-5f * length(edge);
  // On the edge itself the direction to the point has no digits left; the edge's normal has.
  if (distance < digits) return {{height, normal}, abs(height), 0.0f};
  return {{side * distance, (side / distance) * between}, abs(height), digits};
}

/// Whether the first is nearer. Two edges as near that have the point on different sides are those
/// of a corner sharper than a right angle: of them only the one that it stands higher over is sure
/// to have it on the right side.
static bool is_nearer_edge(const EdgePoint& one, const EdgePoint& other) {
  const float nearer = abs(other.at.distance) - abs(one.at.distance);
  const bool sides_differ = (one.at.distance < 0.0f) != (other.at.distance < 0.0f);
  const bool are_equal = abs(nearer) < min(one.digits, other.digits);
  return sides_differ && are_equal ? one.height > other.height : nearer > 0.0f;
}

CurvePoint nearest_on_outline(const WorldState<2>& state, std::uint32_t body, const Vec<2>& point) {
  EdgePoint nearest{{0.0f, kUp}, 0.0f, 0.0f};
  bool found = false;
  for (std::uint32_t s = state.bodies[body].first_shape; s != kNone; s = state.shapes[s].next) {
    const Shape<2>& shape = state.shapes[s];
    const bool segment = shape.kind == ShapeKind::kSegment;
    if (!segment && shape.kind != ShapeKind::kPolygon) continue;
    const std::uint32_t edges = segment ? 1 : shape.vertex_count;
    for (std::uint32_t e = 0; e < edges; ++e) {
      const Vec<2>& end = shape.vertices[(e + 1) % shape.vertex_count];
      const EdgePoint candidate = nearest_on_edge(shape.vertices[e], end, shape.normals[e], point);
      if (found && !is_nearer_edge(candidate, nearest)) continue;
      nearest = candidate;
      found = true;
    }
  }
  return nearest.at;
}

}  // namespace cycloid::solver
