#pragma once

#include "solver/dim.hpp"

namespace cycloid::solver {

/// Where two edges come closest, from 0 to 1 along each.
template <class L>
struct EdgeFractions {
  L first;
  L second;
};

/// Closest points of the edges p + s d1 and q + t d2, which do not cross, L being a float or lanes
/// of them. An edge without length has no fraction: none that is a number comes out.
/// Source: Ericson, "Real-Time Collision Detection" (2005), 5.1.9.
template <class L>
[[gnu::always_inline]] inline EdgeFractions<L> closest_fractions(const Vec<2, L>& p,
                                                                 const Vec<2, L>& d1,
                                                                 const Vec<2, L>& q,
                                                                 const Vec<2, L>& d2) {
  const L zero = L(0.0f);
  const L one = L(1.0f);
  const auto within = [&](L of) { return max(zero, min(of, one)); };
  const Vec<2, L> r = p - q;
  const L a = dot(d1, d1);
  const L e = dot(d2, d2);
  const L b = dot(d1, d2);
  const L c = dot(d1, r);
  const L f = dot(d2, r);
  const L denominator = a * e - b * b;
  const auto slanted = denominator > L(1.0e-6f) * a * e;
  const L s = select(slanted, within((b * f - c * e) / select(slanted, denominator, one)), zero);
  const L t = (b * s + f) / e;
  const auto before = t < zero;
  const auto behind = t > one;
  return {select(before, within(-c / a), select(behind, within((b - c) / a), s)),
          select(before, zero, select(behind, one, t))};
}

}  // namespace cycloid::solver
