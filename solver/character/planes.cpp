#include "solver/character/planes.hpp"

#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "solver/direct/wide.hpp"

namespace cycloid::solver {

template <int D>
using Planes = std::span<const CollisionPlane<D>>;
/// Indices of the planes that a combination is chosen from.
template <int D>
using Members = std::array<std::uint32_t, D + 1>;

/// a + b as a rounded sum and what rounding lost. Source: Knuth, TAOCP 2 (1969), 4.2.2.
struct Expansion {
  float sum;
  float rest;
};
static Expansion exact_sum(float a, float b) {
  const float sum = a + b;
  const float b_part = sum - a;
  return {sum, (a - (sum - b_part)) + (b - b_part)};
}

/// Likewise a * b. Source: Dekker, "A floating-point technique..." (1971).
static Expansion exact_product(float a, float b) {
  constexpr float kSplit = 4097.0f;
  const float a_high = kSplit * a - (kSplit * a - a);
  const float b_high = kSplit * b - (kSplit * b - b);
  const float a_low = a - a_high;
  const float b_low = b - b_high;
  const float product = a * b;
  return {product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low};
}

/// How far `x` is in the solid [m], as if computed in twice the precision: in an acute corner the
/// plain sum has lost the digits that decide.
template <int D>
static float depth(const CollisionPlane<D>& plane, const Vec<D>& x) {
  float sum = plane.offset;
  float rest = 0.0f;
  for (int i = 0; i < D; ++i) {
    const Expansion product = exact_product(plane.normal[i], x[i]);
    const Expansion next = exact_sum(sum, -product.sum);
    sum = next.sum;
    rest += next.rest - product.rest;
  }
  return sum + rest;
}

/// Depth beyond that which rounding `x` to float makes by itself; positive in the solid.
template <int D>
static float excess(const CollisionPlane<D>& plane, const Vec<D>& x, const Vec<D>& target) {
  const float rounding = 2.0e-7f * (length(x) + abs(plane.offset)) + 1.0e-9f * length(target);
  return depth(plane, x) - rounding - 1.0e-30f;
}

/// Planes that hold with equality, and the vectors that are 1 along one of their normals and 0
/// along the others: the pseudo-inverse, by which both the projection and the pushes are found.
template <int D>
struct ActiveSet {
  int count = 0;
  std::array<std::uint32_t, static_cast<std::size_t>(D)> planes{};
  std::array<Vec<D>, static_cast<std::size_t>(D)> duals{};
  Vec<D> line = Vec<D>::zero();  ///< Unit, of the edge where two planes meet in space.
};

// Where two normals are closer than this [sine] to dependent, the combination is left out.
static constexpr float kDependent = 1.0e-6f;

static bool invert(ActiveSet<2>& set, const std::array<Vec<2>, 2>& n) {
  if (set.count == 1) {
    set.duals[0] = (1.0f / dot(n[0], n[0])) * n[0];
    return true;
  }
  const float det = cross(n[0], n[1]);
  if (!(abs(det) > kDependent)) return false;
  set.duals[0] = (1.0f / det) * Vec<2>{{n[1][1], -n[1][0]}};
  set.duals[1] = (1.0f / det) * Vec<2>{{-n[0][1], n[0][0]}};
  return true;
}

/// a x b without the loss of digits where a and b are nearly parallel.
static Vec<3> precise_cross(const Vec<3>& a, const Vec<3>& b) {
  Vec<3> result;
  for (int i = 0; i < 3; ++i) {
    const int j = i < 2 ? i + 1 : 0;
    const int k = j < 2 ? j + 1 : 0;
    const Expansion plus = exact_product(a[j], b[k]);
    const Expansion minus = exact_product(a[k], b[j]);
    const Expansion sum = exact_sum(plus.sum, -minus.sum);
    result[i] = sum.sum + (sum.rest + (plus.rest - minus.rest));
  }
  return result;
}

static bool invert_pair(ActiveSet<3>& set, const std::array<Vec<3>, 3>& n) {
  const Vec<3> third = precise_cross(n[0], n[1]);
  const Vec<3> by_first = cross(n[1], third);
  const float det = dot(n[0], by_first);
  if (!(abs(det) > kDependent * kDependent)) return false;
  set.duals[0] = (1.0f / det) * by_first;
  set.duals[1] = (1.0f / det) * cross(third, n[0]);
  set.line = (1.0f / sqrt(dot(third, third))) * third;
  return true;
}

/// In double, which holds the product of two floats exactly: three nearly parallel walls may have a
/// corner even where the volume of their normals is less than a float tells from 0.
static bool invert_triple(ActiveSet<3>& set, const std::array<Vec<3>, 3>& n) {
  constexpr Wide kFlat = 1.0e-13;
  Vec<3, Wide> wide[3];
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) wide[i][k] = Wide{n[i][k]};
  const Wide det = dot(wide[0], cross(wide[1], wide[2]));
  if (!(det * det > kFlat * kFlat)) return false;
  for (int i = 0; i < 3; ++i) {
    const Vec<3, Wide> across = cross(wide[(i + 1) % 3], wide[(i + 2) % 3]);
    for (int k = 0; k < 3; ++k) set.duals[i][k] = static_cast<float>(across[k] / det);
  }
  return true;
}

static bool invert(ActiveSet<3>& set, const std::array<Vec<3>, 3>& n) {
  if (set.count == 2) return invert_pair(set, n);
  if (set.count == 3) return invert_triple(set, n);
  set.duals[0] = (1.0f / dot(n[0], n[0])) * n[0];
  return true;
}

/// The target projected onto the intersection of the active planes. The corrections after the
/// first use exact depths, and undo what rounding moved along the edge of two planes, so the error
/// is that of rounding the exact result to float.
template <int D>
static Vec<D> project(const ActiveSet<D>& set, Planes<D> planes, const Vec<D>& target) {
  Vec<D> x = target;
  for (int refinement = 0; refinement < 4; ++refinement) {
    Vec<D> correction = -dot(set.line, x - target) * set.line;
    for (int i = 0; i < set.count; ++i)
      correction += depth(planes[set.planes[i]], x) * set.duals[i];
    x += correction;
  }
  return x;
}

/// The closest position for at most D + 1 planes, of which the last is active: false where there
/// is none. Combinations go by the bits of a counter, lowest members first.
template <int D>
static bool solve_few(const Members<D>& members, int count, Planes<D> planes, const Vec<D>& target,
                      ActiveSet<D>& active, Vec<D>& position) {
  float best = kRigidPlane;
  for (std::uint32_t bits = 0; bits < 1u << (count - 1); ++bits) {
    ActiveSet<D> set;
    std::array<Vec<D>, static_cast<std::size_t>(D)> normals{};
    const std::uint32_t chosen = bits | 1u << (count - 1);
    if (std::popcount(chosen) > D) continue;
    for (int i = 0; i < count; ++i) {
      if ((chosen >> i & 1u) == 0) continue;
      normals[set.count] = planes[members[i]].normal;
      set.planes[set.count++] = members[i];
    }
    if (!invert(set, normals)) continue;
    const Vec<D> x = project(set, planes, target);
    const Vec<D> moved = x - target;
    const float distance = dot(moved, moved);
    bool fits = distance < best;
    for (int i = 0; i < count; ++i) fits = fits && excess(planes[members[i]], x, target) <= 0.0f;
    if (!fits) continue;
    best = distance;
    active = set;
    position = x;
  }
  return best < kRigidPlane;
}

/// The exact answer by pivoting; false where the planes are infeasible, a push exceeds its limit,
/// or the bound is reached.
template <int D>
static bool solve_exactly(const Vec<D>& target, std::span<CollisionPlane<D>> planes,
                          Vec<D>& position) {
  const Planes<D> read = planes;
  ActiveSet<D> active;
  position = target;
  for (int pivot = 0; pivot < kPlanePivotsMax; ++pivot) {
    std::uint32_t worst = 0;
    float deepest = 0.0f;
    for (std::uint32_t i = 0; i < planes.size(); ++i) {
      const float into = excess(read[i], position, target);
      if (!(into > deepest)) continue;
      deepest = into;
      worst = i;
    }
    if (deepest > 0.0f) {
      Members<D> members{};
      for (int i = 0; i < active.count; ++i) members[i] = active.planes[i];
      members[active.count] = worst;
      if (!solve_few<D>(members, active.count + 1, read, target, active, position)) return false;
      continue;
    }
    for (int i = 0; i < active.count; ++i) {
      CollisionPlane<D>& plane = planes[active.planes[i]];
      plane.push = max(0.0f, dot(active.duals[i], position - target));
      if (plane.push > plane.push_limit) return false;
    }
    return true;
  }
  return false;
}

/// Whether an earlier plane says the same, so that duplicates change nothing.
template <int D>
static bool repeats(Planes<D> planes, std::size_t index) {
  const CollisionPlane<D>& plane = planes[index];
  for (std::size_t i = 0; i < index; ++i) {
    bool same = planes[i].offset == plane.offset && planes[i].push_limit == plane.push_limit;
    for (int k = 0; k < D; ++k) same = same && planes[i].normal[k] == plane.normal[k];
    if (same) return true;
  }
  return false;
}

/// Projected Gauss-Seidel on the pushes; returns the sweeps made.
template <int D>
static int sweep_pushes(std::span<CollisionPlane<D>> planes, Vec<D>& x, float tolerance) {
  for (int sweep = 1; sweep <= kPlaneSweepsMax; ++sweep) {
    float most = 0.0f;
    for (CollisionPlane<D>& plane : planes) {
      const float push = clamp(plane.push + depth(plane, x), 0.0f, plane.push_limit);
      x += (push - plane.push) * plane.normal;
      most = max(most, abs(push - plane.push));
      plane.push = push;
    }
    if (most <= tolerance) return sweep;
  }
  return kPlaneSweepsMax;
}

template <int D>
static float deepest_rigid(Planes<D> planes, const Vec<D>& x) {
  float deepest = 0.0f;
  for (const CollisionPlane<D>& plane : planes)
    if (plane.push_limit == kRigidPlane) deepest = max(deepest, depth(plane, x));
  return deepest;
}

/// Towards the least sum of squared depths of the rigid planes: the mean of all projections.
template <int D>
static void relax(Planes<D> planes, Vec<D>& x) {
  for (int round = 0; round < kPlaneSweepsMax; ++round) {
    Vec<D> sum = Vec<D>::zero();
    float violated = 0.0f;
    for (const CollisionPlane<D>& plane : planes) {
      const float into = depth(plane, x);
      if (!(into > 0.0f) || plane.push_limit != kRigidPlane) continue;
      sum += into * plane.normal;
      violated += 1.0f;
    }
    if (!(violated > 0.0f)) return;
    x += (1.0f / violated) * sum;
  }
}

template <int D>
Vec<D> sweep_planes(const Vec<D>& target, std::span<const CollisionPlane<D>> planes, int sweeps) {
  Vec<D> x = target;
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (const CollisionPlane<D>& plane : planes)
      x += max(0.0f, plane.offset - dot(plane.normal, x)) * plane.normal;
  return x;
}

template <int D>
PlaneResult<D> solve_planes(const Vec<D>& target, std::span<CollisionPlane<D>> planes) {
  for (CollisionPlane<D>& plane : planes) plane.push = 0.0f;
  PlaneResult<D> result;
  if (solve_exactly(target, planes, result.position)) {
    result.violation = deepest_rigid<D>(planes, result.position);
    return result;
  }
  std::vector<CollisionPlane<D>> distinct;
  std::vector<std::size_t> from;
  for (std::size_t i = 0; i < planes.size(); ++i) {
    planes[i].push = 0.0f;
    if (repeats<D>(planes, i)) continue;
    distinct.push_back(planes[i]);
    from.push_back(i);
  }
  result.exact = false;
  result.position = target;
  result.sweeps = sweep_pushes<D>(distinct, result.position, 1.0e-7f * length(target) + 1.0e-9f);
  if (deepest_rigid<D>(distinct, result.position) > 1.0e-6f * (1.0f + length(result.position)))
    relax<D>(distinct, result.position);
  for (std::size_t i = 0; i < distinct.size(); ++i) planes[from[i]].push = distinct[i].push;
  result.violation = deepest_rigid<D>(planes, result.position);
  return result;
}

template <int D>
Vec<D> clip_velocity(const Vec<D>& velocity, std::span<const CollisionPlane<D>> planes) {
  std::vector<CollisionPlane<D>> cone;
  for (const CollisionPlane<D>& plane : planes)
    if (plane.push > 0.0f) cone.push_back({plane.normal, 0.0f, kRigidPlane, 0.0f});
  return solve_planes<D>(velocity, cone).position;
}

template Vec<2> sweep_planes(const Vec<2>&, std::span<const CollisionPlane<2>>, int);
template Vec<3> sweep_planes(const Vec<3>&, std::span<const CollisionPlane<3>>, int);
template PlaneResult<2> solve_planes(const Vec<2>&, std::span<CollisionPlane<2>>);
template PlaneResult<3> solve_planes(const Vec<3>&, std::span<CollisionPlane<3>>);
template Vec<2> clip_velocity(const Vec<2>&, std::span<const CollisionPlane<2>>);
template Vec<3> clip_velocity(const Vec<3>&, std::span<const CollisionPlane<3>>);

}  // namespace cycloid::solver
