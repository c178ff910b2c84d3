#pragma once

#include <string>

#include "bench/accuracy/chart.hpp"

namespace cycloid::rivals {

/// Markdown: a line for each trial of a charted plan, a column for each setting, and in it what the
/// judge says as docs/stability.md says it; "-" where the engine took no part. The last line
/// counts.
std::string outcome_table(const accuracy::ChartPlan& plan);

}  // namespace cycloid::rivals
