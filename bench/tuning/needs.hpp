#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "bench/accuracy/settings.hpp"
#include "scenes/scene.hpp"

namespace cycloid::tuning {

/// What a run costs and how wrong it is.
struct RunFigures {
  double rows_per_tick = 0.0;
  double turning_rows_per_sweep = 0.0;  ///< Contact rows with an angular part.
  std::uint64_t state_bytes = 0;
  double us_per_tick = 0.0;  ///< Processor time, the least of several interleaved runs.
  double error_m = 0.0;      ///< accuracy::position_error_m.
};

enum class PartVerdict : std::uint32_t {
  kNeeded,     ///< Without it the bodies go elsewhere.
  kNotNeeded,  ///< Shown by running without it.
  kNotThere,   ///< The scene does without it already.
  kNoSwitch    ///< Not needed, and nothing in a scene turns it off.
};

/// "needed", "not needed", ...
const char* name_of(PartVerdict verdict);

/// A part of the model, and whether the scene needs it. What is said holds for the scene's script:
/// a player may do what it does not.
struct PartNeed {
  std::string part;  ///< "rotation", "tangents", "sleep", "continuous", "3D".
  PartVerdict verdict = PartVerdict::kNeeded;
  std::string finding;    ///< A sentence: what was seen.
  std::string change;     ///< What to write into the scene; "" where there is nothing.
  bool measured = false;  ///< Whether the following were: the scene ran without the part.
  RunFigures with;
  RunFigures without;
  double moved_m = 0.0;  ///< The furthest that any point of a body is from where it was with it.
};

/// How the parts are looked at.
struct NeedsRequest {
  /// A part is needed if without it any point of a body is ever further than this from where it is
  /// with it, m.
  double bound_m = 0.001;
  std::uint32_t ticks = 300;
};

/// Looks at each part in turn: rotation, tangents, sleep, continuous collision, the third axis.
/// Last comes "all", without all that is not needed, where that is more than one part.
/// @param scene  states no accuracy and has no mistake.
/// @pre accuracy::is_method(setting.method)
std::vector<PartNeed> find_needs(const scenes::Scene& scene, const accuracy::Setting& setting,
                                 const NeedsRequest& request);

}  // namespace cycloid::tuning
