#include "scenes/accuracy.hpp"

#include <algorithm>
#include <type_traits>

#include "scenes/fields.hpp"
#include "solver/version.hpp"

namespace cycloid::scenes {

/// Calls f(name, a's field, b's field) for every field of two tunings.
template <class F>
static void for_each_pair(solver::Tuning& a, solver::Tuning& b, F&& f) {
  fields(a, [&](const std::string_view name, auto& of_a) {
    fields(b, [&](const std::string_view other, auto& of_b) {
      if constexpr (std::is_same_v<decltype(of_a), decltype(of_b)>)
        if (name == other) f(name, of_a, of_b);
    });
  });
}

bool is_of_method(std::string_view field) {
  static constexpr std::string_view kOfScene[] = {
      "restitution_threshold", "speculative_distance", "sleep_s",
      "sleep_speed",           "continuous",           "particle_substeps",
      "particle_sweeps",       "particle_damping"};
  return std::find(std::begin(kOfScene), std::end(kOfScene), field) == std::end(kOfScene);
}

bool states_accuracy(const Scene& scene) {
  const SceneAccuracy& accuracy = scene.accuracy;
  if (accuracy.error_m != 0.0f || accuracy.error_percent != 0.0f) return true;
  bool chosen = accuracy.tuned.solver_version != 0;
  solver::Tuning choice = accuracy.tuned.tuning;
  solver::Tuning defaults;
  for_each_pair(choice, defaults, [&](auto, auto& a, auto& b) { chosen = chosen || a != b; });
  return chosen;
}

bool lacks_choice(const Scene& scene) {
  return states_accuracy(scene) && scene.accuracy.tuned.solver_version != solver::kSolverVersion;
}

solver::Tuning solved_by(const solver::Tuning& scene, const solver::Tuning& method) {
  solver::Tuning tuning = scene;
  solver::Tuning from = method;
  for_each_pair(tuning, from, [](auto name, auto& to, const auto& of_method) {
    if (is_of_method(name)) to = of_method;
  });
  return tuning;
}

solver::Tuning tuning_of(const Scene& scene) {
  return states_accuracy(scene) ? solved_by(scene.tuning, scene.accuracy.tuned.tuning)
                                : scene.tuning;
}

std::string tuning_path(const Scene& scene, const std::string& field) {
  const bool chosen = states_accuracy(scene) && is_of_method(field);
  return (chosen ? "/accuracy/tuned/tuning/" : "/tuning/") + field;
}

void store_choice(Scene& scene, const solver::Tuning& tuning) {
  solver::Tuning from = tuning;
  solver::Tuning defaults;
  scene.accuracy.tuned = {solver::kSolverVersion, {}};
  for_each_pair(scene.accuracy.tuned.tuning, from, [](auto name, auto& to, const auto& chosen) {
    if (is_of_method(name)) to = chosen;
  });
  for_each_pair(scene.tuning, defaults, [](auto name, auto& to, const auto& value) {
    if (is_of_method(name)) to = value;
  });
}

static bool is_good_error(float value, float upper) {
  return value == 0.0f || (value > 0.0f && value <= upper);
}

/// A method in two places, and a wish of the scene among the choice.
static void check_places(const Scene& scene, std::vector<Mistake>& mistakes) {
  solver::Tuning stated = scene.tuning;
  solver::Tuning chosen = scene.accuracy.tuned.tuning;
  solver::Tuning defaults;
  for_each_pair(stated, defaults, [&](auto name, const auto& value, const auto& usual) {
    if (value != usual && is_of_method(name))
      mistakes.push_back({"/tuning/" + std::string(name),
                          "states a method where /accuracy asks for one to be chosen: leave out "
                          "one of the two"});
  });
  for_each_pair(chosen, defaults, [&](auto name, const auto& value, const auto& usual) {
    if (value != usual && !is_of_method(name))
      mistakes.push_back({"/accuracy/tuned/tuning/" + std::string(name),
                          "is no part of a method: state it in /tuning"});
  });
}

void check_accuracy(const Scene& scene, Untuned untuned, std::vector<Mistake>& mistakes) {
  if (!states_accuracy(scene)) return;
  const SceneAccuracy& accuracy = scene.accuracy;
  if (!is_good_error(accuracy.error_m, 1000.0f))
    mistakes.push_back({"/accuracy/error_m", "has to be above 0 and at most 1000"});
  if (!is_good_error(accuracy.error_percent, 100.0f))
    mistakes.push_back({"/accuracy/error_percent", "has to be above 0 and at most 100"});
  if (accuracy.error_m != 0.0f && accuracy.error_percent != 0.0f)
    mistakes.push_back({"/accuracy", "states error_m and error_percent: leave out one of the two"});
  if (accuracy.error_m == 0.0f && accuracy.error_percent == 0.0f)
    mistakes.push_back({"/accuracy", "has to state error_m or error_percent"});
  check_places(scene, mistakes);
  if (untuned == Untuned::kAllowed || !lacks_choice(scene)) return;
  const std::uint32_t version = accuracy.tuned.solver_version;
  const std::string what = version == 0
                               ? "is missing: the setting for this accuracy has not been chosen"
                               : "was chosen by solver version " + std::to_string(version) +
                                     ", this is " + std::to_string(solver::kSolverVersion);
  mistakes.push_back({"/accuracy/tuned", what + "; 'cycloid tune SCENE --write' chooses and stores"
                                                " one"});
}

}  // namespace cycloid::scenes
