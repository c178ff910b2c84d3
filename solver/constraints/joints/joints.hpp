#pragma once

#include "solver/constraints/rows.hpp"

namespace cycloid::solver {

/// The rows of each kind of joint; joints/*.cpp have C, Cdot, J, limits and sources. Kinds that
/// exist in the plane or in space only write nothing in the other, where `validate` refuses them.

template <int D>
void distance_rows(const JointFrame<D>& frame, JointRows<D>& rows);
template <int D>
void revolute_rows(const JointFrame<D>& frame, JointRows<D>& rows);
template <int D>
void prismatic_rows(const JointFrame<D>& frame, JointRows<D>& rows);
template <int D>
void wheel_rows(const JointFrame<D>& frame, JointRows<D>& rows);
template <int D>
void weld_rows(const JointFrame<D>& frame, JointRows<D>& rows);
template <int D>
void motor_rows(const JointFrame<D>& frame, JointRows<D>& rows);
template <int D>
void target_rows(const JointFrame<D>& frame, JointRows<D>& rows);
template <int D>
void gear_rows(const JointFrame<D>& frame, JointRows<D>& rows);
template <int D>
void pulley_rows(const JointFrame<D>& frame, JointRows<D>& rows);
template <int D>
void curve_rows(const JointFrame<D>& frame, JointRows<D>& rows);
template <int D>
void hinge_rows(const JointFrame<D>& frame, JointRows<D>& rows);
template <int D>
void cone_twist_rows(const JointFrame<D>& frame, JointRows<D>& rows);

}  // namespace cycloid::solver
