#include "tests/oracle/specimens.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

namespace cycloid::oracle {

using solver::ShapeDef;
using solver::ShapeKind;
using solver::Vec;

const char* name_of(Kind kind) {
  static constexpr const char* kNames[kKinds] = {"ball", "capsule",    "box",
                                                 "hull", "half-space", "triangle"};
  return kNames[static_cast<int>(kind)];
}

/// A multiple of an eighth, at least one: sums and halves of such are exact.
static double to_grid(double x) {
  return std::max(0.125, 0.125 * std::round(8.0 * x));
}

/// Half extents of which one is `size` and the others at most 20 times smaller.
static Vector random_half(Random& random, bool regular) {
  const double size = random.log_within(0.05, 5.0);
  double half[3] = {size / random.log_within(1, 20), size / random.log_within(1, 20),
                    size / random.log_within(1, 20)};
  half[random.below(3)] = size;
  if (regular && random.below(3) == 0) return {to_grid(size), to_grid(size), to_grid(size)};
  if (regular) return {to_grid(half[0]), to_grid(half[1]), to_grid(half[2])};
  return {half[0], half[1], half[2]};
}

static Vector stretched(const Vector& v, const Vector& half) {
  return {v.x * half.x, v.y * half.y, v.z * half.z};
}

/// A box, an octahedron, a prism of eight sides or a wedge, about its centre.
static std::vector<Vector> regular_corners(Random& random, const Vector& half) {
  std::vector<Vector> corners;
  const int pick = random.below(3);
  for (int i = 0; i < 8; ++i) {
    const Vector signs = {(i & 1) != 0 ? 1.0 : -1.0, (i & 2) != 0 ? 1.0 : -1.0,
                          (i & 4) != 0 ? 1.0 : -1.0};
    if (pick == 0) corners.push_back(stretched(signs, half));
    if (pick == 1) {
      corners.push_back(stretched({signs.x, signs.y, 0.5 * signs.z}, half));
      corners.push_back(stretched({0.5 * signs.x, signs.y, signs.z}, half));
    }
  }
  for (const double sign : {1.0, -1.0}) {
    if (pick != 2) continue;
    corners.push_back({sign * half.x, 0, 0});
    corners.push_back({0, sign * half.y, 0});
    corners.push_back({0, 0, sign * half.z});
  }
  return corners;
}

static void random_hull_def(Random& random, bool regular, ShapeDef<3>& def) {
  def.kind = ShapeKind::kHull;
  const Vector half = random_half(random, regular);
  std::vector<Vector> corners;
  if (regular) corners = regular_corners(random, half);
  const int count = regular ? 0 : 8 + random.below(25);
  // On an ellipsoid all points are corners; in a box some are.
  const bool round = random.below(2) == 0;
  for (int i = 0; i < count; ++i) {
    const Vector in_box = {random.within(-1, 1), random.within(-1, 1), random.within(-1, 1)};
    corners.push_back(stretched(round ? random.direction() : in_box, half));
  }
  for (const Vector& corner : corners) def.points.push_back(to_float(corner));
}

static void random_triangle(Random& random, bool regular, ShapeDef<3>& def) {
  def.kind = ShapeKind::kMesh;
  const Vector drawn = random_half(random, regular);
  // A world takes no triangle that is lower than a few millimetres.
  const Vector half = {std::max(drawn.x, 0.02), 0.0, std::max(drawn.z, 0.02)};
  const Vector along = 2 * half.x * (regular ? Vector{1, 0, 0} : random.direction());
  const Vector side = 2 * half.z * (regular ? Vector{0, 0, 1} : perpendicular(along));
  const double shear = regular ? 0.125 * random.below(9) : random.within(-0.5, 1.5);
  def.points = {to_float({}), to_float(side + shear * along), to_float(along)};
  if (regular && random.below(2) == 0) std::swap(def.points[1], def.points[2]);
  def.triangles = {{0, 1, 2}};
}

static ShapeDef<3> random_def(Random& random, Kind kind, bool regular) {
  ShapeDef<3> def;
  const Vector half = random_half(random, regular);
  const double largest = std::max({half.x, half.y, half.z});
  const int axis = random.below(3);
  switch (kind) {
    case Kind::kBall:
      def.radius = static_cast<float>(largest);
      break;
    case Kind::kCapsule: {
      def.kind = ShapeKind::kCapsule;
      Vector along = regular ? Vector{axis == 0 ? 1.0 : 0, axis == 1 ? 1.0 : 0, axis == 2 ? 1.0 : 0}
                             : random.direction();
      along = largest * along;
      def.points = {to_float(-along), to_float(along)};
      def.radius = static_cast<float>(std::min({half.x, half.y, half.z}));
      break;
    }
    case Kind::kBox:
      def.kind = ShapeKind::kBox;
      def.half = to_float(half);
      if (!regular) {
        const Placement turn = random.turn();
        const Vec<3> v = to_float(turn.imaginary);
        def.rotation = {{v[0], v[1], v[2], static_cast<float>(turn.real)}};
        def.points = {to_float(random.within(0, 1) * random.direction())};
      }
      break;
    case Kind::kHull:
      random_hull_def(random, regular, def);
      break;
    case Kind::kHalfSpace:
      def.kind = ShapeKind::kHalfSpace;
      def.normal = to_float(regular ? Vector{0, axis == 0 ? -1.0 : 1.0, 0} : random.direction());
      def.offset = static_cast<float>(regular ? 0.125 * random.below(9) : random.within(-1, 1));
      break;
    case Kind::kTriangle:
      random_triangle(random, regular, def);
      break;
  }
  return def;
}

/// What the oracle makes of a definition, in the body frame.
static Convex convex_of(const ShapeDef<3>& def) {
  if (def.kind == ShapeKind::kBox) {
    const Vector imaginary = {def.rotation[0], def.rotation[1], def.rotation[2]};
    const double real = def.rotation[3];
    const double scale = 1.0 / std::sqrt(dot(imaginary, imaginary) + real * real);
    const Vector centre = def.points.empty() ? Vector{} : to_double(def.points[0]);
    return placed(box_of(to_double(def.half)), {centre, scale * imaginary, scale * real});
  }
  if (def.kind == ShapeKind::kHalfSpace)
    return hull_of({static_cast<double>(def.offset) * to_double(def.normal)});
  std::vector<Vector> corners;
  for (const Vec<3>& point : def.points) corners.push_back(to_double(point));
  if (corners.empty()) corners.push_back({});
  return hull_of(corners, def.radius);
}

static void add_specimen(Random& random, Kind kind, bool regular, Collection& collection) {
  Specimen specimen;
  specimen.kind = kind;
  specimen.def = random_def(random, kind, regular);
  solver::BodyDef<3> body;
  if (is_fixed(kind)) body.kind = solver::BodyKind::kStatic;
  const auto id = collection.world.create_body(body, std::span(&specimen.def, 1));
  if (!id.ok()) {
    collection.refused.push_back(std::string(name_of(kind)) + ": " + id.error().field);
    return;
  }
  const solver::Body<3>& made = collection.world.state().bodies[id.value().index];
  specimen.shape = collection.world.state().shapes[made.first_shape];
  const Vector centre = to_double(made.local_center);
  specimen.body = placed(convex_of(specimen.def), {-centre, {}, 1.0});
  if (kind == Kind::kHalfSpace) specimen.normal = normalized(to_double(specimen.def.normal));
  if (kind == Kind::kTriangle) {
    const std::vector<Vector>& corners = specimen.body.corners;
    specimen.normal = normalized(cross(corners[1] - corners[0], corners[2] - corners[0]));
  }
  if (kind != Kind::kHalfSpace) specimen.size = specimen.body.extent();
  collection.specimens[static_cast<int>(kind)].push_back(specimen);
}

Collection make_collection(Random& random, int count, bool regular) {
  Collection collection{std::move(solver::World<3>::create({}).value()), {}, {}};
  for (int kind = 0; kind < kKinds; ++kind)
    for (int i = 0; i < count; ++i)
      add_specimen(random, static_cast<Kind>(kind), regular, collection);
  return collection;
}

static void print(std::ostream& out, const Vec<3>& v) {
  out << "{{" << v[0] << ", " << v[1] << ", " << v[2] << "}}";
}

std::string describe(const Specimen& specimen) {
  std::ostringstream out;
  out.precision(9);
  const ShapeDef<3>& def = specimen.def;
  out << name_of(specimen.kind) << " points {";
  for (const Vec<3>& point : def.points) print(out, point);
  out << "} radius " << def.radius << " half ";
  print(out, def.half);
  out << " rotation {{" << def.rotation[0] << ", " << def.rotation[1] << ", " << def.rotation[2]
      << ", " << def.rotation[3] << "}} normal ";
  print(out, def.normal);
  out << " offset " << def.offset;
  return out.str();
}

std::string describe(const solver::Pose<3>& pose) {
  std::ostringstream out;
  out.precision(9);
  out << "position ";
  print(out, pose.position);
  out << " rotation {{" << pose.rotation[0] << ", " << pose.rotation[1] << ", " << pose.rotation[2]
      << ", " << pose.rotation[3] << "}}";
  return out.str();
}

}  // namespace cycloid::oracle
