#pragma once

#include "solver/constraints/rows.hpp"

namespace cycloid::solver {

/// Rows of the rotation of b relative to a that tell a turn about an axis (twist) from a turn of
/// the axis itself (swing). All are couples, J_a = -J_b, so they leave angular momentum as it is.

/// An axis of a and the same axis as b carries it since creation; world frame, unit.
struct AxisPair {
  Vec<3> of_a;
  Vec<3> of_b;
};

/// @param axis  unit, frame of a.
AxisPair axis_pair(const JointFrame<3>& frame, const Vec<3>& axis);

/// As above for an axis that a holds at `now` and held at `before` at creation; unit, frame of a.
AxisPair axis_pair(const JointFrame<3>& frame, const Vec<3>& before, const Vec<3>& now);

/// Keeps the axis u' of b along the axis u of a. With e = u x u', s = 1 + u . u' and, for each t in
/// {t_0, t_1}, fixed in a and across u:
///   C = 2 t . e / s, which is twice the tangent of half the angle between u and u',
///   J_b = (2 / s) (u' x (t x u) + (t . e / s) e) = -J_a, which is t where C = 0.
/// The tangent rather than the sine, which would also vanish with u' the other way round.
void append_axis_rows(const AxisPair& pair, const Vec<3>& t_0, const Vec<3>& t_1,
                      JointRows<3>& rows);

/// The turn about `axis` [unit] that is left of a rotation after the swing that takes the axis to
/// where the rotation takes it the short way; rad in (-pi, pi].
float twist_angle(const Rotation<3>& rotation, const Vec<3>& axis);

/// The twist of b about `axis` [unit, frame of a] since creation, rad in (-pi, pi], after the swing
/// that takes u to u' the short way:
///   C = 2 atan2(p, s), s and p being the scalar part of the rotation and its part along the axis,
///   J_b = (u + u') / (1 + u . u') = -J_a.
/// Where the axis points the other way there is no twist: the row vanishes there and gets no
/// impulse. Source: Dobrowolski, "Swing-twist decomposition in Clifford algebra" (2015).
Row<3> twist_row(const JointFrame<3>& frame, const Vec<3>& axis, const AxisPair& pair);

/// The angle between u and u', rad from 0 to pi:
///   C = atan2(|u x u'|, u . u'),  J_b = (u x u') / |u x u'| = -J_a,
/// and a fixed direction across u where the two are parallel and every one would do.
Row<3> swing_row(const AxisPair& pair);

}  // namespace cycloid::solver
