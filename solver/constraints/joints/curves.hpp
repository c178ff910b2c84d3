#pragma once

#include <array>

#include "solver/state.hpp"

namespace cycloid::solver {

/// A point against a curve: signed distance [m], positive on the hollow (inner) side, and the unit
/// gradient of it. Exact for circle, cycloid and outline; for the ellipse f / |grad f|, exact on
/// the curve and to first order beside it.
struct CurvePoint {
  float distance;
  Vec<2> normal;
};

/// @param size   of the curve, m, as in CurveKind. @pre kind is not kPolyline; size > 0.
/// @param point  m, frame of the curve.
CurvePoint nearest_on_curve(CurveKind kind, const std::array<float, 2>& size, const Vec<2>& point);

/// The nearest chain edge or polygon edge of a body; of equals the first in the body's list, but
/// beside a sharp corner the one that has the point on the right side of both. A body without edges
/// gives distance 0 along +y.
/// @param point  m, from the body's centre of mass, in its frame.
CurvePoint nearest_on_outline(const WorldState<2>& state, std::uint32_t body, const Vec<2>& point);

}  // namespace cycloid::solver
