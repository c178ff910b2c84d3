#pragma once

#include "solver/collision/solid.hpp"

namespace cycloid::solver {

/// A convex polygon in space. Edge i runs from corner i to the next one and keeps its label when it
/// is cut short; labels are unique, so two in a row name a corner.
struct Polygon {
  static constexpr std::uint32_t kCornersMax = 2 * kHullVerticesMax;
  std::uint32_t count = 0;
  std::array<Vec<3>, kCornersMax> corners;
  std::array<std::uint32_t, kCornersMax> labels;
};

/// The corners of a face; labels count its edges from 0.
void face_polygon(const Solid& solid, std::uint32_t face, Polygon& polygon);

/// Cuts off what lies outside of the side planes of a face, each moved outwards by `slack` [m].
/// Labels of the face's edges count from kHullVerticesMax.
/// Source: Sutherland and Hodgman, "Reentrant Polygon Clipping" (1974).
void clip_polygon(const Solid& solid, std::uint32_t face, float slack, Polygon& polygon);

}  // namespace cycloid::solver
