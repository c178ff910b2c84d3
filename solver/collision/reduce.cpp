#include "solver/collision/solid.hpp"

namespace cycloid::solver {

/// Depths [m] within this of the deepest count as equal.
static constexpr float kDepthTolerance = 1.0e-4f;
/// A distance or area has to be larger by this part to win, so that equal ones stay equal under
/// rounding.
static constexpr float kMeasureTolerance = 1.001f;

static std::size_t deepest_of(std::span<const Candidate> candidates) {
  float lowest = candidates[0].separation;
  for (const Candidate& candidate : candidates) lowest = min(lowest, candidate.separation);
  std::size_t i = 0;
  while (candidates[i].separation > lowest + kDepthTolerance) ++i;
  return i;
}

/// The candidate with the largest measure, of equals the deepest and then the first; none, that is
/// their number, where no measure exceeds `least`.
template <class Measure>
static std::size_t largest_of(std::span<const Candidate> candidates, float least,
                              const Measure& measure) {
  const std::size_t none = candidates.size();
  std::size_t best = none;
  float largest = least;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const float value = measure(candidates[i].at);
    if (value <= least) continue;
    const bool larger = value > kMeasureTolerance * largest;
    const bool deeper = best != none && value * kMeasureTolerance >= largest &&
                        candidates[i].separation < candidates[best].separation - kDepthTolerance;
    if (best != none && !larger && !deeper) continue;
    best = i;
    largest = value;
  }
  return best;
}

/// Indices of the points that stay, at most four.
struct Choice {
  std::size_t index[4];
  std::size_t count = 0;

  void add(std::size_t i) { index[count++] = i; }
};

static Choice choose(std::span<const Candidate> candidates, const Vec<3>& normal) {
  const std::size_t none = candidates.size();
  Choice choice;
  const std::size_t first = deepest_of(candidates);
  choice.add(first);
  const Vec<3> p = candidates[first].at;
  // Measured in the plane of the contact, in which the far side of a small box is not far.
  const auto squared_from = [&](const Vec<3>& from) {
    return [&normal, from](const Vec<3>& at) {
      const Vec<3> arm = cross(normal, at - from);
      return dot(arm, arm);
    };
  };
  const std::size_t second = largest_of(candidates, 0.0f, squared_from(p));
  if (second == none) return choice;
  choice.add(second);
  const Vec<3> q = candidates[second].at;
  const Vec<3> base = q - p;
  const Vec<3> across = cross(normal, base);
  // A triangle flatter than this part of its base squared is a line.
  const float flat = 1.0e-5f * dot(across, across);
  const std::size_t third =
      largest_of(candidates, flat, [&](const Vec<3>& at) { return abs(dot(across, at - p)); });
  if (third == none) {
    // All lie on a line: the deepest may lie within it, so keep its other end.
    const float least = kMeasureTolerance * dot(across, across);
    const std::size_t end = largest_of(candidates, least, squared_from(q));
    if (end != none) choice.add(end);
    return choice;
  }
  choice.add(third);
  const Vec<3> r = candidates[third].at;
  const float side = dot(across, r - p) < 0.0f ? -1.0f : 1.0f;
  const Vec<3> outward[3] = {-side * across, -side * cross(normal, r - q),
                             -side * cross(normal, p - r)};
  const std::size_t fourth = largest_of(candidates, flat, [&](const Vec<3>& at) {
    return max(dot(outward[0], at - p), max(dot(outward[1], at - q), dot(outward[2], at - r)));
  });
  if (fourth != none) choice.add(fourth);
  return choice;
}

void reduce(std::span<const Candidate> candidates, Manifold<3>& manifold) {
  const auto add = [&](const Candidate& candidate) {
    add_point(candidate.at, candidate.separation, candidate.feature, manifold);
  };
  if (candidates.size() <= 4) {
    for (const Candidate& candidate : candidates) add(candidate);
    return;
  }
  // In the order of the candidates, which changes less from tick to tick than that of the choice.
  const Choice choice = choose(candidates, manifold.normal);
  for (std::size_t i = 0; i < candidates.size(); ++i)
    for (std::size_t k = 0; k < choice.count; ++k)
      if (choice.index[k] == i) add(candidates[i]);
}

}  // namespace cycloid::solver
