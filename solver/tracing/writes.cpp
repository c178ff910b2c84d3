#include "solver/tracing/writes.hpp"

#include <algorithm>

namespace cycloid::solver {

std::string point_text(const TracePoint& at) {
  std::string text = phase_name(at.phase);
  if (at.substep != kNone) text += ", substep " + std::to_string(at.substep);
  if (at.sweep != kNone) text += ", sweep " + std::to_string(at.sweep);
  return text;
}

/// The value of a field after a phase, or null where the phase does not list it.
static const std::string* value_in(const TracedPhase& phase, const std::string& object,
                                   const std::string& field) {
  const auto found = std::find_if(phase.fields.begin(), phase.fields.end(), [&](const auto& it) {
    return it.object == object && it.name == field;
  });
  return found == phase.fields.end() ? nullptr : &found->value;
}

std::vector<TracePoint> phases_that_write(const StepTrace& trace, const std::string& object,
                                          const std::string& field) {
  std::vector<TracePoint> points;
  // Before contacts are found anew, a place in their list is that of another contact.
  const bool is_contact = object.rfind("contact ", 0) == 0;
  const std::string* before = nullptr;
  const std::string* change_before = nullptr;
  for (const TracedPhase& phase : trace.phases) {
    if (is_contact && (phase.at.phase == Phase::kState || phase.at.phase == Phase::kForces))
      continue;
    const std::string* value = value_in(phase, object, field);
    const std::string* change = value_in(phase, object, "delta_" + field);
    const bool changed = value != nullptr && before != nullptr && *value != *before;
    const bool moved = change != nullptr && change_before != nullptr && *change != *change_before;
    if (changed || moved) points.push_back(phase.at);
    if (value != nullptr) before = value;
    if (change != nullptr) change_before = change;
  }
  return points;
}

}  // namespace cycloid::solver
