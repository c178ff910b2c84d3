#include <gtest/gtest.h>

#include "solver/mass.hpp"
#include "solver/shapes.hpp"
#include "tests/solver/hull_fixture.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

/// Volume, centre and second moment about the centre, computed in double.
struct Exact {
  double volume = 0.0;
  double centre[3] = {};
  double inertia[9] = {};
};

static MassProperties<3> mass_of_shapes(const std::vector<ShapeDef<3>>& defs, float density) {
  std::vector<Shape<3>> shapes;
  Polyhedra hulls;
  for (const ShapeDef<3>& def : defs) EXPECT_TRUE(append_shapes(def, 0, shapes, hulls).ok());
  MassProperties<3> properties;
  for (const Shape<3>& shape : shapes) add_mass(shape, hulls, density, properties);
  return properties;
}

static void expect_moments(const MassProperties<3>& properties, double mass, const Vec<3>& centre,
                           const Vec<3>& moments) {
  EXPECT_NEAR(properties.mass / mass, 1.0, 1e-5);
  const double size = std::sqrt(double{moments[0]} / mass);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(properties.first[i] / properties.mass, centre[i], 1e-5 * size);
  const Inertia<3> inertia = central_inertia(properties);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      EXPECT_NEAR(inertia.m[i * 3 + j], i == j ? moments[i] : 0.0f, 1e-5f * moments[i])
          << i << " " << j;
}

/// A ball beside a body's origin: 2/5 m r^2 in space, 1/2 m r^2 in the plane.
template <int D>
static void expect_moment_of_ball(const Vec<D>& place, float radius) {
  World<D> world = make_world<D>();
  ShapeDef<D> shape = ball<D>(radius);
  shape.density = 1000.0f;
  shape.points = {place};
  const BodyId id = add_at<D>(world, Vec<D>::zero(), shape);
  const Body<D>& body = world.state().bodies[id.index];
  const float moment = (Dim<D>::kSpin == 1 ? 0.5f : 0.4f) * body.mass * radius * radius;
  const float slack = 1.0e-3f;
  for (int i = 0; i < Dim<D>::kSpin; ++i)
    for (int j = 0; j < Dim<D>::kSpin; ++j)
      EXPECT_NEAR(body.inverse_inertia.m[i * Dim<D>::kSpin + j] * moment, i == j ? 1.0f : 0.0f,
                  slack)
          << "at " << place[0] << ", radius " << radius;
  for (int i = 0; i < D; ++i)
    EXPECT_NEAR(body.local_center[i], place[i], 1.0e-4f * radius + 1e-7f * length(place));
}

TEST(MassOfBody, IsExactHoweverFarItsShapesLieFromItsOrigin) {
  for (const float far : {0.0f, 1.0f, 10.0f, 50.0f, 200.0f, 1000.0f})
    for (const float radius : {0.05f, 0.5f}) {
      expect_moment_of_ball<2>({{far, -0.7f * far}}, radius);
      expect_moment_of_ball<3>({{far, -0.7f * far, 0.3f * far}}, radius);
    }
}

TEST(MassOfBody, IsSpreadOverShapesOfAnySizeWhereItIsStated) {
  for (const float radius : {1.0e-4f, 5.0e-4f, 1.0f}) {
    World<3> world = make_world<3>();
    BodyDef<3> def;
    def.mass = 0.001f;
    ShapeDef<3> shape = ball<3>(radius);
    shape.points = {{{0.5f, 0.0f, 0.0f}}};
    const Body<3>& body = world.state().bodies[add<3>(world, def, shape).index];
    EXPECT_NEAR(body.inverse_inertia.m[0] * 0.4f * 0.001f * radius * radius, 1.0f, 1.0e-3f)
        << radius;
    EXPECT_NEAR(body.local_center[0], 0.5f, 1.0e-6f);
  }
}

TEST(MassOfBody, HasNoInverseWhereAMomentIsNotPositive) {
  EXPECT_EQ(inverse(Inertia<3>{{1, 0, 0, 0, -1, 0, 0, 0, -1}}).m[0], 0.0f) << "its determinant is";
  EXPECT_EQ(inverse(Inertia<3>{{-1, 0, 0, 0, 1, 0, 0, 0, -1}}).m[4], 0.0f);
  EXPECT_EQ(inverse(Inertia<3>{{2, 0, 0, 0, 4, 0, 0, 0, 8}}).m[4], 0.25f);
}

TEST(ThickenedInertia, RaisesTheLeastMomentAndOnlyWhereItDrowns) {
  const Inertia<3> thick = {{1, 0, 0, 0, 1, 0, 0, 0, 3.0e-5f}};
  const Inertia<3> same = thickened(thick);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(same.m[i], thick.m[i]);
  EXPECT_NEAR(thickened(Inertia<3>{{1, 0, 0, 0, 1, 0, 0, 0, 1.0e-8f}}).m[8], 1.0e-5f, 1.0e-7f);
  // Across the first two axes: what little there is about the rod is lost in the others' digits.
  const Inertia<3> slanted = thickened(Inertia<3>{{0.5f, -0.5f, 0, -0.5f, 0.5f, 0, 0, 0, 1}});
  EXPECT_NEAR(slanted.m[0] + slanted.m[1], 1.0e-5f, 1.0e-6f);
  EXPECT_GT(inverse(slanted).m[0], 0.0f);
}

TEST(MassOfHull, IsThatOfTheBox) {
  const float x = 0.5f, y = 0.2f, z = 0.9f;
  const float mass = 3.0f * 8.0f * x * y * z;
  const Vec<3> moments = {{mass / 3.0f * (y * y + z * z), mass / 3.0f * (z * z + x * x),
                           mass / 3.0f * (x * x + y * y)}};
  expect_moments(mass_of_shapes({hull_def(box_points(x, y, z))}, 3.0f), mass, Vec<3>::zero(),
                 moments);
  ShapeDef<3> box;
  box.kind = ShapeKind::kBox;
  box.half = {{x, y, z}};
  expect_moments(mass_of_shapes({box}, 3.0f), mass, Vec<3>::zero(), moments);
}

/// Of edge a: V = a^3 / (6 sqrt 2), I = m a^2 / 20.
TEST(MassOfHull, IsThatOfTheRegularTetrahedron) {
  const Points points = {{{1, 1, 1}}, {{1, -1, -1}}, {{-1, 1, -1}}, {{-1, -1, 1}}};
  const double a = std::sqrt(8.0);
  const double mass = 2.0 * a * a * a / (6.0 * std::sqrt(2.0));
  const auto moment = static_cast<float>(mass * a * a / 20.0);
  expect_moments(mass_of_shapes({hull_def(points)}, 2.0f), mass, Vec<3>::zero(),
                 {{moment, moment, moment}});
}

/// With legs along the axes the centre is at a quarter and I_xx = 3 m (b^2 + c^2) / 80.
TEST(MassOfHull, IsThatOfACornerCutOffABox) {
  const float a = 1.0f, b = 2.0f, c = 0.5f;
  const MassProperties<3> properties =
      mass_of_shapes({hull_def({{{0, 0, 0}}, {{a, 0, 0}}, {{0, b, 0}}, {{0, 0, c}}})}, 1.0f);
  const float mass = a * b * c / 6.0f;
  EXPECT_NEAR(properties.mass, mass, 1e-5f * mass);
  EXPECT_NEAR(properties.first[0] / mass, 0.25f * a, 1e-5f);
  EXPECT_NEAR(properties.first[1] / mass, 0.25f * b, 1e-5f);
  EXPECT_NEAR(properties.first[2] / mass, 0.25f * c, 1e-5f);
  const Inertia<3> inertia = central_inertia(properties);
  EXPECT_NEAR(inertia.m[0], 3.0f * mass * (b * b + c * c) / 80.0f, 1e-5f * mass);
  EXPECT_NEAR(inertia.m[4], 3.0f * mass * (a * a + c * c) / 80.0f, 1e-5f * mass);
  EXPECT_NEAR(inertia.m[8], 3.0f * mass * (a * a + b * b) / 80.0f, 1e-5f * mass);
  // Products: -integral of x y = m a b / 16 - m a b / 20.
  EXPECT_NEAR(inertia.m[1], mass * a * b / 80.0f, 1e-5f * mass);
  EXPECT_NEAR(inertia.m[5], mass * b * c / 80.0f, 1e-5f * mass);
  EXPECT_EQ(inertia.m[1], inertia.m[3]);
}

/// Octahedron with corners at r: V = 4 r^3 / 3, I = m r^2 / 5. Icosahedron of edge a, with g the
/// golden ratio: V = 5 (3 + sqrt 5) a^3 / 12, I = m a^2 g^2 / 10.
TEST(MassOfHull, IsThatOfOctahedronAndIcosahedron) {
  const double r = 0.7f;
  double mass = 4.0 / 3.0 * r * r * r;
  auto moment = static_cast<float>(mass * r * r / 5.0);
  expect_moments(mass_of_shapes({hull_def(octahedron_points(0.7f))}, 1.0f), mass, Vec<3>::zero(),
                 {{moment, moment, moment}});
  const double a = 2.0 * double{0.3f};
  const double g = 0.5 * (1.0 + std::sqrt(5.0));
  mass = 5.0 * (3.0 + std::sqrt(5.0)) * a * a * a / 12.0;
  moment = static_cast<float>(mass * a * a * g * g / 10.0);
  expect_moments(mass_of_shapes({hull_def(icosahedron_points(0.3f))}, 1.0f), mass, Vec<3>::zero(),
                 {{moment, moment, moment}});
}

/// Of n sides with circumradius r: area n/2 r^2 sin(2 pi / n); about its axis
/// m r^2 / 6 (2 + cos(2 pi / n)), across half of that and m h^2 / 3.
TEST(MassOfHull, IsThatOfRegularPrisms) {
  for (const int n : {3, 5, 6, 20}) {
    const double r = 0.5, h = 0.8f;
    const double mass = n * r * r * std::sin(2.0 * M_PI / n) * h;
    const double along = mass * r * r / 6.0 * (2.0 + std::cos(2.0 * M_PI / n));
    const auto across = static_cast<float>(0.5 * along + mass * h * h / 3.0);
    expect_moments(mass_of_shapes({hull_def(prism_points(n, 0.5f, 0.8f))}, 1.0f), mass,
                   Vec<3>::zero(), {{across, static_cast<float>(along), across}});
  }
}

/// Over the faces of a hull as it is, in double.
static Exact exact_of(const PolyhedronData& hull) {
  Exact exact;
  double products[9] = {};
  for (const PolyhedronFace& face : hull.faces) {
    const auto corner = [&](std::uint32_t e) {
      return hull.vertices[hull.edges[e].origin].position;
    };
    const Vec<3> a = corner(face.edge);
    for (std::uint32_t e = hull.edges[face.edge].next; hull.edges[e].next != face.edge;
         e = hull.edges[e].next) {
      const Vec<3> b = corner(e);
      const Vec<3> c = corner(hull.edges[e].next);
      double six = 0.0;
      for (int i = 0; i < 3; ++i)
        six += double{a[i]} * (double{b[(i + 1) % 3]} * double{c[(i + 2) % 3]} -
                               double{b[(i + 2) % 3]} * double{c[(i + 1) % 3]});
      exact.volume += six / 6.0;
      for (int i = 0; i < 3; ++i) {
        const double si = double{a[i]} + double{b[i]} + double{c[i]};
        exact.centre[i] += six / 24.0 * si;
        for (int j = 0; j < 3; ++j) {
          const double sj = double{a[j]} + double{b[j]} + double{c[j]};
          products[i * 3 + j] += six / 120.0 *
                                 (double{a[i]} * double{a[j]} + double{b[i]} * double{b[j]} +
                                  double{c[i]} * double{c[j]} + si * sj);
        }
      }
    }
  }
  for (double& x : exact.centre) x /= exact.volume;
  for (int i = 0; i < 9; ++i)
    products[i] -= exact.volume * exact.centre[i / 3] * exact.centre[i % 3];
  const double trace = products[0] + products[4] + products[8];
  for (int i = 0; i < 9; ++i) exact.inertia[i] = (i % 4 == 0 ? trace : 0.0) - products[i];
  return exact;
}

TEST(MassOfHull, OfSixtyFourPointsOnASphereIsThatOfItsFacesInDouble) {
  const Points points = sphere_points(64, 0.5f);
  PolyhedronData data;
  ASSERT_TRUE(build_polyhedron(points, data).ok());
  const Exact exact = exact_of(data);
  const MassProperties<3> properties = mass_of_shapes({hull_def(points)}, 1.0f);
  EXPECT_NEAR(properties.mass / exact.volume, 1.0, 1e-5);
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(properties.first[i] / properties.mass - data.middle[i], exact.centre[i], 5e-6);
  const Inertia<3> inertia = central_inertia(properties);
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(inertia.m[i], exact.inertia[i], 1e-5 * exact.inertia[0]);
  // And below, but not far below, what the ball has.
  EXPECT_LT(exact.volume, M_PI / 6.0);
  EXPECT_GT(exact.volume, 0.88 * M_PI / 6.0);
}

TEST(MassOfCapsule, IsCylinderAndTwoHalfBalls) {
  ShapeDef<3> capsule;
  capsule.kind = ShapeKind::kCapsule;
  capsule.radius = 0.25f;
  capsule.points = {{{0.0f, -0.5f, 0.0f}}, {{0.0f, 0.5f, 0.0f}}};
  const double r = 0.25, h = 1.0;
  const double tube = M_PI * r * r * h, ball = 4.0 / 3.0 * M_PI * r * r * r;
  const double along = 0.5 * tube * r * r + 0.4 * ball * r * r;
  // A half ball has 83/320 m r^2 about its centre, which lies 3/8 r beyond the end.
  const double arm = 0.5 * h + 0.375 * r;
  const double across =
      tube * (r * r / 4.0 + h * h / 12.0) + ball * (83.0 / 320.0 * r * r + arm * arm);
  expect_moments(mass_of_shapes({capsule}, 2.0f), 2.0 * (tube + ball), Vec<3>::zero(),
                 {{static_cast<float>(2.0 * across), static_cast<float>(2.0 * along),
                   static_cast<float>(2.0 * across)}});
}

TEST(MassOfCompound, OfTwoHalvesIsThatOfTheWhole) {
  Points left = box_points(0.25f, 0.3f, 0.4f);
  Points right = left;
  for (Vec<3>& p : left) p[0] -= 0.25f;
  for (Vec<3>& p : right) p[0] += 0.25f;
  const MassProperties<3> whole = mass_of_shapes({hull_def(box_points(0.5f, 0.3f, 0.4f))}, 1.0f);
  const Inertia<3> inertia = central_inertia(whole);
  expect_moments(mass_of_shapes({hull_def(left), hull_def(right)}, 1.0f), whole.mass,
                 Vec<3>::zero(), {{inertia.m[0], inertia.m[4], inertia.m[8]}});
}

/// As mass.hpp states: 5e-7 (d / s)^2, here with d^2 = 2 distance^2.
TEST(MassOfHull, FarFromTheOriginKeepsThePrecisionThatIsStated) {
  const Inertia<3> near =
      central_inertia(mass_of_shapes({hull_def(box_points(0.5f, 0.5f, 0.5f))}, 1.0f));
  for (const float distance : {10.0f, 100.0f}) {
    Points points = box_points(0.5f, 0.5f, 0.5f);
    for (Vec<3>& p : points) p += Vec<3>{{distance, 0.0f, -distance}};
    const Inertia<3> far = central_inertia(mass_of_shapes({hull_def(points)}, 1.0f));
    const float bound = 5e-7f * 2.0f * distance * distance;
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(far.m[i], near.m[i], bound * near.m[0]) << distance;
  }
}

TEST(MassOfHull, KeepsItsMomentsWhenTurned) {
  // I' = R I R^T: for a box and the box with its corners turned.
  const Rotation<3> q =
      normalized_or(Rotation<3>{{0.3f, -0.2f, 0.5f, 0.8f}}, identity_rotation<3>());
  Points points = box_points(0.2f, 0.5f, 1.0f);
  const Inertia<3> straight = central_inertia(mass_of_shapes({hull_def(points)}, 1.0f));
  for (Vec<3>& p : points) p = rotate(q, p);
  const Inertia<3> turned = central_inertia(mass_of_shapes({hull_def(points)}, 1.0f));
  const Inertia<3> expected = world_inertia(straight, q);
  for (int i = 0; i < 9; ++i) EXPECT_NEAR(turned.m[i], expected.m[i], 1e-5f * straight.m[0]);
}

TEST(InverseInertia, IsThereForAMillimetreCubeAndForAMountain) {
  for (const float half : {0.5e-3f, 1.0f, 2.0e3f}) {
    World<3> world = make_world<3>();
    BodyDef<3> def;
    const BodyId id = add(world, def, hull_def(box_points(half, half, half)));
    const Body<3>& body = world.state().bodies[id.index];
    const float moment = body.mass * 2.0f / 3.0f * half * half;
    EXPECT_NEAR(body.inverse_inertia.m[0] * moment, 1.0f, 1e-4f) << half;
    EXPECT_NEAR(body.inverse_inertia.m[8] * moment, 1.0f, 1e-4f) << half;
  }
  const Inertia<3> none = inverse(Inertia<3>{});
  for (const float moment : none.m) EXPECT_EQ(moment, 0.0f);
}

/// Powers of two do not round, so that scaling changed no bit of what had an inverse before.
TEST(InverseInertia, IsTheSameAtEveryPowerOfTwo) {
  const Inertia<3> inertia = {{3.1f, 0.2f, -0.3f, 0.2f, 2.7f, 0.5f, -0.3f, 0.5f, 4.9f}};
  const Inertia<3> expected = inverse(inertia);
  for (const float scale : {0x1p-60f, 0x1p-9f, 0x1p+7f, 0x1p+60f}) {
    Inertia<3> scaled = inertia;
    for (float& moment : scaled.m) moment *= scale;
    const Inertia<3> result = inverse(scaled);
    for (int i = 0; i < 9; ++i) EXPECT_EQ(result.m[i] * scale, expected.m[i]);
  }
}

TEST(InverseInertia, OfThePlaneIsOneOverItOrNothing) {
  for (const float moment : {1.0e-30f, 0.3f, 7.0f, 1.0e30f})
    EXPECT_EQ(inverse(Inertia<2>{{moment}}).m[0], 1.0f / moment);
  EXPECT_EQ(inverse(Inertia<2>{}).m[0], 0.0f);
}

}  // namespace cycloid::solver
