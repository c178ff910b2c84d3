#pragma once

namespace cycloid::solver {

/// How far from each other two shapes are at their impact, and by how much it may be less.
inline constexpr float kImpactTarget_m = 0.01f;
inline constexpr float kImpactTolerance_m = 0.002f;

}  // namespace cycloid::solver
