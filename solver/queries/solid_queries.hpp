#pragma once

#include "solver/queries/casting.hpp"
#include "solver/queries/separation.hpp"

namespace cycloid::solver {

/// What queries in space are made of. All cores are in one frame, lengths in m. @pre no half-space.

/// The nearest points of two cores, without their roundings.
struct NearestPoints {
  bool enclosed = false;  ///< The cores overlap; nothing else is set then.
  bool touching = false;  ///< Too near for a direction: within 1e-6 of their size.
  float distance = 0.0f;
  /// Between the planes across `normal`: less than the distance where rounding has turned that.
  float gap = 0.0f;
  Vec<3> normal;  ///< Unit, from a to b, unless touching.
  Vec<3> on_a;
  Vec<3> on_b;
};

/// At most 64 steps of the Gilbert-Johnson-Keerthi algorithm, which end sooner where a corner comes
/// again, or the distance no longer shrinks, or its bounds differ by less than rounding; points and
/// lines by formula. Never stalls: each step but the last lessens the distance.
/// Source: van den Bergen, "Collision Detection in Interactive 3D Environments" (2003), 4.3.
NearestPoints nearest_points(const Core<3>& a, const Core<3>& b);

/// The separation along the best axis of the cores: face normals of both, then cross products of
/// edges whose arcs on the Gauss map cross. A triangle is left along its own normal. Exact for
/// cores that overlap; ties go to the first found. Rods without faces part along the common
/// perpendicular, or upwards.
/// Source: Gregorius, "The Separating Axis Test between Convex Polyhedra" (GDC 2013).
Separation<3> separation_across(const Core<3>& a, const Core<3>& b);

/// The nearest points where cores are apart, otherwise `separation_across`.
Separation<3> separation_of_cores(const Core<3>& a, const Core<3>& b);

/// As `enter`: by formula for a point or ball against a point or line, and for a ray against faces;
/// otherwise by advancing along the separating plane, which cannot lead past the contact.
Entry<3> enter_core(const Core<3>& core, const Core<3>& probe, const Vec<3>& translation);

/// Whether the point is inside of the faces of a core; false for a triangle.
bool encloses(const Core<3>& core, const Vec<3>& point);

/// The corners of a box, a hull or a triangle, with its faces.
void place_vertices(const Shape<3>& shape, const Rotation<3>& rotation, const Vec<3>& position,
                    const Polyhedra& polyhedra, Core<3>& core);

}  // namespace cycloid::solver
