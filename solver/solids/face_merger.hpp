#pragma once

#include "solver/solids/hull_builder.hpp"
#include "solver/solids/integer_hull.hpp"

namespace cycloid::solver {

/// Makes faces of the triangles of a hull: neighbours within `tolerance` [grid steps] to either
/// side of a common plane become one, in the order of the edges between them, until none are left.
/// Fills faces (normal and edge), edges and the edges of vertices in the order that
/// build_polyhedron states; corner i is points[i] and all are in use.
void link_faces(std::span<const GridPoint> points, std::span<const GridTriangle> triangles,
                float tolerance, PolyhedronData& out);

}  // namespace cycloid::solver
