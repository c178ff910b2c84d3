#pragma once

#include <cstdint>

#include "bench/trials/judges.hpp"
#include "scenes/scene.hpp"

namespace cycloid::trials {

/// By how much a component of a velocity is changed at most, in steps of 1 um/s: far above what
/// rounding does, far below what anybody sees.
inline constexpr std::int32_t kPerturbationMax_um_s = 1000;

/// One of many starts of the same scene.
struct Start {
  std::uint64_t seed = 1;
  std::uint32_t run = 0;  ///< 0 is the scene as it is.
};

/// Changes every component of the velocity of every body that responds to forces, each by a number
/// of its own that depends on the start and on the place of the body in the scene alone: equal for
/// every method, on every machine, and however many other runs there are.
void perturb(scenes::Scene& scene, const Start& start);

/// What comes of a trial that begins so. Start 0 is `judge(trial, method)`.
Outcome judge_from(const scenes::Trial& trial, const solver::Tuning& method, const Start& start);

}  // namespace cycloid::trials
