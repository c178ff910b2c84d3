#include "solver/queries/separation.hpp"

#include "solver/queries/four_points.hpp"
#include "solver/queries/solid_queries.hpp"

namespace cycloid::solver {

static void place_vertices(const Shape<2>& shape, const Rotation<2>& rotation,
                           const Vec<2>& position, const Polyhedra&, Core<2>& core) {
  core.count = shape.vertex_count;
  const std::uint32_t used = core.one_sided() ? 4 : core.count;
  const FourPoints turn = four_of(rotation);
  for (std::uint32_t i = 0; i < used; i += 4) {
    store_four(four_of(position) + rotate(turn, load_four(shape.vertices, i)), i, core.vertices);
    store_four(rotate(turn, load_four(shape.normals, i)), i, core.normals);
  }
}

template <int D>
Core<D> core_of(const Shape<D>& shape, const Rotation<D>& rotation, const Vec<D>& position,
                const Polyhedra& polyhedra) {
  Core<D> core{};
  core.kind = shape.kind;
  core.radius = shape.radius;
  core.ghosts = shape.ghosts;
  if (core.half_space()) {
    core.normal = rotate(rotation, shape.normal);
    core.offset = shape.offset + dot(core.normal, position);
    return core;
  }
  place_vertices(shape, rotation, position, polyhedra, core);
  return core;
}

Core<2> core_of(const Probe<2>& probe, const Rotation<2>& rotation) {
  return core_of(shape_of(probe), rotation, Vec<2>::zero(), {});
}

/// The edge normal along which two cores are farthest apart.
struct CoreAxis {
  bool found = false;
  float separation = -3.0e38f;
  Vec<2> normal = Vec<2>::zero();
  std::uint32_t vertex = 0;  ///< Of the other core, lowest along the normal.
};

/// Four edges at a time. @param faces  of `a`: how many of its edges have a normal that counts.
static CoreAxis best_axis(const Core<2>& a, const Core<2>& b, std::uint32_t faces) {
  CoreAxis best;
  for (std::uint32_t first = 0; first < faces; first += 4) {
    const FourPoints normals = load_four_of(a.normals, first, faces);
    const FourPoints vertices = load_four_of(a.vertices, first, faces);
    FourFloats lowest = FourFloats(0.0f);
    FourFloats height = dot(normals, four_of(b.vertices[0]) - vertices);
    for (std::uint32_t j = 1; j < b.count; ++j) {
      const FourFloats other = dot(normals, four_of(b.vertices[j]) - vertices);
      lowest = select(other < height, FourFloats(static_cast<float>(j)), lowest);
      height = min(other, height);
    }
    for (std::uint32_t i = 0; i < 4 && first + i < faces; ++i)
      if (height.raw[i] > best.separation)
        best = {true, height.raw[i], a.normals[first + i],
                static_cast<std::uint32_t>(lowest.raw[i])};
  }
  return best;
}

/// The nearest points of two cores that do not cross.
struct CorePair {
  float square = 3.0e38f;
  Vec<2> on_a = Vec<2>::zero();
  Vec<2> on_b = Vec<2>::zero();
};

/// A side of a core, or what stands for it where the core is a point or a line.
struct CoreEdge {
  Vec<2> from;
  Vec<2> to;
  Vec<2> span;
  float square;
};

static CoreEdge edge_of(const Core<2>& core, std::uint32_t i) {
  const Vec<2> from = core.vertices[i];
  const Vec<2> to = core.vertices[core.next(i)];
  const Vec<2> span = to - from;
  return {from, to, span, dot(span, span)};
}

/// The points of an edge that are nearest to four others.
static FourPoints feet_on(const CoreEdge& edge, const FourPoints& points) {
  const FourFloats zero = FourFloats(0.0f);
  const FourFloats one = FourFloats(1.0f);
  const FourPoints span = four_of(edge.span);
  FourFloats fraction = zero;
  if (edge.square > 0.0f) {
    const FourFloats along = dot(points - four_of(edge.from), span) / FourFloats(edge.square);
    fraction = max(zero, min(along, one));
  }
  // The far end itself, not a sum that rounds beside it.
  FourPoints feet = four_of(edge.from) + fraction * span;
  for (int i = 0; i < 2; ++i) feet[i] = select(fraction < one, feet[i], FourFloats(edge.to[i]));
  return feet;
}

/// The vertices of `points`, four at a time, against the edges of `edges`. Of pairs as near as one
/// another that of the first edge is taken, and of those that of the first vertex.
static void nearest_pair(const Core<2>& edges, const Core<2>& points, bool flipped,
                         CorePair& best) {
  const std::uint32_t edge_count = edges.count > 2 ? edges.count : 1;
  float edge_of_best = 0.0f;
  CorePair own;
  for (std::uint32_t first = 0; first < points.count; first += 4) {
    const FourPoints four = load_four_of(points.vertices, first, points.count);
    FourFloats least = FourFloats(3.0e38f);
    FourFloats edge = FourFloats(0.0f);
    FourPoints nearest = four;
    for (std::uint32_t i = 0; i < edge_count; ++i) {
      const FourPoints feet = feet_on(edge_of(edges, i), four);
      const FourPoints between = four - feet;
      const FourFloats square = dot(between, between);
      const auto is_nearer = square < least;
      edge = select(is_nearer, FourFloats(static_cast<float>(i)), edge);
      for (int k = 0; k < 2; ++k) nearest[k] = select(is_nearer, feet[k], nearest[k]);
      least = min(square, least);
    }
    for (int lane = 0; lane < 4; ++lane) {
      const float square = least.raw[lane];
      const bool is_earlier = square == own.square && edge.raw[lane] < edge_of_best;
      if (!(square < own.square || is_earlier)) continue;
      edge_of_best = edge.raw[lane];
      own = {square,
             {{nearest[0].raw[lane], nearest[1].raw[lane]}},
             {{four[0].raw[lane], four[1].raw[lane]}}};
    }
  }
  if (!(own.square < best.square)) return;
  best = flipped ? CorePair{own.square, own.on_b, own.on_a} : own;
}

/// Whether two lines of two points cross. Nearly parallel ones count as apart: their ends are
/// then as near as they are.
static bool lines_cross(const Core<2>& a, const Core<2>& b) {
  const Vec<2> span_a = a.vertices[1] - a.vertices[0];
  const Vec<2> span_b = b.vertices[1] - b.vertices[0];
  const Vec<2> between = b.vertices[0] - a.vertices[0];
  const float area = cross(span_a, span_b);
  if (abs(area) <= 1.0e-6f * sqrt(dot(span_a, span_a) * dot(span_b, span_b))) return false;
  const float along_a = cross(between, span_b) / area;
  const float along_b = cross(between, span_a) / area;
  return along_a >= 0.0f && along_a <= 1.0f && along_b >= 0.0f && along_b <= 1.0f;
}

/// Whether along no edge normal two cores are apart, without the rule for one-sided shapes.
static bool no_axis_parts(const Core<2>& a, const Core<2>& b) {
  const auto all_faces = [](const Core<2>& core) { return core.count < 2 ? 0u : core.count; };
  return best_axis(a, b, all_faces(a)).separation < 0.0f &&
         best_axis(b, a, all_faces(b)).separation < 0.0f;
}

static bool cores_cross(const Core<2>& a, const Core<2>& b) {
  if (a.count < 2 && b.count < 2) return false;
  if (a.count > 2 || b.count > 2) return no_axis_parts(a, b);
  // A point beside a line, or two lines: rounding may put every height below 0 far from any touch.
  return a.count == 2 && b.count == 2 && lines_cross(a, b);
}

static Separation<2> across(const Core<2>& a, const Core<2>& b) {
  CoreAxis axis_a = best_axis(a, b, a.faces());
  CoreAxis axis_b = best_axis(b, a, b.faces());
  if (a.one_sided()) axis_b.found = false;
  if (b.one_sided() && !a.one_sided()) axis_a.found = false;
  const bool flipped = axis_b.found && (!axis_a.found || axis_b.separation > axis_a.separation);
  Separation<2> result{};
  CoreAxis axis = flipped ? axis_b : axis_a;
  const Core<2>& other = flipped ? a : b;
  const float reference_radius = flipped ? b.radius : a.radius;
  if (!axis.found) {
    axis.separation = 0.0f;
    axis.vertex = 0;
    axis.normal = {{0.0f, 1.0f}};  // Concentric balls part upwards, as in `collide`.
  }
  const Vec<2> deepest = other.vertices[axis.vertex];
  const Vec<2> on_reference = deepest + (reference_radius - axis.separation) * axis.normal;
  const Vec<2> on_other = deepest - other.radius * axis.normal;
  result.by_axis = true;
  result.distance = axis.separation - (a.radius + b.radius);
  result.normal = flipped ? -axis.normal : axis.normal;
  result.point_a = flipped ? on_other : on_reference;
  result.point_b = flipped ? on_reference : on_other;
  return result;
}

template <int D>
static Separation<D> from_half_space(const Core<D>& plane, const Core<D>& core) {
  std::uint32_t lowest = 0;
  float height = dot(plane.normal, core.vertices[0]);
  for (std::uint32_t i = 1; i < core.count; ++i) {
    const float other = dot(plane.normal, core.vertices[i]);
    if (other < height) {
      height = other;
      lowest = i;
    }
  }
  Separation<D> result{};
  const float core_height = height - plane.offset;
  result.distance = core_height - core.radius;
  result.normal = plane.normal;
  result.point_a = core.vertices[lowest] - core_height * plane.normal;
  result.point_b = core.vertices[lowest] - core.radius * plane.normal;
  result.crossing = core_height < 0.0f;
  return result;
}

static Separation<2> separation_of_cores(const Core<2>& a, const Core<2>& b) {
  if (cores_cross(a, b)) {
    Separation<2> result = across(a, b);
    result.crossing = true;
    return result;
  }
  CorePair pair;
  nearest_pair(a, b, false, pair);
  nearest_pair(b, a, true, pair);
  const float distance = sqrt(pair.square);
  // Cores that all but touch have no direction between them.
  if (distance < 1.0e-6f) return across(a, b);
  Separation<2> result{};
  result.normal = (1.0f / distance) * (pair.on_b - pair.on_a);
  result.distance = distance - (a.radius + b.radius);
  result.point_a = pair.on_a + a.radius * result.normal;
  result.point_b = pair.on_b - b.radius * result.normal;
  return result;
}

template <int D>
Separation<D> separation_of(const Core<D>& a, const Core<D>& b) {
  if (a.half_space()) return from_half_space(a, b);
  if (b.half_space()) {
    Separation<D> result = from_half_space(b, a);
    const Vec<D> on_plane = result.point_a;
    result.normal = -result.normal;
    result.point_a = result.point_b;
    result.point_b = on_plane;
    return result;
  }
  return separation_of_cores(a, b);
}

bool allows(const Core<2>& core, const Vec<2>& normal) {
  if (!core.one_sided()) return true;
  const Vec<2> own = core.normals[0];
  if (dot(normal, own) < 0.0f) return false;
  // A sine: rounding must not close the seam between two segments to both of them.
  constexpr float kSlack = 1.0e-3f;
  const float turn = cross(own, normal);
  const bool towards_end = turn > 0.0f;
  if ((core.ghosts & (towards_end ? 2u : 1u)) == 0) return true;
  if (abs(turn) <= kSlack) return true;
  const Vec<2> edge =
      towards_end ? core.vertices[3] - core.vertices[1] : core.vertices[0] - core.vertices[2];
  const Vec<2> neighbour = normalized_or(Vec<2>{{edge[1], -edge[0]}}, own);
  // On a convex corner the normal may turn as far as the neighbour's, on a concave one not at all.
  const float corner = towards_end ? cross(own, neighbour) : cross(neighbour, own);
  const float left = towards_end ? cross(normal, neighbour) : cross(neighbour, normal);
  return corner > 0.0f && left >= -kSlack;
}

template Core<2> core_of(const Shape<2>&, const Rotation<2>&, const Vec<2>&, const Polyhedra&);
template Core<3> core_of(const Shape<3>&, const Rotation<3>&, const Vec<3>&, const Polyhedra&);
template Separation<2> separation_of(const Core<2>&, const Core<2>&);
template Separation<3> separation_of(const Core<3>&, const Core<3>&);

}  // namespace cycloid::solver
