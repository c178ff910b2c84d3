#include "solver/character/planes.hpp"

#include <gtest/gtest.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

namespace cycloid::solver {

using Doubles = std::array<double, 3>;

static double degrees(double angle) {
  return angle * 3.14159265358979323846 / 180.0;
}

/// A corner of this angle whose free region opens towards -x with the apex at the origin.
static std::vector<CollisionPlane<2>> corner(double angle_deg) {
  const auto s = static_cast<float>(std::sin(degrees(angle_deg / 2)));
  const auto c = static_cast<float>(std::cos(degrees(angle_deg / 2)));
  return {{.normal = {{-s, c}}}, {.normal = {{-s, -c}}}};
}

static constexpr Vec<2> kIntoCorner = {{1.0f, 0.0f}};

TEST(Planes, SweepsApproachACornerByTheSquaredCosineOfItsAngle) {
  for (const int sweeps : {1, 2, 5, 20}) {
    const std::vector<CollisionPlane<2>> planes = corner(30);
    const Vec<2> p = sweep_planes<2>(kIntoCorner, planes, sweeps);
    const double expected = std::cos(degrees(15)) * std::pow(std::cos(degrees(30)), 2 * sweeps - 1);
    EXPECT_NEAR(length(p), expected, 1.0e-6) << sweeps;
  }
  EXPECT_NEAR(length(sweep_planes<2>(kIntoCorner, corner(30), 20)), 0.003537, 1.0e-6);
}

TEST(Planes, SweepsToReachACornerAreThoseOfTheClosedForm) {
  struct Row {
    double angle_deg;
    std::array<int, 3> sweeps;  ///< To 5 %, 1 % and 0.1 % of the start.
  };
  for (const Row& row : {Row{90, {1, 1, 1}}, Row{60, {3, 4, 6}}, Row{45, {5, 8, 11}},
                         Row{30, {11, 17, 25}}, Row{20, {25, 38, 56}}, Row{10, {99, 151, 226}},
                         Row{5, {394, 605, 907}}, Row{1, {9835, 15118, 22677}}}) {
    const std::vector<CollisionPlane<2>> planes = corner(row.angle_deg);
    for (int i = 0; i < 3; ++i) {
      const float goal = std::array{0.05f, 0.01f, 0.001f}[i];
      const int sweeps = row.sweeps[i];
      EXPECT_LE(length(sweep_planes<2>(kIntoCorner, planes, sweeps)), goal) << row.angle_deg;
      EXPECT_GT(length(sweep_planes<2>(kIntoCorner, planes, sweeps - 1)), goal) << row.angle_deg;
    }
  }
}

TEST(Planes, CornersAreSolvedExactlyWhateverTheirAngle) {
  for (const double angle_deg : {170.0, 90.0, 60.0, 45.0, 30.0, 10.0, 5.0, 1.0, 0.1, 0.01}) {
    std::vector<CollisionPlane<2>> planes = corner(angle_deg);
    const PlaneResult<2> result = solve_planes<2>(kIntoCorner, planes);
    EXPECT_TRUE(result.exact);
    EXPECT_LE(length(result.position), 1.0e-7f) << angle_deg;
    // The pushes carry the point from the target to the apex: p (n1 + n2) = (-1, 0).
    for (const CollisionPlane<2>& plane : planes)
      EXPECT_NEAR(plane.push * 2.0 * std::sin(degrees(angle_deg / 2)), 1.0, 1.0e-5);
  }
}

TEST(Planes, OnePlaneProjectsAndAFreeTargetStays) {
  std::vector<CollisionPlane<3>> planes = {{.normal = {{0.0f, 1.0f, 0.0f}}, .offset = 0.25f}};
  const PlaneResult<3> hit = solve_planes<3>({{3.0f, -1.0f, 2.0f}}, planes);
  EXPECT_EQ(hit.position[0], 3.0f);
  EXPECT_EQ(hit.position[1], 0.25f);
  EXPECT_EQ(hit.position[2], 2.0f);
  EXPECT_EQ(planes[0].push, 1.25f);
  const PlaneResult<3> free = solve_planes<3>({{3.0f, 1.0f, 2.0f}}, planes);
  EXPECT_EQ(free.position[1], 1.0f);
  EXPECT_EQ(planes[0].push, 0.0f);
}

/// Adds to `x` what puts it onto the k active planes, in double: by Gram's matrix, or where they
/// leave but a point by their own, which loses no digits. False where that is singular.
template <int D>
static bool correct(const std::vector<CollisionPlane<D>>& planes, const std::vector<int>& set,
                    Doubles& x) {
  const auto k = static_cast<int>(set.size());
  double m[3][4] = {};
  for (int r = 0; r < k; ++r) {
    m[r][k] = planes[set[r]].offset;
    for (int a = 0; a < D; ++a) {
      m[r][k] -= planes[set[r]].normal[a] * x[a];
      if (k == D) m[r][a] = planes[set[r]].normal[a];
      for (int c = 0; c < k && k < D; ++c)
        m[r][c] += double{planes[set[r]].normal[a]} * planes[set[c]].normal[a];
    }
  }
  for (int p = 0; p < k; ++p) {
    int best = p;
    for (int r = p + 1; r < k; ++r)
      if (std::abs(m[r][p]) > std::abs(m[best][p])) best = r;
    if (std::abs(m[best][p]) < 1.0e-13) return false;
    std::swap(m[best], m[p]);
    for (int r = 0; r < k; ++r) {
      if (r == p) continue;
      const double factor = m[r][p] / m[p][p];
      for (int c = p; c <= k; ++c) m[r][c] -= factor * m[p][c];
    }
  }
  for (int r = 0; r < k && k == D; ++r) x[r] += m[r][k] / m[r][r];
  for (int r = 0; r < k && k < D; ++r)
    for (int a = 0; a < D; ++a) x[a] += m[r][k] / m[r][r] * planes[set[r]].normal[a];
  return true;
}

/// All sets of at most D planes, in double: the closest feasible position; false where none is.
template <int D>
static bool enumerate(const std::vector<CollisionPlane<D>>& planes, const Vec<D>& target,
                      Doubles& closest) {
  double best = 1.0e300;
  const auto n = static_cast<unsigned>(planes.size());
  for (unsigned bits = 0; bits < 1u << n; ++bits) {
    if (std::popcount(bits) > D) continue;
    std::vector<int> set;
    for (unsigned i = 0; i < n; ++i)
      if ((bits >> i & 1u) != 0) set.push_back(static_cast<int>(i));
    Doubles x{};
    for (int a = 0; a < D; ++a) x[a] = target[a];
    if (!correct<D>(planes, set, x)) continue;
    for (int i = 0; i < 3; ++i) correct<D>(planes, set, x);
    double deepest = 0.0;
    double distance = 0.0;
    for (const CollisionPlane<D>& plane : planes) {
      double depth = plane.offset;
      for (int a = 0; a < D; ++a) depth -= plane.normal[a] * x[a];
      deepest = std::max(deepest, depth);
    }
    for (int a = 0; a < D; ++a) distance += (x[a] - target[a]) * (x[a] - target[a]);
    if (deepest > 1.0e-11 || distance >= best) continue;
    best = distance;
    closest = x;
  }
  return best < 1.0e300;
}

template <int D>
static std::vector<CollisionPlane<D>> random_planes(std::mt19937& random, int count) {
  const auto draw = [&] {
    return static_cast<float>(static_cast<double>(random()) / 4294967296.0 * 2.0 - 1.0);
  };
  std::vector<CollisionPlane<D>> planes;
  while (static_cast<int>(planes.size()) < count) {
    Vec<D> n;
    for (int a = 0; a < D; ++a) n[a] = draw();
    const float l = length(n);
    if (l < 0.1f || l > 1.0f) continue;
    planes.push_back({.normal = (1.0f / l) * n, .offset = 0.5f * draw()});
  }
  return planes;
}

struct Comparison {
  int feasible = 0;
  int infeasible = 0;
  double largest_error = 0.0;  ///< Of the position, relative to max(1 m, distance).
};

template <int D>
static Comparison compare_with_enumeration(int sets, unsigned seed) {
  std::mt19937 random(seed);
  Comparison comparison;
  for (int i = 0; i < sets; ++i) {
    std::vector<CollisionPlane<D>> planes = random_planes<D>(random, 1 + i % 6);
    const Vec<D> target = random_planes<D>(random, 1)[0].normal;
    Doubles exact{};
    const bool feasible = enumerate<D>(planes, target, exact);
    const PlaneResult<D> result = solve_planes<D>(target, planes);
    EXPECT_EQ(result.exact, feasible) << D << "D set " << i;
    (feasible ? comparison.feasible : comparison.infeasible) += 1;
    if (!feasible) {
      EXPECT_GT(result.violation, 0.0f);
      EXPECT_TRUE(std::isfinite(length(result.position)));
      continue;
    }
    double error = 0.0;
    double size = 0.0;
    for (int a = 0; a < D; ++a) {
      error += std::pow(result.position[a] - exact[a], 2);
      size += exact[a] * exact[a];
    }
    error = std::sqrt(error) / std::max(1.0, std::sqrt(size));
    EXPECT_LE(error, 1.0e-6) << D << "D set " << i << " size " << std::sqrt(size);
    comparison.largest_error = std::max(comparison.largest_error, error);
  }
  return comparison;
}

TEST(Planes, AreSolvedAsByEnumerationInDouble) {
  const Comparison plane = compare_with_enumeration<2>(10000, 1);
  const Comparison space = compare_with_enumeration<3>(10000, 2);
  EXPECT_GT(plane.feasible, 5000);
  EXPECT_GT(plane.infeasible, 500);
  EXPECT_GT(space.feasible, 5000);
  EXPECT_GT(space.infeasible, 100);
  // 1.1e-7 and 1.7e-7 were measured: the exact position rounded to float.
  EXPECT_LE(plane.largest_error, 2.0e-7);
  EXPECT_LE(space.largest_error, 2.0e-7);
}

/// What is called exact is the closest also between walls that meet half a degree from parallel.
TEST(Planes, NearlyParallelOnesAreSolvedAsByEnumerationInDouble) {
  std::mt19937 random(5);
  int exact = 0;
  int feasible = 0;
  for (int i = 0; i < 5000; ++i) {
    std::vector<CollisionPlane<3>> planes = random_planes<3>(random, 6);
    for (std::size_t k = 0; k < 4; ++k) {
      const float side = k % 2 == 0 ? 1.0f : -1.0f;
      const Vec<3> lean = 1.0e-3f * planes[k].normal + Vec<3>{{0.0f, side, 0.0f}};
      planes[k].normal = (1.0f / length(lean)) * lean;
    }
    const Vec<3> target = random_planes<3>(random, 1)[0].normal;
    Doubles closest{};
    const bool found = enumerate<3>(planes, target, closest);
    const PlaneResult<3> result = solve_planes<3>(target, planes);
    feasible += found ? 1 : 0;
    if (!found || !result.exact) continue;
    ++exact;
    double error = 0.0;
    double size = 1.0;
    for (int a = 0; a < 3; ++a) {
      error += std::pow(result.position[a] - closest[a], 2);
      size += closest[a] * closest[a];
    }
    EXPECT_LE(std::sqrt(error / size), 1.0e-5) << i << " size " << std::sqrt(size);
  }
  EXPECT_GT(feasible, 2000);
  EXPECT_EQ(exact, feasible);
}

TEST(Planes, DuplicatesChangeNoBit) {
  std::mt19937 random(3);
  for (int i = 0; i < 500; ++i) {
    std::vector<CollisionPlane<3>> once = random_planes<3>(random, 1 + i % 6);
    const Vec<3> target = random_planes<3>(random, 1)[0].normal;
    std::vector<CollisionPlane<3>> tenfold;
    std::vector<CollisionPlane<3>> repeated;
    for (int copy = 0; copy < 10; ++copy) tenfold.insert(tenfold.end(), once.begin(), once.end());
    for (const CollisionPlane<3>& plane : once) repeated.insert(repeated.end(), 10, plane);
    const Vec<3> expected = solve_planes<3>(target, once).position;
    const Vec<3> a = solve_planes<3>(target, tenfold).position;
    const Vec<3> b = solve_planes<3>(target, repeated).position;
    EXPECT_EQ(std::memcmp(&expected, &a, sizeof a), 0) << i;
    EXPECT_EQ(std::memcmp(&expected, &b, sizeof b), 0) << i;
  }
}

// The pushes of the call before are not a start: they are overwritten.
TEST(Planes, ResultDoesNotDependOnEarlierPushes) {
  std::mt19937 random(4);
  for (int i = 0; i < 200; ++i) {
    std::vector<CollisionPlane<2>> planes = random_planes<2>(random, 1 + i % 6);
    const Vec<2> target = random_planes<2>(random, 1)[0].normal;
    std::vector<CollisionPlane<2>> used = planes;
    for (CollisionPlane<2>& plane : used) plane.push = 7.0f;
    const Vec<2> a = solve_planes<2>(target, planes).position;
    const Vec<2> b = solve_planes<2>(target, used).position;
    EXPECT_EQ(std::memcmp(&a, &b, sizeof a), 0);
    for (std::size_t k = 0; k < planes.size(); ++k) EXPECT_EQ(planes[k].push, used[k].push);
  }
}

TEST(Planes, BetweenTwoWallsThatOverlapThePointIsInTheMiddle) {
  std::vector<CollisionPlane<2>> planes = {{.normal = {{1.0f, 0.0f}}, .offset = 0.5f},
                                           {.normal = {{-1.0f, 0.0f}}, .offset = 0.1f}};
  const PlaneResult<2> result = solve_planes<2>({{3.0f, 2.0f}}, planes);
  EXPECT_FALSE(result.exact);
  EXPECT_NEAR(result.position[0], 0.2f, 1.0e-6f);
  EXPECT_EQ(result.position[1], 2.0f);
  EXPECT_NEAR(result.violation, 0.3f, 1.0e-6f);
}

TEST(Planes, ASoftPlaneGivesWayAtItsLimit) {
  std::vector<CollisionPlane<2>> planes = {
      {.normal = {{0.0f, 1.0f}}, .offset = 0.0f, .push_limit = 0.25f}};
  const PlaneResult<2> result = solve_planes<2>({{1.0f, -1.0f}}, planes);
  EXPECT_EQ(result.position[0], 1.0f);
  EXPECT_EQ(result.position[1], -0.75f);
  EXPECT_EQ(planes[0].push, 0.25f);
  EXPECT_FALSE(result.exact);
}

TEST(Planes, ClippedVelocityLeavesNoPlaneAndKeepsTheRest) {
  std::vector<CollisionPlane<2>> planes = corner(1);
  for (CollisionPlane<2>& plane : planes) plane.push = 1.0f;
  EXPECT_LE(length(clip_velocity<2>({{10.0f, 0.0f}}, planes)), 1.0e-6f);
  const Vec<2> out = clip_velocity<2>({{-10.0f, 0.0f}}, planes);
  EXPECT_EQ(out[0], -10.0f);
  EXPECT_EQ(out[1], 0.0f);
  planes[0].push = 0.0f;  // Did not push: does not clip.
  const Vec<2> along = clip_velocity<2>({{0.0f, 3.0f}}, planes);
  EXPECT_NEAR(along[0], 3.0f * planes[1].normal[1] * -planes[1].normal[0], 1.0e-6f);
  EXPECT_NEAR(along[1], 3.0f * planes[1].normal[0] * planes[1].normal[0], 1.0e-6f);
  const std::vector<CollisionPlane<3>> floor = {{.normal = {{0.0f, 1.0f, 0.0f}}, .push = 0.1f}};
  const Vec<3> sliding = clip_velocity<3>({{3.0f, -4.0f, 5.0f}}, floor);
  EXPECT_EQ(sliding[0], 3.0f);
  EXPECT_EQ(sliding[1], 0.0f);
  EXPECT_EQ(sliding[2], 5.0f);
}

}  // namespace cycloid::solver
