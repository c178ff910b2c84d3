#pragma once

#include <array>

#include "solver/dim.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// One scalar constraint between two bodies.
///
///   Cdot = linear_a . v_a + angular_a . w_a + linear_b . v_b + angular_b . w_b + rate
///
/// The four vectors are the row's Jacobian J; v [m/s] of the centres of mass, w [rad/s], world
/// axes. `error` is C in m or rad, `rate` its partial derivative in time, C being C(x, t). While a
/// row of a user's states a rate other than 0, what its joint holds on to stays awake or wakes.
template <int D>
struct Row {
  Vec<D> linear_a = Vec<D>::zero();
  Spin<D> angular_a = Spin<D>::zero();
  Vec<D> linear_b = Vec<D>::zero();
  Spin<D> angular_b = Spin<D>::zero();
  float error = 0.0f;
  float rate = 0.0f;
};

/// One more row that joints of space may have, whose error has an upper limit: the swing of a cone.
template <int D>
struct ConeRow {
  void drop_cone() {}
};
template <>
struct ConeRow<3> {
  bool has_cone_axis = false;
  Row<3> cone_axis;

  void drop_cone() { has_cone_axis = false; }
};

/// What a joint asks for at the present poses.
///
/// Rows [0, count) are equalities C = 0. Those before `split` are solved together as one block, and
/// so are those from it on; a block may yield where its joint says so. `axis` is one more row,
/// whose error is the joint's coordinate: springs, limits and, unless `motor_axis` is another,
/// motors act along it.
template <int D>
struct JointRows : ConeRow<D> {
  int count = 0;
  int split = 0;
  std::array<Row<D>, Dim<D>::kFreedoms> rows;
  bool has_axis = false;
  bool has_motor_axis = false;
  Row<D> axis;
  Row<D> motor_axis;

  /// Has no rows from now on; what stood in them is left.
  void drop() {
    this->drop_cone();
    count = split = 0;
    has_axis = has_motor_axis = false;
  }

  /// As JointRows{}, but `rows` keeps what nobody reads: whoever appends a row assigns the whole of
  /// it.
  void clear() {
    static_cast<ConeRow<D>&>(*this) = ConeRow<D>{};
    count = 0;
    split = 0;
    has_axis = false;
    has_motor_axis = false;
    axis = Row<D>{};
    motor_axis = Row<D>{};
  }
};

/// The two bodies of a joint as its rows see them. World axes; m and rad.
template <int D>
struct JointFrame {
  const WorldState<D>& state;  ///< For curves made of shapes: their records, not their poses.
  const Joint<D>& joint;
  Vec<D> position_a;  ///< Centres of mass.
  Vec<D> position_b;
  Rotation<D> rotation_a;
  Rotation<D> rotation_b;
  Vec<D> r_a;  ///< Anchors from the centres.
  Vec<D> r_b;
  Vec<D> offset;         ///< Anchor b from anchor a.
  Rotation<D> relative;  ///< Rotation of b relative to a since creation, in a's frame.
  float time_s;          ///< Since tick 0.
};

/// A function that writes rows: every kind of joint is one, and a user may register his own.
/// It depends on the frame alone, or replays diverge; libm is not the same everywhere
/// (solver/trig.hpp is). What it leaves alone stays as in JointRows{}. Where it does not leave
/// 0 <= split <= count <= Dim<D>::kFreedoms, the joint has no rows.
template <int D>
using RowsFunction = void (*)(const JointFrame<D>& frame, JointRows<D>& rows);

/// Has a joint's function write its rows. Counts out of bounds leave none, so that no later stage
/// has to look. @pre rows are cleared.
template <int D>
void write_rows(RowsFunction<D> function, const JointFrame<D>& frame, JointRows<D>& rows) {
  function(frame, rows);
  if (rows.split < 0 || rows.split > rows.count || rows.count > Dim<D>::kFreedoms) rows.drop();
}

/// @param centre_offset  centre of b from centre of a: kept apart from the positions because far
/// from the origin their difference has no digits left.
template <int D>
JointFrame<D> make_frame(const WorldState<D>& state, const Joint<D>& joint,
                         const Vec<D>& position_a, const Vec<D>& centre_offset,
                         const Rotation<D>& rotation_a, const Rotation<D>& rotation_b,
                         float time_s) {
  const Vec<D> r_a = rotate(rotation_a, joint.anchor_a);
  const Vec<D> r_b = rotate(rotation_b, joint.anchor_b);
  return {state,
          joint,
          position_a,
          position_a + centre_offset,
          rotation_a,
          rotation_b,
          r_a,
          r_b,
          centre_offset + (r_b - r_a),
          compose(conjugate(joint.reference), compose(conjugate(rotation_a), rotation_b)),
          time_s};
}

/// The rows of a joint where its bodies stand between ticks. @param time_s  since tick 0.
template <int D>
JointRows<D> rows_between_ticks(const WorldState<D>& state, const Joint<D>& joint,
                                RowsFunction<D> function, float time_s) {
  const Body<D>& a = state.bodies[joint.body_a];
  const Body<D>& b = state.bodies[joint.body_b];
  JointRows<D> rows{};
  write_rows(
      function,
      make_frame(state, joint, a.position, b.position - a.position, a.rotation, b.rotation, time_s),
      rows);
  return rows;
}

/// C = direction . (anchor_b - anchor_a) with a direction that turns with body a:
///   J = (-u, -(r_a + d) x u, u, r_b x u),  d = anchor_b - anchor_a.
template <int D>
Row<D> translation_row(const JointFrame<D>& frame, const Vec<D>& direction) {
  Row<D> row;
  row.linear_a = -direction;
  row.angular_a = -moment(frame.r_a + frame.offset, direction);
  row.linear_b = direction;
  row.angular_b = moment(frame.r_b, direction);
  row.error = dot(direction, frame.offset);
  return row;
}

/// Directions across `joint.axis`, in the world.
inline void directions_across(const JointFrame<2>& frame, Vec<2> (&out)[1]) {
  tangents(rotate(frame.rotation_a, frame.joint.axis), out);
}
/// In space they have to turn with a: a basis chosen in the world would jump as the axis turns, and
/// with it the impulses that the next substep starts from.
inline void directions_across(const JointFrame<3>& frame, Vec<3> (&out)[2]) {
  tangents(frame.joint.axis, out);
  for (Vec<3>& direction : out) direction = rotate(frame.rotation_a, direction);
}

/// C = anchor_b - anchor_a along the axes of body a: D rows. Because the axes turn with a, both
/// impulses of a row act at anchor b, and angular momentum is kept to rounding whatever the error;
/// along axes of the world they would act |C| apart.
template <int D>
void append_point_rows(const JointFrame<D>& frame, JointRows<D>& rows) {
  Vec<D> axes[D];
  rotated_axes(frame.rotation_a, axes);
  for (const Vec<D>& axis : axes)
    rows.rows[static_cast<std::size_t>(rows.count++)] = translation_row(frame, axis);
}

/// The rotation of b relative to a since creation as a vector in the world frame, rad: exact in the
/// plane; in space of length 2 sin(angle / 2), the shorter way round.
Spin<2> rotation_error(const JointFrame<2>& frame);
Spin<3> rotation_error(const JointFrame<3>& frame);

/// C = rotation of b relative to a since creation, as a vector in the world frame:
///   J_i = (0, -e_i, 0, e_i), exact in the plane and, in space, to first order in C.
template <int D>
void append_rotation_rows(const JointFrame<D>& frame, JointRows<D>& rows) {
  const Spin<D> error = rotation_error(frame);
  for (int i = 0; i < Dim<D>::kSpin; ++i) {
    Row<D>& row = rows.rows[static_cast<std::size_t>(rows.count++)];
    row = Row<D>{};
    row.angular_a[i] = -1.0f;
    row.angular_b[i] = 1.0f;
    row.error = error[i];
  }
}

/// Rows of a joint of any built-in kind. kUser: nothing; the world calls the registered function.
template <int D>
void rows_of(const JointFrame<D>& frame, JointRows<D>& rows);

}  // namespace cycloid::solver
