#include "solver/mass.hpp"

#include <Eigen/LU>

#include "solver/direct/wide.hpp"
#include "solver/shapes.hpp"
#include "solver/solids/polyhedron_mass.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

/// m (|r|^2 1 - r r^T): the second moment of a point of mass m at r (in the plane: m |r|^2).
static Inertia<2> point_inertia(float mass, const Vec<2>& r) {
  return {{mass * dot(r, r)}};
}
static Inertia<3> point_inertia(float mass, const Vec<3>& r) {
  Inertia<3> inertia;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      inertia.m[i * 3 + j] = mass * ((i == j ? dot(r, r) : 0.0f) - r[i] * r[j]);
  return inertia;
}

template <int D>
static void add_to(Inertia<D>& into, const Inertia<D>& other, float scale) {
  for (int i = 0; i < Dim<D>::kSpin * Dim<D>::kSpin; ++i) into.m[i] += scale * other.m[i];
}

/// A part of mass m with its centre at c and the moment `about_centre`.
template <int D>
static void add_part(float mass, const Vec<D>& centre, const Inertia<D>& about_centre,
                     MassProperties<D>& into) {
  into.mass += mass;
  into.first += mass * centre;
  add_to(into.second, about_centre, 1.0f);
  add_to(into.second, point_inertia(mass, centre), 1.0f);
}

static Inertia<2> ball_inertia(float mass, float r, const Vec<2>&) {
  return {{0.5f * mass * r * r}};
}
static Inertia<3> ball_inertia(float mass, float r, const Vec<3>&) {
  const float i = 0.4f * mass * r * r;
  return {{i, 0.0f, 0.0f, 0.0f, i, 0.0f, 0.0f, 0.0f, i}};
}
static float ball_volume(float r, const Vec<2>&) {
  return kPi * r * r;
}
static float ball_volume(float r, const Vec<3>&) {
  return 4.0f / 3.0f * kPi * r * r * r;
}

/// The polygon of the vertices alone, as triangles from vertex 0.
static void add_core(const Shape<2>& shape, float density, MassProperties<2>& into) {
  const Vec<2> origin = shape.vertices[0];
  for (std::uint32_t i = 1; i + 1 < shape.vertex_count; ++i) {
    const Vec<2> a = shape.vertices[i] - origin;
    const Vec<2> b = shape.vertices[i + 1] - origin;
    const float mass = 0.5f * density * cross(a, b);
    const Vec<2> centre = (1.0f / 3.0f) * (a + b);
    const float about_corner = mass / 6.0f * (dot(a, a) + dot(a, b) + dot(b, b));
    add_part(mass, origin + centre, {{about_corner - mass * dot(centre, centre)}}, into);
  }
}

/// The rounding: a rectangle on every edge and a sector of a disc at every vertex.
static void add_rounding(const Shape<2>& shape, float density, MassProperties<2>& into) {
  const float r = shape.radius;
  for (std::uint32_t i = 0; i < shape.vertex_count; ++i) {
    const std::uint32_t next = i + 1 < shape.vertex_count ? i + 1 : 0;
    const std::uint32_t before = i > 0 ? i - 1 : shape.vertex_count - 1;
    const Vec<2> p = shape.vertices[i];
    const Vec<2> n = shape.normals[i];
    const Vec<2> edge = shape.vertices[next] - p;
    const float edge_length = length(edge);
    const float rectangle = density * edge_length * r;
    add_part(rectangle, p + 0.5f * edge + (0.5f * r) * n,
             {{rectangle / 12.0f * (edge_length * edge_length + r * r)}}, into);

    const Vec<2> n_before = shape.normals[before];
    float angle = atan2(cross(n_before, n), dot(n_before, n));
    if (angle <= 0.0f) angle += 2.0f * kPi;  // The end of a capsule turns by pi.
    const float sector = 0.5f * density * r * r * angle;
    float sine = 0.0f;
    float cosine = 0.0f;
    sin_cos(0.5f * angle, sine, cosine);
    const float reach = 4.0f * r * sine / (3.0f * angle);
    const Vec<2> middle = rotate(Vec<2>{{cosine, sine}}, n_before);
    const float about_centre = 0.5f * sector * r * r - sector * reach * reach;
    add_part(sector, p + reach * middle, {{about_centre}}, into);
  }
}

static void add_hull(const Shape<2>& shape, const Polyhedra&, float density,
                     MassProperties<2>& into) {
  add_core(shape, density, into);
  if (shape.radius > 0.0f) add_rounding(shape, density, into);
}

/// The moment of a body that is round about axis 1 of `rotation`, in the body frame.
static Inertia<3> round_inertia(float along, float across, const Vec<3>& axis) {
  Inertia<3> inertia;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      inertia.m[i * 3 + j] = (i == j ? across : 0.0f) + (along - across) * axis[i] * axis[j];
  return inertia;
}

/// A cylinder and, at either end, half a ball, whose centre of mass lies 3/8 r beyond the end.
static void add_capsule(const Shape<3>& shape, float density, MassProperties<3>& into) {
  const float r = shape.radius;
  const Vec<3> span = shape.vertices[1] - shape.vertices[0];
  const float height = length(span);
  const Vec<3> axis = (1.0f / height) * span;
  const float cylinder = density * kPi * r * r * height;
  const float square = r * r;
  add_part(cylinder, shape.vertices[0] + 0.5f * span,
           round_inertia(0.5f * cylinder * square,
                         cylinder * (0.25f * square + height * height / 12.0f), axis),
           into);
  const float cap = density * 2.0f / 3.0f * kPi * r * square;
  const Inertia<3> of_cap = round_inertia(0.4f * cap * square, 83.0f / 320.0f * cap * square, axis);
  add_part(cap, shape.vertices[0] - (0.375f * r) * axis, of_cap, into);
  add_part(cap, shape.vertices[1] + (0.375f * r) * axis, of_cap, into);
}

static void add_box(const Shape<3>& shape, float density, MassProperties<3>& into) {
  const Vec<3> h = shape.half;
  const float mass = density * 8.0f * h[0] * h[1] * h[2];
  const float third = mass / 3.0f;
  const Inertia<3> own = {{third * (h[1] * h[1] + h[2] * h[2]), 0.0f, 0.0f, 0.0f,
                           third * (h[2] * h[2] + h[0] * h[0]), 0.0f, 0.0f, 0.0f,
                           third * (h[0] * h[0] + h[1] * h[1])}};
  add_part(mass, shape.vertices[0], world_inertia(own, shape.rotation), into);
}

template <int D>
Inertia<D> central_inertia(const MassProperties<D>& properties) {
  const Vec<D> centre = (1.0f / properties.mass) * properties.first;
  Inertia<D> inertia = properties.second;
  add_to(inertia, point_inertia(properties.mass, centre), -1.0f);
  return inertia;
}

static void add_polyhedron(const Shape<3>& shape, const PolyhedronView& hull, float density,
                           MassProperties<3>& into) {
  const MassProperties<3> own = mass_of(hull, density);
  if (!(own.mass > 0.0f)) return;
  const Vec<3> centre = rotate(shape.rotation, (1.0f / own.mass) * own.first);
  add_part(own.mass, shape.vertices[0] + centre,
           world_inertia(central_inertia(own), shape.rotation), into);
}

static void add_hull(const Shape<3>& shape, const Polyhedra& hulls, float density,
                     MassProperties<3>& into) {
  if (shape.kind == ShapeKind::kHull)
    add_polyhedron(shape, view_of(hulls, shape.polyhedron), density, into);
  if (shape.kind == ShapeKind::kCapsule) add_capsule(shape, density, into);
  if (shape.kind == ShapeKind::kBox) add_box(shape, density, into);
}

template <int D>
void add_mass(const Shape<D>& shape, const Polyhedra& hulls, float density,
              MassProperties<D>& into) {
  if (shape.kind == ShapeKind::kBall) {
    const Vec<D> centre = shape.vertices[0];
    const float mass = density * ball_volume(shape.radius, centre);
    add_part(mass, centre, ball_inertia(mass, shape.radius, centre), into);
  } else if (shape.kind != ShapeKind::kHalfSpace && shape.kind != ShapeKind::kSegment) {
    add_hull(shape, hulls, density, into);
  }
}

template <int D>
void add_mass(const Shape<D>& shape, float density, MassProperties<D>& into) {
  add_mass(shape, Polyhedra{}, density, into);
}

/// About a point of the body frame instead of its origin.
template <int D>
static MassProperties<D> mass_about(const Vec<D>& point, std::span<const Shape<D>> shapes,
                                    std::span<const float> densities, const Polyhedra& hulls) {
  MassProperties<D> properties;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    Shape<D> shape = shapes[i];
    shift_shape(point, shape);
    add_mass(shape, hulls, densities[i], properties);
  }
  return properties;
}

template <int D>
static CentralMass<D> central(const MassProperties<D>& properties) {
  return {properties.mass, (1.0f / properties.mass) * properties.first,
          central_inertia(properties)};
}

/// Whether the moment about the origin is so much greater than that about the centre that little of
/// that is left in it.
template <int D>
static bool is_drowned(const CentralMass<D>& of) {
  constexpr float kMuch = 100.0f;
  constexpr int kSpin = Dim<D>::kSpin;
  float least = of.inertia.m[0];
  for (int i = 1; i < kSpin; ++i) least = min(least, of.inertia.m[i * kSpin + i]);
  return !(of.mass * dot(of.centre, of.centre) <= kMuch * least);
}

template <int D>
CentralMass<D> central_mass(std::span<const Shape<D>> shapes, std::span<const float> densities,
                            const Polyhedra& hulls) {
  const MassProperties<D> about_origin = mass_about(Vec<D>::zero(), shapes, densities, hulls);
  if (!(about_origin.mass > 0.0f)) return {};
  const CentralMass<D> found = central(about_origin);
  if (!is_drowned(found)) return found;
  const MassProperties<D> about_centre = mass_about(found.centre, shapes, densities, hulls);
  if (!(about_centre.mass > 0.0f)) return found;
  CentralMass<D> moved = central(about_centre);
  moved.centre += found.centre;
  return moved;
}

Inertia<3> thickened(const Inertia<3>& inertia) {
  constexpr Wide kThinnest = 1.0e-5;
  const auto at = [&](int i, int j) { return static_cast<Wide>(inertia.m[i * 3 + j]); };
  const auto minor = [&](int i, int j) { return at(i, i) * at(j, j) - at(i, j) * at(j, i); };
  const Wide trace = at(0, 0) + at(1, 1) + at(2, 2);
  const Wide minors = minor(0, 1) + minor(1, 2) + minor(2, 0);
  const Wide determinant = at(0, 0) * minor(1, 2) -
                           at(0, 1) * (at(1, 0) * at(2, 2) - at(1, 2) * at(2, 0)) +
                           at(0, 2) * (at(1, 0) * at(2, 1) - at(1, 1) * at(2, 0));
  // Where one is small, the others are half the trace each, and it is determinant / minors.
  const Wide least = 0.5 * kThinnest * trace;
  if (!(determinant < least * minors)) return inertia;
  const auto missing = static_cast<float>(least - determinant / minors);
  Inertia<3> thicker = inertia;
  for (int i = 0; i < 3; ++i) thicker.m[4 * i] += missing;
  return thicker;
}

/// Brings the largest moment to between 1/2 and 1 without rounding, so that a determinant, its
/// third power, neither underflows nor overflows.
static float scale_to_one(const Inertia<3>& inertia) {
  float largest = 0.0f;
  for (const float moment : inertia.m) largest = max(largest, abs(moment));
  if (!(largest >= 1.0e-30f && largest <= 1.0e30f)) return 1.0f;
  float scale = 1.0f;
  while (largest * scale >= 1.0f) scale *= 0.5f;
  while (largest * scale < 0.5f) scale *= 2.0f;
  return scale;
}

Inertia<3> inverse(const Inertia<3>& inertia) {
  const float scale = scale_to_one(inertia);
  const Eigen::Matrix3f matrix = scale * Eigen::Map<const Eigen::Matrix3f>(inertia.m);
  const bool is_positive = matrix(0, 0) > 0.0f &&
                           matrix(0, 0) * matrix(1, 1) - matrix(0, 1) * matrix(1, 0) > 0.0f &&
                           matrix.determinant() > 0.0f;
  Inertia<3> result{};
  if (is_positive) Eigen::Map<Eigen::Matrix3f>(result.m) = scale * matrix.inverse();
  return result;
}

template void add_mass(const Shape<2>&, const Polyhedra&, float, MassProperties<2>&);
template void add_mass(const Shape<3>&, const Polyhedra&, float, MassProperties<3>&);
template void add_mass(const Shape<2>&, float, MassProperties<2>&);
template void add_mass(const Shape<3>&, float, MassProperties<3>&);
template CentralMass<2> central_mass(std::span<const Shape<2>>, std::span<const float>,
                                     const Polyhedra&);
template CentralMass<3> central_mass(std::span<const Shape<3>>, std::span<const float>,
                                     const Polyhedra&);
template Inertia<2> central_inertia(const MassProperties<2>&);
template Inertia<3> central_inertia(const MassProperties<3>&);

}  // namespace cycloid::solver
