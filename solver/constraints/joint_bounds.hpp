#pragma once

namespace cycloid::solver {

// A limit is solved where it pushes already or could be reached soon. What is farther away would be
// solved to an impulse of 0, and its held rows are a good part of a joint's cost.

/// How far ahead, at the present speed.
inline constexpr float kLimitReach_substeps = 4.0f;
/// And what the sweeps may do to the coordinate besides, m or rad.
inline constexpr float kLimitRoom = 0.1f;

/// Of 1 + u . u' of an axis u and the same as another body carries it: within 0.014 rad of the
/// other way round, neither twist nor tangent has digits.
inline constexpr float kLeastTogether = 1.0e-4f;

}  // namespace cycloid::solver
