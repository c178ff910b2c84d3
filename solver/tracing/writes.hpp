#pragma once

#include <string>
#include <vector>

#include "solver/trace.hpp"

namespace cycloid::solver {

/// "sweep, substep 0, sweep 1"
std::string point_text(const TracePoint& at);

/// The phases of one step that change a field of the state, in their order: in the state itself or
/// in what the step works on under the same name ("velocity[0]"), or as its change
/// ("delta_position[0]" for "position[0]"). Empty where the step leaves the field alone.
/// @param trace  World::trace_state, then World::step_traced with `wants_fields` naming the object.
/// @param object, field  As in a TracedField: "contact 7", "points[0].normal_impulse".
std::vector<TracePoint> phases_that_write(const StepTrace& trace, const std::string& object,
                                          const std::string& field);

}  // namespace cycloid::solver
