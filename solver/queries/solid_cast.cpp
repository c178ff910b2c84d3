#include "solver/direct/wide.hpp"
#include "solver/queries/solid_queries.hpp"

namespace cycloid::solver {

/// A point that goes straight towards a line, or a point, that `radius` rounds.
struct CastFlight {
  Vec<3> from;       ///< Relative to the start of the line.
  Vec<3> direction;  ///< Unit.
  float way;         ///< m
  float radius;
};

static void offer(const CastFlight& flight, float distance, const Vec<3>& normal, Entry<3>& best) {
  if (distance < -kTouch || distance > flight.way) return;
  const float fraction = max(distance, 0.0f) / flight.way;
  if (best.hit && fraction >= best.fraction) return;
  best.hit = true;
  best.fraction = fraction;
  best.normal = normal;
}

static void enter_ball(const CastFlight& flight, const Vec<3>& centre, Entry<3>& best) {
  // Split along the way, so that a long way to a small ball keeps its digits.
  const Vec<3> start = flight.from - centre;
  const float along = dot(start, flight.direction);
  const Vec<3> aside = start - along * flight.direction;
  const float square = flight.radius * flight.radius - dot(aside, aside);
  if (square <= 0.0f || along >= 0.0f) return;
  const float half = sqrt(square);
  const Vec<3> normal = (1.0f / flight.radius) * (aside - half * flight.direction);
  offer(flight, -along - half, normalized_or(normal, -flight.direction), best);
}

static void enter_cylinder(const CastFlight& flight, const Vec<3>& span, Entry<3>& best) {
  const float span_length = length(span);
  const Vec<3> axis = (1.0f / span_length) * span;
  const float advance = dot(flight.direction, axis);
  const Vec<3> across = flight.direction - advance * axis;
  const float speed = length(across);
  if (speed <= 1.0e-6f) return;
  const Vec<3> inwards = (1.0f / speed) * across;
  const float height = dot(flight.from, axis);
  const Vec<3> start = flight.from - height * axis;
  const float along = dot(start, inwards);
  const Vec<3> aside = start - along * inwards;
  const float square = flight.radius * flight.radius - dot(aside, aside);
  if (square <= 0.0f || along >= 0.0f) return;
  const float half = sqrt(square);
  const float distance = (-along - half) / speed;
  const float at = height + distance * advance;
  if (at < 0.0f || at > span_length) return;
  const Vec<3> normal = (1.0f / flight.radius) * (aside - half * inwards);
  offer(flight, distance, normalized_or(normal, -inwards), best);
}

/// At most one of both cores is a line, the other a point.
static Entry<3> enter_rod(const Core<3>& core, const Core<3>& probe, const Vec<3>& translation,
                          float way) {
  Entry<3> best{};
  const CastFlight flight{probe.vertices[0] - core.vertices[0], (1.0f / way) * translation, way,
                          core.radius + probe.radius};
  if (flight.radius <= 0.0f) return best;
  Vec<3> span = Vec<3>::zero();
  if (core.count > 1) span = core.vertices[1] - core.vertices[0];
  if (probe.count > 1) span = probe.vertices[0] - probe.vertices[1];
  if (dot(span, span) > 0.0f) {
    enter_cylinder(flight, span, best);
    enter_ball(flight, span, best);
  }
  enter_ball(flight, Vec<3>::zero(), best);
  if (core.count > 1)
    best.point = probe.vertices[0] + best.fraction * translation - probe.radius * best.normal;
  else
    best.point = core.vertices[0] + core.radius * best.normal;
  return best;
}

/// Whether a ray along `way` from the origin passes between the corners, seen from where they run
/// counter-clockwise. Each corner is put onto a plane across the ray once, by itself and as floats,
/// so that the products below are exact in double: all triangles around an edge or a corner then
/// tell of one and the same plane, and no ray slips between them.
/// Source: Woop, Benthin and Wald, "Watertight Ray/Triangle Intersection" (2013).
static bool passes_between(const Vec<3> (&corners)[3], const Vec<3>& way) {
  int z = abs(way[1]) > abs(way[0]) ? 1 : 0;
  if (abs(way[2]) > abs(way[z])) z = 2;
  const int axes[2] = {z < 2 ? z + 1 : 0, z > 0 ? z - 1 : 2};
  Wide flat[3][2];
  for (int k = 0; k < 2; ++k) {
    const Wide lean = Wide{way[axes[k]]} / Wide{way[z]};
    for (int i = 0; i < 3; ++i)
      flat[i][k] = static_cast<float>(Wide{corners[i][axes[k]]} - lean * Wide{corners[i][z]});
  }
  bool has_area = false;
  for (int i = 0; i < 3; ++i) {
    const int j = i < 2 ? i + 1 : 0;
    const Wide turn = flat[i][0] * flat[j][1] - flat[i][1] * flat[j][0];
    if (way[z] > 0.0f ? turn > 0.0 : turn < 0.0) return false;
    has_area = has_area || turn != 0.0;
  }
  return has_area;
}

/// A ray against the free side of a triangle.
static Entry<3> enter_triangle(const Core<3>& core, const Vec<3>& from, const Vec<3>& translation) {
  Entry<3> entry{};
  const Vec<3> corners[3] = {core.vertices[0] - from, core.vertices[1] - from,
                             core.vertices[2] - from};
  const float approach = -dot(core.normals[0], translation);
  const float height = -dot(core.normals[0], corners[0]);
  if (approach <= 0.0f || height < -kTouch || height > approach) return entry;
  if (!passes_between(corners, translation)) return entry;
  entry.hit = true;
  entry.fraction = max(height, 0.0f) / approach;
  entry.normal = core.normals[0];
  entry.point = from + entry.fraction * translation;
  return entry;
}

/// A point and a direction in the frame of a core's faces. That of a hull is its own, so that its
/// normals need not be turned.
struct FaceRay {
  Vec<3> from;
  Vec<3> way;
};

static FaceRay face_ray(const Core<3>& core, const Vec<3>& from, const Vec<3>& way) {
  if (core.kind != ShapeKind::kHull) return {from, way};
  return {rotate_back(core.rotation, from - core.centre), rotate_back(core.rotation, way)};
}

static const Vec<3>& own_normal(const Core<3>& core, std::uint32_t face) {
  return core.kind == ShapeKind::kHull ? core.faces[face].normal : core.normals[face];
}

/// Of the ray's start over the plane of a face.
static float height_of(const Core<3>& core, std::uint32_t face, const FaceRay& ray) {
  if (core.kind == ShapeKind::kHull)
    return dot(core.faces[face].normal, ray.from) - core.faces[face].offset;
  return dot(core.normals[face], ray.from - core.face_corner(face));
}

bool encloses(const Core<3>& core, const Vec<3>& point) {
  if (core.one_sided() || core.face_count == 0) return false;
  const FaceRay ray = face_ray(core, point, Vec<3>::zero());
  for (std::uint32_t f = 0; f < core.face_count; ++f)
    if (height_of(core, f, ray) >= 0.0f) return false;
  return true;
}

/// A ray, clipped by the planes of all faces.
static Entry<3> enter_faces(const Core<3>& core, const Vec<3>& from, const Vec<3>& translation,
                            float way) {
  Entry<3> entry{};
  const FaceRay ray = face_ray(core, from, translation);
  float enters = -3.0e38f;
  float leaves = 3.0e38f;
  std::uint32_t face = 0;
  for (std::uint32_t f = 0; f < core.face_count; ++f) {
    const float height = height_of(core, f, ray);
    const float approach = -dot(own_normal(core, f), ray.way);
    if (abs(approach) <= 1.0e-12f * way) {
      if (height >= 0.0f) return entry;
      continue;
    }
    const float fraction = height / approach;
    if (approach < 0.0f) {
      leaves = min(leaves, fraction);
    } else if (fraction > enters) {
      enters = fraction;
      face = f;
    }
    if (enters >= leaves) return entry;
  }
  if (enters > 1.0f || enters * way < -kTouch) return entry;
  entry.hit = true;
  entry.fraction = max(enters, 0.0f);
  entry.normal = core.face_normal(face);
  entry.point = from + entry.fraction * translation;
  return entry;
}

/// Along the normal of the nearest points, or where rounding has turned that, so that the planes
/// across it do not keep the cores that far apart, along an axis that does better.
static Separation<3> separation_apart(const Core<3>& core, const Core<3>& moved,
                                      const NearestPoints& nearest) {
  Separation<3> result{};
  result.normal = nearest.normal;
  result.distance = nearest.gap - (core.radius + moved.radius);
  if (nearest.gap < nearest.distance) {
    const Separation<3> axis = separation_across(core, moved);
    if (axis.distance > result.distance) result = axis;
  }
  result.point_a = nearest.on_a + core.radius * result.normal;
  return result;
}

/// The separation of cores on a way. After a step cores that touch, or that rounding put a hair
/// into each other, do so in the plane that the step led to, so `normal` stays.
static Separation<3> separation_on_way(const Core<3>& core, const Core<3>& moved, bool stepped,
                                       const Vec<3>& normal) {
  const NearestPoints nearest = nearest_points(core, moved);
  if (!nearest.enclosed && !nearest.touching) return separation_apart(core, moved, nearest);
  Separation<3> result{};
  if (!stepped) {
    result = separation_across(core, moved);
    result.point_a = surface_point(core, moved, result);
    return result;
  }
  result.normal = normal;
  result.distance = -(core.radius + moved.radius);
  const Vec<3> on_core = nearest.enclosed ? touched_point(core, moved, normal, 0.0f) : nearest.on_a;
  result.point_a = on_core + core.radius * normal;
  return result;
}

/// Newton's method on the distance along the way, which is convex: it comes from the outside and
/// does not pass the contact.
static Entry<3> advance(const Core<3>& core, const Core<3>& probe, const Vec<3>& translation) {
  constexpr int kSteps = 48;
  Core<3> moved = probe;
  Entry<3> entry{};
  for (int step = 0; step < kSteps; ++step) {
    const Vec<3> shift = entry.fraction * translation;
    for (std::uint32_t i = 0; i < probe.count; ++i) moved.vertices[i] = probe.vertices[i] + shift;
    const Separation<3> between = separation_on_way(core, moved, step > 0, entry.normal);
    const float approach = -dot(between.normal, translation);
    entry.normal = between.normal;
    entry.point = between.point_a;
    if (approach <= 0.0f) return entry;
    const float left = max(between.distance, 0.0f) / approach;
    if (entry.fraction + left > 1.0f) return entry;
    entry.fraction += left;
    if (between.distance <= kTouch) break;
  }
  entry.hit = allows(core, entry.normal);
  return entry;
}

Entry<3> enter_core(const Core<3>& core, const Core<3>& probe, const Vec<3>& translation) {
  const float way = length(translation);
  if (way <= 1.0e-12f) return Entry<3>{};
  if (core.count + probe.count <= 3) return enter_rod(core, probe, translation, way);
  const bool ray = probe.count == 1 && core.radius + probe.radius <= 0.0f;
  if (!ray || core.face_count == 0) return advance(core, probe, translation);
  if (core.one_sided()) return enter_triangle(core, probe.vertices[0], translation);
  return enter_faces(core, probe.vertices[0], translation, way);
}

}  // namespace cycloid::solver
