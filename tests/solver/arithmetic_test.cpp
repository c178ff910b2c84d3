#include <gtest/gtest.h>

#include <cfenv>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "solver/dim.hpp"
#include "solver/floating_point_mode.hpp"
#include "solver/mass.hpp"
#include "solver/shapes.hpp"
#include "solver/trig.hpp"
#include "solver/world.hpp"

namespace cycloid::solver {

/// Every operation on W lanes, on values that include both zeros, subnormals, infinities and NaN.
template <int W>
std::vector<std::uint32_t> lane_results() {
  constexpr float kValues[] = {0.0f,
                               -0.0f,
                               1.0f,
                               -1.5f,
                               1.0e-40f,
                               3.0e38f,
                               0.1f,
                               -7.25f,
                               1e-3f,
                               2.0f,
                               -1e30f,
                               0.5f,
                               std::numeric_limits<float>::infinity(),
                               -std::numeric_limits<float>::infinity(),
                               std::numeric_limits<float>::quiet_NaN(),
                               12345.678f};
  std::vector<std::uint32_t> results;
  for (int shift = 0; shift < 16; ++shift)
    for (int base = 0; base < 16; base += W) {
      float a[W];
      float b[W];
      for (int i = 0; i < W; ++i) {
        a[i] = kValues[base + i];
        b[i] = kValues[(base + i + shift) % 16];
      }
      const Lanes<W> x = Lanes<W>::load(a);
      const Lanes<W> y = Lanes<W>::load(b);
      const Lanes<W> all[] = {
          x + y, x - y, x * y, x / y, max(x, y), min(x, y), sqrt(x), select(x < y, x, y), -x};
      for (int i = 0; i < W; ++i)
        for (const Lanes<W>& lanes : all) {
          float out[W];
          lanes.store(out);
          std::uint32_t bits = 0;
          std::memcpy(&bits, &out[i], sizeof bits);
          results.push_back(out[i] != out[i] ? 0x7fc00000u : bits);
        }
    }
  return results;
}

TEST(Lanes, EveryOperationIsTheSameAtEveryWidth) {
  const std::vector<std::uint32_t> scalar = lane_results<1>();
  EXPECT_EQ(scalar, lane_results<4>());
  EXPECT_EQ(scalar, lane_results<8>());
  EXPECT_EQ(scalar, lane_results<16>());
}

TEST(Trig, SineAndCosineAreWithinTenToTheMinusSeven) {
  double worst = 0.0;
  for (int i = -200000; i <= 200000; ++i) {
    const float angle = static_cast<float>(i) * 1.0e-3f;
    float sine = 0.0f;
    float cosine = 0.0f;
    sin_cos(angle, sine, cosine);
    worst = std::max(worst, std::abs(sine - std::sin(static_cast<double>(angle))));
    worst = std::max(worst, std::abs(cosine - std::cos(static_cast<double>(angle))));
  }
  EXPECT_LT(worst, 1.0e-7);
}

TEST(Trig, ArctangentIsWithinThreeTenToTheMinusSevenInAllQuadrants) {
  double worst = 0.0;
  for (int i = 0; i < 10000; ++i) {
    const double angle = -3.14159 + i * 6.28318e-4;
    const float y = static_cast<float>(3.0 * std::sin(angle));
    const float x = static_cast<float>(3.0 * std::cos(angle));
    worst = std::max(worst, std::abs(atan2(y, x) - std::atan2(double{y}, double{x})));
  }
  EXPECT_LT(worst, 3.0e-7);
  EXPECT_EQ(atan2(0.0f, 0.0f), 0.0f);
}

TEST(FloatingPointMode, OtherRoundingIsSeenAndAWorldIsRefused) {
  EXPECT_TRUE(floating_point_mode_is_ieee());
  for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    std::fesetround(mode);
    const bool seen = !floating_point_mode_is_ieee();
    const char* field = World<2>::create({}).error().field;
    std::fesetround(FE_TONEAREST);
    EXPECT_TRUE(seen);
    EXPECT_STREQ(field, "floating_point_mode");
  }
}

MassProperties<2> mass_of(const ShapeDef<2>& def) {
  std::vector<Shape<2>> shapes;
  EXPECT_TRUE(append_shapes(def, 0, shapes).ok());
  MassProperties<2> properties;
  for (const Shape<2>& shape : shapes) add_mass(shape, 2.0f, properties);
  return properties;
}

TEST(Mass, OfBoxDiscAndCapsuleIsTheClosedForm) {
  ShapeDef<2> box;
  box.kind = ShapeKind::kPolygon;
  box.points = {{{1.0f, 2.0f}}, {{4.0f, 2.0f}}, {{4.0f, 4.0f}}, {{1.0f, 4.0f}}};
  const MassProperties<2> boxed = mass_of(box);
  EXPECT_NEAR(boxed.mass, 12.0f, 1e-4f);
  EXPECT_NEAR(boxed.first[0] / boxed.mass, 2.5f, 1e-5f);
  EXPECT_NEAR(boxed.first[1] / boxed.mass, 3.0f, 1e-5f);
  EXPECT_NEAR(central_inertia(boxed).m[0], 12.0f * (9.0f + 4.0f) / 12.0f, 1e-3f);

  ShapeDef<2> capsule;
  capsule.kind = ShapeKind::kCapsule;
  capsule.points = {{{-1.0f, 0.0f}}, {{1.0f, 0.0f}}};
  capsule.radius = 0.5f;
  const MassProperties<2> pill = mass_of(capsule);
  const double disc = 2.0 * M_PI * 0.25;
  const double core = 2.0 * 2.0 * 1.0;
  EXPECT_NEAR(pill.mass, disc + core, 1e-4);
  // Two half discs: their centroids lie 4 r / 3 pi outside the ends.
  const double reach = 4.0 * 0.5 / (3.0 * M_PI);
  const double half = 0.5 * disc * 0.25 - disc * reach * reach;
  const double expected = core * (4.0 + 1.0) / 12.0 + half + disc * (1.0 + reach) * (1.0 + reach);
  EXPECT_NEAR(central_inertia(pill).m[0], expected, 1e-3);
}

// A rounded polygon against a fine grid of points.
TEST(Mass, OfARoundedTriangleAgreesWithAGrid) {
  ShapeDef<2> triangle;
  triangle.kind = ShapeKind::kPolygon;
  triangle.points = {{{0.0f, 0.0f}}, {{1.0f, 0.0f}}, {{0.2f, 0.8f}}};
  triangle.radius = 0.3f;
  const MassProperties<2> exact = mass_of(triangle);
  const auto distance = [&](double x, double y) {
    double outside = 0.0;
    double nearest = 1e9;
    for (int i = 0; i < 3; ++i) {
      const Vec<2> p = triangle.points[static_cast<std::size_t>(i)];
      const Vec<2> q = triangle.points[static_cast<std::size_t>((i + 1) % 3)];
      const double ex = q[0] - p[0];
      const double ey = q[1] - p[1];
      const double t =
          std::clamp(((x - p[0]) * ex + (y - p[1]) * ey) / (ex * ex + ey * ey), 0.0, 1.0);
      nearest = std::min(nearest, std::hypot(x - p[0] - t * ex, y - p[1] - t * ey));
      outside = std::max(outside, ((x - p[0]) * ey - (y - p[1]) * ex));
    }
    return outside > 0.0 ? nearest : -nearest;
  };
  double mass = 0.0;
  double second = 0.0;
  const double cell = 2.0e-3;
  for (double x = -0.5; x < 1.5; x += cell)
    for (double y = -0.5; y < 1.5; y += cell)
      if (distance(x, y) <= 0.3) {
        mass += 2.0 * cell * cell;
        second += 2.0 * cell * cell * (x * x + y * y);
      }
  EXPECT_NEAR(exact.mass, mass, 2e-3 * mass);
  EXPECT_NEAR(exact.second.m[0], second, 4e-3 * second);
}

TEST(Mass, OfTwoBallsInSpaceIsTheClosedForm) {
  MassProperties<3> properties;
  for (const float x : {-2.0f, 2.0f}) {
    ShapeDef<3> def;
    def.radius = 0.5f;
    def.points = {{{x, 0.0f, 0.0f}}};
    std::vector<Shape<3>> shapes;
    ASSERT_TRUE(append_shapes(def, 0, shapes).ok());
    add_mass(shapes[0], 3.0f, properties);
  }
  const double m = 3.0 * 4.0 / 3.0 * M_PI * 0.125;
  EXPECT_NEAR(properties.mass, 2.0 * m, 1e-4);
  const Inertia<3> inertia = central_inertia(properties);
  EXPECT_NEAR(inertia.m[0], 2.0 * 0.4 * m * 0.25, 1e-4);
  EXPECT_NEAR(inertia.m[4], 2.0 * (0.4 * m * 0.25 + m * 4.0), 1e-3);
  EXPECT_NEAR(inertia.m[1], 0.0, 1e-6);
}

}  // namespace cycloid::solver
