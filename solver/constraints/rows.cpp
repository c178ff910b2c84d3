#include "solver/constraints/rows.hpp"

#include "solver/constraints/joints/joints.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

Spin<2> rotation_error(const JointFrame<2>& frame) {
  return {{atan2(frame.relative[1], frame.relative[0])}};
}
Spin<3> rotation_error(const JointFrame<3>& frame) {
  const Rotation<3>& q = frame.relative;
  const float twice = q[3] < 0.0f ? -2.0f : 2.0f;
  // The axis of `relative` is the same in the frame of b.
  return rotate(frame.rotation_b, Vec<3>{{twice * q[0], twice * q[1], twice * q[2]}});
}

template <int D>
void rows_of(const JointFrame<D>& frame, JointRows<D>& rows) {
  switch (frame.joint.kind) {
    case JointKind::kDistance:
      return distance_rows(frame, rows);
    case JointKind::kRevolute:
      return revolute_rows(frame, rows);
    case JointKind::kPrismatic:
      return prismatic_rows(frame, rows);
    case JointKind::kWheel:
      return wheel_rows(frame, rows);
    case JointKind::kWeld:
      return weld_rows(frame, rows);
    case JointKind::kMotor:
      return motor_rows(frame, rows);
    case JointKind::kTarget:
      return target_rows(frame, rows);
    case JointKind::kGear:
      return gear_rows(frame, rows);
    case JointKind::kPulley:
      return pulley_rows(frame, rows);
    case JointKind::kCurve:
      return curve_rows(frame, rows);
    case JointKind::kHinge:
      return hinge_rows(frame, rows);
    case JointKind::kConeTwist:
      return cone_twist_rows(frame, rows);
    case JointKind::kUser:
    case JointKind::kFree:
      return;
  }
}

template void rows_of(const JointFrame<2>&, JointRows<2>&);
template void rows_of(const JointFrame<3>&, JointRows<3>&);

}  // namespace cycloid::solver
