#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace cycloid::load {

/// How long newcomers waited for their first whole state, in a match of one age.
struct JoinAge {
  std::uint64_t tick = 0;  ///< Of the match when the first of them came.
  int joins = 0;
  double p50_ms = 0.0;
  double max_ms = 0.0;
  double resident_mb = 0.0;  ///< Of the server.
};

/// A room of 64 bodies with a log and a player, which makes 2,000 ticks a second so that an hour of
/// a match at 60 Hz is over in two minutes; at each age newcomers join it, one after the other.
/// @param ages  In ticks, ascending.
/// @throws std::runtime_error where somebody is not let in, or the match does not grow so old.
std::vector<JoinAge> measure_joins(const std::string& program,
                                   const std::vector<std::uint64_t>& ages);

}  // namespace cycloid::load
