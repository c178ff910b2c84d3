#pragma once

#include "solver/collision/solid.hpp"

namespace cycloid::solver {

/// What lies across an edge of a triangle. Both directions are unit and across the edge.
struct Border {
  Vec<3> outward;  ///< In the triangle's plane.
  Vec<3> into;     ///< In the neighbour's plane; outward where there is none.
  bool shared;     ///< There is a neighbour,
  bool convex;     ///< and it turns away from the free side by more than kFlat.
};

/// Sines [1] below this are flat: the rounding of a triangle of 1 m as far as 1 km from the origin.
inline constexpr float kFlat = 1.0e-3f;

/// Edge i runs from corner i to the next one.
Border border_of(const Solid& triangle, std::uint32_t edge);

enum class Leaning : std::uint32_t {
  kAllowed,    ///< Between the triangle's normal and its neighbour's, or over a free edge.
  kOwnOnly,    ///< Over an edge where the surface goes on flat, or rises.
  kNeighbour,  ///< Beyond the neighbour's normal: nearer to the neighbour than to the edge.
};

/// Whether a unit normal at a corner or edge is one that the surface allows there. For a normal
/// towards the nearest point of something this is the condition that the edge is nearest also where
/// the neighbour is counted in; so of all triangles one at least, that which is nearest, allows it.
/// Several may: an edge or corner that sticks out is met from each of its triangles, alike.
/// @param edges  bit i: the feature lies on edge i.
Leaning leaning_of(const Solid& triangle, std::uint32_t edges, const Vec<3>& normal);

/// The corner of a triangle to which an edge leads, which is also the edge after it.
constexpr std::uint32_t next_corner(std::uint32_t edge) {
  return edge == 2 ? 0 : edge + 1;
}

/// The two edges that meet in a corner, as bits.
constexpr std::uint32_t edges_at(std::uint32_t corner) {
  return (1u << corner) | (1u << (corner == 0 ? 2u : corner - 1u));
}

}  // namespace cycloid::solver
