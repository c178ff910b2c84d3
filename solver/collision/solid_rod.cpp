#include "solver/collision/rod.hpp"

namespace cycloid::solver {

/// How high the lower and the upper end of the rod's axis are over each face, m; the least they are
/// apart along a face's normal or across an edge and the rod.
struct Survey {
  std::array<float, kHullFacesMax> low;
  std::array<float, kHullFacesMax> high;
  std::uint32_t face = 0;
  float face_separation = -3.0e38f;
  std::uint32_t edge = kNone;
  float edge_separation = -3.0e38f;
  Vec<3> edge_normal;  ///< From the solid to the rod.
};

/// False where a face separates by more than `reach`.
static bool survey_faces(const Solid& solid, const Rod& rod, float reach, Survey& survey) {
  for (std::uint32_t f = 0; f < solid.face_count; ++f) {
    const Vec<3> on_face = solid.vertices[solid.edges[solid.faces[f].edge].origin];
    const float from = dot(solid.normals[f], rod.from - on_face);
    const float to = dot(solid.normals[f], rod.to - on_face);
    survey.low[f] = min(from, to);
    survey.high[f] = max(from, to);
    if (survey.low[f] > reach) return false;
    if (survey.low[f] > survey.face_separation) {
      survey.face_separation = survey.low[f];
      survey.face = f;
    }
  }
  return true;
}

/// Axes across an edge and the rod, of which only those count that the edge's faces lie on either
/// side of: the others are no face of the Minkowski sum. False where one separates by more than
/// `reach`. An axis of an edge within 0.003 rad of the rod's direction would be rounding; the faces
/// stand in for it.
/// Source: Gregorius, "The Separating Axis Test between Convex Polyhedra" (GDC 2013).
static bool survey_edges(const Solid& solid, const Rod& rod, float reach, Survey& survey) {
  const Vec<3> along = rod.to - rod.from;
  const float square = dot(along, along);
  if (!(square > 0.0f)) return true;
  const Vec<3> middle = rod.from + 0.5f * along;
  for (std::uint32_t e = 0; e < solid.edge_count; e += 2) {
    const PolyhedronEdge& half = solid.edges[e];
    const PolyhedronEdge& twin = solid.edges[e + 1];
    const float turn = dot(solid.normals[half.face], along);
    if (turn * dot(solid.normals[twin.face], along) >= 0.0f) continue;
    const Vec<3> origin = solid.vertices[half.origin];
    const Vec<3> edge = solid.vertices[twin.origin] - origin;
    // The left face lies on the inner side of cross(rod, edge) where it turns towards the rod.
    const Vec<3> axis = turn > 0.0f ? cross(edge, along) : cross(along, edge);
    const float size = dot(axis, axis);
    if (size < 1.0e-5f * square * dot(edge, edge)) continue;
    const float separation = dot(axis, middle - origin) / sqrt(size);
    if (separation > reach) return false;
    if (separation > survey.edge_separation) {
      survey.edge_separation = separation;
      survey.edge = e;
      survey.edge_normal = (1.0f / sqrt(size)) * axis;
    }
  }
  return true;
}

/// The nearest points of the rod's axis and a solid that it stays outside of.
struct NearestOnSolid {
  float distance = 3.0e38f;
  std::uint32_t face = kNone;  ///< Over whose inside an end of the rod lies; or else
  std::uint32_t edge = kNone;
  SegmentPair pair;  ///< Of the edge.
};

/// Whether the lower end of the rod lies over the inside of a face, in front of it.
static bool end_over(const Solid& solid, std::uint32_t face, const Rod& rod, const Survey& survey) {
  if (survey.low[face] <= 0.0f) return false;
  const float rise = dot(solid.normals[face], rod.to - rod.from);
  const Rod from = {rod.from, rod.from, 0.0f};
  const Rod to = {rod.to, rod.to, 0.0f};
  return (rise >= 0.0f && clip_to_face(solid, face, from, 0.0f).to > 0.0f) ||
         (rise <= 0.0f && clip_to_face(solid, face, to, 0.0f).to > 0.0f);
}

static NearestOnSolid nearest_outside(const Solid& solid, const Rod& rod, const Survey& survey) {
  NearestOnSolid nearest;
  // No two points can be nearer than along a separating axis.
  if (end_over(solid, survey.face, rod, survey)) {
    nearest.distance = survey.face_separation;
    nearest.face = survey.face;
    return nearest;
  }
  for (std::uint32_t f = 0; f < solid.face_count; ++f) {
    if (survey.low[f] >= nearest.distance || !end_over(solid, f, rod, survey)) continue;
    nearest.distance = survey.low[f];
    nearest.face = f;
  }
  // What is nearest to a point outside lies on a face that sees it, and so does an end of the rod.
  for (std::uint32_t e = 0; e < solid.edge_count; e += 2) {
    const std::uint32_t left = solid.edges[e].face;
    const std::uint32_t right = solid.edges[e + 1].face;
    if (survey.high[left] <= 0.0f && survey.high[right] <= 0.0f) continue;
    if (max(survey.low[left], survey.low[right]) >= nearest.distance) continue;
    const SegmentPair pair = nearest_to_edge(solid, e, rod);
    if (pair.distance >= nearest.distance) continue;
    nearest.distance = pair.distance;
    nearest.face = kNone;
    nearest.edge = e;
    nearest.pair = pair;
  }
  return nearest;
}

/// Of the faces that meet at the nearest point the one that looks most along `normal`.
static std::uint32_t face_along(const Solid& solid, const NearestOnSolid& nearest,
                                const Vec<3>& normal) {
  std::uint32_t best = solid.edges[nearest.edge].face;
  const std::uint32_t right = solid.edges[nearest.edge + 1].face;
  if (dot(solid.normals[right], normal) > dot(solid.normals[best], normal)) best = right;
  const float fraction = nearest.pair.fraction_a;
  if (fraction > 0.0f && fraction < 1.0f) return best;
  // At a corner: of all faces, since the one that looks along it is one of the corner's.
  for (std::uint32_t f = 0; f < solid.face_count; ++f)
    if (dot(solid.normals[f], normal) > dot(solid.normals[best], normal)) best = f;
  return best;
}

static float lowest(const Solid& solid, std::uint32_t face, const Rod& rod, const Span& span) {
  const Vec<3> on_face = solid.vertices[solid.edges[solid.faces[face].edge].origin];
  return min(dot(solid.normals[face], point_on(rod, span.from) - on_face),
             dot(solid.normals[face], point_on(rod, span.to) - on_face));
}

static Manifold<3> outside(const Solid& solid, const Rod& rod, const NearestOnSolid& nearest,
                           float margin) {
  Manifold<3> manifold;
  const float slack = rounding_of(solid, rod);
  if (nearest.face != kNone) {
    manifold.normal = solid.normals[nearest.face];
    const Span span = clip_to_face(solid, nearest.face, rod, slack);
    add_span(solid, nearest.face, rod, span, margin, manifold);
    return manifold;
  }
  const Vec<3> normal = normal_between(edge_rod(solid, nearest.edge), rod, nearest.pair);
  const std::uint32_t face = face_along(solid, nearest, normal);
  const Span span = clip_to_face(solid, face, rod, slack);
  // A rod that lies on a face and sticks out over its edge is nearest to the edge, by a rounding.
  if (span.from <= span.to && dot(normal, solid.normals[face]) > kLiesFlat &&
      lowest(solid, face, rod, span) <= nearest.distance + 1.0e-4f * rod.radius + slack) {
    manifold.normal = solid.normals[face];
    add_span(solid, face, rod, span, margin, manifold);
    if (manifold.point_count > 0) return manifold;
  }
  manifold.normal = normal;
  add_edge_points(solid, nearest.edge, rod, nearest.pair, margin, manifold);
  return manifold;
}

/// The way out of an axis inside the solid is the shallowest of the axes.
static Manifold<3> inside(const Solid& solid, const Rod& rod, const Survey& survey, float margin) {
  Manifold<3> manifold;
  const float slack = rounding_of(solid, rod);
  if (survey.edge != kNone && survey.edge_separation > survey.face_separation + 2.0f * slack) {
    manifold.normal = survey.edge_normal;
    const SegmentPair pair = nearest_to_edge(solid, survey.edge, rod);
    const float separation = survey.edge_separation - rod.radius;
    add_point(pair.on_b - (rod.radius + 0.5f * separation) * manifold.normal, separation,
              edge_feature(survey.edge), manifold);
    return manifold;
  }
  manifold.normal = solid.normals[survey.face];
  // The lowest end lies over the face, but for what the two kinds of axes differ by: where it does
  // not, the way out is across the border, where the clipped rod is about as deep.
  Span span = clip_to_face(solid, survey.face, rod, slack);
  if (span.from > span.to) span = {0.0f, 1.0f};
  add_span(solid, survey.face, rod, span, margin, manifold);
  return manifold;
}

Manifold<3> solid_against_rod(const Solid& solid, const Rod& rod, float margin) {
  const float reach = rod.radius + margin;
  Survey survey;
  if (!survey_faces(solid, rod, reach, survey)) return {};
  if (!survey_edges(solid, rod, reach, survey)) return {};
  const float slack = rounding_of(solid, rod);
  if (max(survey.face_separation, survey.edge_separation) > slack) {
    const NearestOnSolid nearest = nearest_outside(solid, rod, survey);
    if (nearest.distance > reach) return {};
    if (nearest.distance > slack) return outside(solid, rod, nearest, margin);
  }
  return inside(solid, rod, survey, margin);
}

}  // namespace cycloid::solver
