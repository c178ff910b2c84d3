#include "tests/oracle/separation.hpp"

#include <algorithm>
#include <array>
#include <limits>

namespace cycloid::oracle {

/// A corner of the set of differences.
struct Corner {
  Vector difference;
  Vector on_a;
  Vector on_b;
  double weight = 0.0;
};

/// At most four corners in general position, and their weighted mean.
struct Simplex {
  std::array<Corner, 5> corners;
  int count = 0;

  Vector mean() const {
    Vector sum;
    for (int i = 0; i < count; ++i) sum = sum + corners[i].weight * corners[i].difference;
    return sum;
  }
};

static const Vector& farthest(const std::vector<Vector>& points, const Vector& direction) {
  const Vector* best = &points[0];
  double most = dot(points[0], direction);
  for (const Vector& point : points) {
    const double along = dot(point, direction);
    if (along <= most) continue;
    most = along;
    best = &point;
  }
  return *best;
}

static Corner corner_towards_origin(const Convex& a, const Convex& b, const Vector& from) {
  const Vector& on_a = farthest(a.corners, from);
  const Vector& on_b = farthest(b.corners, -from);
  return {on_b - on_a, on_a, on_b, 0.0};
}

/// Weights of the point nearest to the origin in the affine hull of the corners, which sum to one:
/// least squares by orthogonalising the differences from corner 0.
static std::array<double, 5> affine_weights(const Simplex& simplex) {
  std::array<Vector, 5> unit;
  double r[5][5] = {};
  std::array<double, 5> projected{};
  Vector rest = simplex.corners[0].difference;
  for (int i = 1; i < simplex.count; ++i) {
    Vector column = simplex.corners[i].difference - simplex.corners[0].difference;
    const double scale = length(column);
    for (int twice = 0; twice < 2; ++twice)
      for (int k = 1; k < i; ++k) {
        const double along = dot(unit[k], column);
        r[k][i] += along;
        column = column - along * unit[k];
      }
    r[i][i] = length(column);
    if (r[i][i] > 1e-14 * scale) unit[i] = (1.0 / r[i][i]) * column;
    projected[i] = -dot(unit[i], rest);
    rest = rest + projected[i] * unit[i];
  }
  std::array<double, 5> weights{};
  weights[0] = 1.0;
  for (int i = simplex.count - 1; i >= 1; --i) {
    double sum = projected[i];
    for (int k = i + 1; k < simplex.count; ++k) sum -= r[i][k] * weights[k];
    weights[i] = length(unit[i]) > 0.0 ? sum / r[i][i] : 0.0;
    weights[0] -= weights[i];
  }
  return weights;
}

/// Moves the weights to the nearest point of the simplex's hull that the last corner opened up, and
/// drops the corners that carry nothing.
static void improve(Simplex& simplex) {
  while (true) {
    const std::array<double, 5> wanted = affine_weights(simplex);
    double step = 1.0;
    int leaving = -1;
    for (int i = 0; i < simplex.count; ++i) {
      if (wanted[i] > 0.0) continue;
      const double way = simplex.corners[i].weight - wanted[i];
      const double reach = way > 0.0 ? simplex.corners[i].weight / way : 0.0;
      if (leaving >= 0 && reach >= step) continue;
      step = reach;
      leaving = i;
    }
    for (int i = 0; i < simplex.count; ++i)
      simplex.corners[i].weight += step * (wanted[i] - simplex.corners[i].weight);
    if (leaving < 0) return;
    --simplex.count;
    for (int i = leaving; i < simplex.count; ++i) simplex.corners[i] = simplex.corners[i + 1];
    if (simplex.count == 1) simplex.corners[0].weight = 1.0;
    if (simplex.count == 1) return;
  }
}

static bool contains(const Simplex& simplex, const Corner& corner) {
  for (int i = 0; i < simplex.count; ++i)
    if (length(simplex.corners[i].difference - corner.difference) == 0.0) return true;
  return false;
}

static Distance result_of(const Simplex& simplex, double lower_bound) {
  Distance result;
  const Vector nearest = simplex.mean();
  result.value = length(nearest);
  result.lower_bound = std::max(lower_bound, 0.0);
  if (result.value > 0.0) result.direction = (1.0 / result.value) * nearest;
  for (int i = 0; i < simplex.count; ++i) {
    const Corner& corner = simplex.corners[i];
    result.on_a = result.on_a + corner.weight * corner.on_a;
    result.on_b = result.on_b + corner.weight * corner.on_b;
  }
  return result;
}

Distance distance(const Convex& a, const Convex& b) {
  Simplex simplex;
  simplex.corners[0] = {b.corners[0] - a.corners[0], a.corners[0], b.corners[0], 1.0};
  simplex.count = 1;
  const double size = length(simplex.corners[0].difference) + 1e-30;
  double lower_bound = 0.0;
  for (int iteration = 0; iteration < 300; ++iteration) {
    const Vector nearest = simplex.mean();
    const double value = length(nearest);
    if (simplex.count == 4 || value < 1e-14 * size) break;
    Corner corner = corner_towards_origin(a, b, nearest);
    lower_bound = std::max(lower_bound, dot(nearest, corner.difference) / value);
    if (value - lower_bound < 1e-15 * size || contains(simplex, corner)) break;
    simplex.corners[simplex.count++] = corner;
    improve(simplex);
  }
  return result_of(simplex, lower_bound);
}

double gap_along(const Convex& a, const Convex& b, const Vector& direction) {
  return dot(farthest(b.corners, -direction), direction) -
         dot(farthest(a.corners, direction), direction) - a.radius - b.radius;
}

/// Whether `direction`, at a right angle to the edge, has the edge as its farthest part.
static bool supports(const Edge& edge, const Vector& direction, double slack) {
  return dot(edge.wings[0], direction) <= slack && dot(edge.wings[1], direction) <= slack;
}

static void try_direction(const Convex& a, const Convex& b, const Vector& direction, Gap& best) {
  const double value = gap_along(a, b, direction);
  if (value > best.value) best = {value, direction};
}

static void try_edges(const Convex& a, const Convex& b, bool every_pair, Gap& best) {
  for (const Edge& edge_a : a.edges)
    for (const Edge& edge_b : b.edges) {
      const Vector across = cross(edge_a.direction, edge_b.direction);
      const double sine = length(across);
      if (sine < 1e-9) continue;
      // Edges that are almost parallel leave their common normal almost free.
      const double slack = 1e-9 * sine + 1e-13;
      for (const Vector& direction : {across, -across})
        if (every_pair ||
            (supports(edge_a, direction, slack) && supports(edge_b, -direction, slack)))
          try_direction(a, b, (1.0 / sine) * direction, best);
    }
}

/// For points and segments in line, which have no faces and no crossing edges.
static Vector free_direction(const Convex& a, const Convex& b) {
  for (const Convex* body : {&a, &b})
    if (!body->edges.empty()) return perpendicular(body->edges[0].direction);
  return {0, 1, 0};
}

Gap widest_gap(const Convex& a, const Convex& b, bool every_pair) {
  Gap best{-std::numeric_limits<double>::infinity(), {}};
  for (const Vector& normal : a.normals) try_direction(a, b, normal, best);
  for (const Vector& normal : b.normals) try_direction(a, b, -normal, best);
  try_edges(a, b, every_pair, best);
  if (length(best.direction) == 0.0) try_direction(a, b, free_direction(a, b), best);
  return best;
}

Gap separation(const Convex& a, const Convex& b) {
  const Distance apart = distance(a, b);
  if (apart.value > 1e-9) return {apart.value - a.radius - b.radius, apart.direction};
  return widest_gap(a, b);
}

}  // namespace cycloid::oracle
