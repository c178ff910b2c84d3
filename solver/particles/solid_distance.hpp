#pragma once

#include "solver/particles/shape_distance.hpp"

namespace cycloid::solver {

// The signed distance of `point` [m, frame of the body] from the core of a shape in space, without
// its radius; the rules of ties and of what is behind are those of `signed_distance`.

/// On the axis the normal is a direction across it.
SignedDistance<3> distance_to_capsule(const Shape<3>& shape, const Vec<3>& point);
SignedDistance<3> distance_to_box(const Shape<3>& shape, const Vec<3>& point);
SignedDistance<3> distance_to_triangle(const Shape<3>& shape, const Vec<3>& point);
SignedDistance<3> distance_to_hull(const Shape<3>& shape, const Vec<3>& point,
                                   const Polyhedra& polyhedra);

}  // namespace cycloid::solver
