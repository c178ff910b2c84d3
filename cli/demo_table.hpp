#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "cli/output.hpp"

namespace cycloid::cli {

/// One of those who must agree: the server, a client or the replay.
struct DemoPart {
  std::string name;
  std::string role;
  bool there = false;  ///< It ended and said how.
  std::uint64_t ticks = 0;
  std::string digest;
  std::uint64_t ticks_present = 0;  ///< From joining to the end.
  std::uint64_t bytes_in = 0;
  std::uint64_t bytes_out = 0;
};

struct DemoResult {
  std::string scene;
  std::string log;
  std::uint64_t ticks = 0;  ///< Wanted of every part.
  std::vector<DemoPart> parts;
  double worst_tick_ms = 0.0;
  double tick_ms = 0.0;
  std::uint64_t inputs_replaced = 0;
  std::vector<std::string> failures;  ///< What went wrong and what to do about it.
};

/// Adds a failure for each part that is missing, fell short or disagrees with the first.
void judge(DemoResult& result);

void print_table(const DemoResult& result);
Json to_json(const DemoResult& result);

}  // namespace cycloid::cli
