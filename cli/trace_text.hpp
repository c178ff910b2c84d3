#pragma once

#include <optional>
#include <string>

#include "cli/match.hpp"
#include "cli/output.hpp"
#include "solver/tracing/writes.hpp"

namespace cycloid::cli {

/// What `cycloid trace --tick --json` prints, and what `cycloid bisect` reads of another build.
Json to_json(const TickTrace& trace);
/// None where it is not such an object.
std::optional<TickTrace> trace_from_json(const Json& json);

/// The phase of that name, or none.
std::optional<solver::Phase> phase_of(const std::string& name);

}  // namespace cycloid::cli
