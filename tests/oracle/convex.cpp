#include "tests/oracle/convex.hpp"

#include <algorithm>

namespace cycloid::oracle {

/// A face and which corners lie on it.
struct Face {
  Vector normal;
  std::vector<bool> has;
  Vector middle;
};

double Convex::extent() const {
  double farthest = 0.0;
  for (const Vector& corner : corners) farthest = std::max(farthest, length(corner));
  return farthest + radius;
}

static double spread(const std::vector<Vector>& points) {
  double largest = 0.0;
  for (const Vector& point : points) largest = std::max(largest, length(point - points[0]));
  return largest;
}

static bool all_behind(const std::vector<Vector>& points, const Vector& normal, double offset) {
  for (const Vector& point : points)
    if (dot(normal, point) > offset) return false;
  return true;
}

static Face face_of(const std::vector<Vector>& points, const Vector& normal, double offset) {
  Face face{normal, std::vector<bool>(points.size()), {}};
  double count = 0.0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    face.has[i] = dot(normal, points[i]) >= offset;
    if (!face.has[i]) continue;
    face.middle = face.middle + points[i];
    count += 1.0;
  }
  face.middle = (1.0 / count) * face.middle;
  return face;
}

/// Every plane through three points with nothing before it. A plane that is found more than once,
/// or a little askew through three points almost in line, is one more axis to try: it can do no
/// harm.
static std::vector<Face> faces_of(const std::vector<Vector>& points) {
  const double size = spread(points);
  const double flat = 1e-10 * size;
  std::vector<Face> faces;
  const auto add = [&](const Vector& normal, const Vector& at) {
    const double offset = dot(normal, at);
    if (!all_behind(points, normal, offset + flat)) return;
    for (const Face& face : faces)
      if (length(face.normal - normal) < 1e-9) return;
    faces.push_back(face_of(points, normal, offset - flat));
  };
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j)
      for (std::size_t k = j + 1; k < points.size(); ++k) {
        const Vector across = cross(points[j] - points[i], points[k] - points[i]);
        if (length(across) < 1e-12 * size * size) continue;
        add(normalized(across), points[i]);
        add(-normalized(across), points[i]);
      }
  return faces;
}

/// From the edge to the middle of the face.
static Vector wing_of(const Face& face, const Vector& origin, const Vector& direction) {
  const Vector wing = normalized(cross(face.normal, direction));
  return dot(wing, face.middle - origin) < 0.0 ? -wing : wing;
}

/// The edge between two corners, if two faces share them; of more than two that almost coincide,
/// those that enclose the widest angle.
static void add_edge(const std::vector<Vector>& points, const std::vector<Face>& faces,
                     std::size_t i, std::size_t j, std::vector<Edge>& edges) {
  const Face* best[2] = {nullptr, nullptr};
  double widest = 2.0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!faces[f].has[i] || !faces[f].has[j]) continue;
    for (std::size_t g = f + 1; g < faces.size(); ++g) {
      if (!faces[g].has[i] || !faces[g].has[j]) continue;
      const double cosine = dot(faces[f].normal, faces[g].normal);
      if (cosine >= widest) continue;
      widest = cosine;
      best[0] = &faces[f];
      best[1] = &faces[g];
    }
  }
  if (best[0] == nullptr) return;
  const Vector direction = normalized(points[j] - points[i]);
  edges.push_back(
      {points[i],
       direction,
       {wing_of(*best[0], points[i], direction), wing_of(*best[1], points[i], direction)}});
}

Convex hull_of(const std::vector<Vector>& points, double radius) {
  Convex body{points, radius, {}, {}};
  if (points.size() == 2)
    body.edges.push_back({points[0], normalized(points[1] - points[0]), {{}, {}}});
  if (points.size() < 3) return body;
  const std::vector<Face> faces = faces_of(points);
  for (const Face& face : faces) body.normals.push_back(face.normal);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t j = i + 1; j < points.size(); ++j)
      if (length(points[j] - points[i]) > 0.0) add_edge(points, faces, i, j, body.edges);
  return body;
}

Convex box_of(const Vector& half) {
  std::vector<Vector> corners;
  for (int i = 0; i < 8; ++i)
    corners.push_back({(i & 1) != 0 ? half.x : -half.x, (i & 2) != 0 ? half.y : -half.y,
                       (i & 4) != 0 ? half.z : -half.z});
  return hull_of(corners);
}

Convex ball_of(double radius) {
  return hull_of({{0, 0, 0}}, radius);
}

Convex capsule_of(double half_length, double radius) {
  return hull_of({{0, -half_length, 0}, {0, half_length, 0}}, radius);
}

Convex placed(const Convex& body, const Placement& placement) {
  Convex moved = body;
  for (Vector& corner : moved.corners) corner = placement.place(corner);
  for (Vector& normal : moved.normals) normal = placement.turn(normal);
  for (Edge& edge : moved.edges) {
    edge.origin = placement.place(edge.origin);
    edge.direction = placement.turn(edge.direction);
    for (Vector& wing : edge.wings) wing = placement.turn(wing);
  }
  return moved;
}

}  // namespace cycloid::oracle
