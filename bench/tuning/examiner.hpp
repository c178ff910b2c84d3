#pragma once

#include <functional>
#include <string>
#include <vector>

#include "bench/accuracy/measure.hpp"
#include "bench/tuning/asked_error.hpp"
#include "bench/tuning/needs.hpp"
#include "bench/tuning/passage.hpp"

namespace cycloid::tuning {

/// Takes a part out of a scene.
using Drop = std::function<void(scenes::Scene&)>;

/// One scene at one setting, with and without its parts.
class Examiner {
 public:
  /// All three have to outlive it.
  Examiner(const scenes::Scene& scene, const accuracy::Setting& setting,
           const NeedsRequest& request);

  PartNeed rotation();
  PartNeed tangents();
  PartNeed sleep();
  PartNeed continuous();
  PartNeed third_axis() const;
  PartNeed all();

 private:
  Passage run(const scenes::Scene& scene) const {
    return run_passage(accuracy::with_setting(scene, setting_), request_.ticks);
  }
  RunFigures figures_of(const scenes::Scene& scene, const Passage& passage) const;
  void time_both(const scenes::Scene& without, PartNeed& need) const;
  double moved_without(const scenes::Scene& without) const;
  void compare(const Drop& drop, PartNeed& need);
  bool is_needed(double moved_m) const { return !(moved_m <= request_.bound_m); }
  std::vector<std::size_t> idle_frictions() const;
  std::string bound_text() const { return length_text(request_.bound_m); }

  const scenes::Scene& scene_;
  const accuracy::Setting& setting_;
  const NeedsRequest& request_;
  accuracy::MeasureOptions options_;
  Passage base_;
  RunFigures figures_;
  std::vector<Drop> drops_;  ///< Of what is not needed.
};

}  // namespace cycloid::tuning
