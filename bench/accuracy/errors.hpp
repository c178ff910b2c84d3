#pragma once

#include <optional>
#include <span>
#include <string_view>

#include "bench/accuracy/measure.hpp"

namespace cycloid::accuracy {

/// One number that says how wrong a setting is: what a chart draws, less is better.
struct ErrorKind {
  const char* name;   ///< "position"
  const char* label;  ///< With its unit, for an axis.
  /// Nothing where the metrics have none.
  std::optional<double> (*of)(const Measured& measured);
};

/// All of them; "position", `position_error_m`, is the first.
std::span<const ErrorKind> error_kinds();

/// Null where there is none of this name.
const ErrorKind* find_error_kind(std::string_view name);

}  // namespace cycloid::accuracy
