#include "solver/collision/segments.hpp"

namespace cycloid::solver {

float nearest_fraction(const Vec<3>& from, const Vec<3>& along, float inverse_square,
                       const Vec<3>& point) {
  return clamp(dot(point - from, along) * inverse_square, 0.0f, 1.0f);
}

float inverse_or_zero(float square) {
  return square > 1.0e-30f ? 1.0f / square : 0.0f;
}

static void keep_nearer(const Vec<3>& a_from, const Vec<3>& d1, const Vec<3>& b_from,
                        const Vec<3>& d2, float s, float t, float& square, SegmentPair& best) {
  const Vec<3> on_a = a_from + s * d1;
  const Vec<3> on_b = b_from + t * d2;
  const Vec<3> between = on_b - on_a;
  const float candidate = dot(between, between);
  if (!(candidate < square)) return;
  square = candidate;
  best = {on_a, on_b, s, t, 0.0f, false};
}

SegmentPair nearest_points(const Vec<3>& a_from, const Vec<3>& a_to, const Vec<3>& b_from,
                           const Vec<3>& b_to) {
  const Vec<3> d1 = a_to - a_from;
  const Vec<3> d2 = b_to - b_from;
  const float square_a = dot(d1, d1);
  const float square_b = dot(d2, d2);
  const float inverse_a = inverse_or_zero(square_a);
  const float inverse_b = inverse_or_zero(square_b);
  const Vec<3> normal = cross(d1, d2);
  const float square = dot(normal, normal);
  if (square > 1.0e-8f * square_a * square_b) {
    const Vec<3> offset = b_from - a_from;
    const float s = dot(cross(offset, d2), normal) / square;
    const float t = dot(cross(offset, d1), normal) / square;
    if (s > 0.0f && s < 1.0f && t > 0.0f && t < 1.0f) {
      // Once to and fro takes the rounding of a small angle out of the distance.
      const float t1 = nearest_fraction(b_from, d2, inverse_b, a_from + s * d1);
      const float s1 = nearest_fraction(a_from, d1, inverse_a, b_from + t1 * d2);
      const Vec<3> on_a = a_from + s1 * d1;
      const Vec<3> on_b = b_from + t1 * d2;
      return {on_a, on_b, s1, t1, length(on_b - on_a), true};
    }
  }
  SegmentPair best{};
  float least = 3.0e38f;
  if (!(square_b > 0.0f)) {
    keep_nearer(a_from, d1, b_from, d2, nearest_fraction(a_from, d1, inverse_a, b_from), 0.0f,
                least, best);
    best.distance = sqrt(least);
    return best;
  }
  keep_nearer(a_from, d1, b_from, d2, nearest_fraction(a_from, d1, inverse_a, b_from), 0.0f, least,
              best);
  keep_nearer(a_from, d1, b_from, d2, nearest_fraction(a_from, d1, inverse_a, b_to), 1.0f, least,
              best);
  keep_nearer(a_from, d1, b_from, d2, 0.0f, nearest_fraction(b_from, d2, inverse_b, a_from), least,
              best);
  keep_nearer(a_from, d1, b_from, d2, 1.0f, nearest_fraction(b_from, d2, inverse_b, a_to), least,
              best);
  best.distance = sqrt(least);
  return best;
}

}  // namespace cycloid::solver
