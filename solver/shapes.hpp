#pragma once

#include <vector>

#include "solver/definitions.hpp"
#include "solver/result.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// Appends the records that one definition makes (a chain makes one per edge, a mesh one per
/// triangle), in the body frame. Polygons come out counter-clockwise. A hull goes into `hulls`,
/// about the middle of its bounding box, which is the record's vertices[0]; its `rotation` is the
/// identity.
/// @pre validate(def, ...) is ok. @returns kInvalid "points" for a polygon that is degenerate or
/// not convex, for a chain or capsule with a zero-length edge, and for what build_polyhedron
/// refuses; "triangles" or "heights" for degenerate triangles. Then nothing was appended.
template <int D>
Error append_shapes(const ShapeDef<D>& def, int index, std::vector<Shape<D>>& into,
                    Polyhedra& hulls);

/// The same. @pre the definition is no hull.
template <int D>
Error append_shapes(const ShapeDef<D>& def, int index, std::vector<Shape<D>>& into) {
  Polyhedra none;
  return append_shapes(def, index, into, none);
}

/// Moves a record from the body frame to the frame of the centre of mass.
template <int D>
void shift_shape(const Vec<D>& local_center, Shape<D>& shape);

/// How far the farthest point lies from the centre of mass, m; of a box or hull, of its bounding
/// box. 0 for a half-space.
float extent_of(const Shape<2>& shape);
float extent_of(const Shape<3>& shape);

/// The radius of a ball that fits into its thinnest place, m; of a hull, into that of its bounding
/// box, which may be too large for a hull that lies askew in it; 0 for a triangle.
/// @pre the shape has vertices.
float thickness_of(const Shape<2>& shape);
float thickness_of(const Shape<3>& shape);

}  // namespace cycloid::solver
