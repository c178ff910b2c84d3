#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "bench/trials/judges.hpp"

namespace cycloid::trials {

/// What came of many runs of one trial under one method that begin almost alike.
struct Shares {
  std::uint32_t stands = 0;  ///< How many runs.
  std::uint32_t sags = 0;
  std::uint32_t fails = 0;
  std::string median;  ///< Of the judge's metric, three digits: of an even number of runs the worse
                       ///< one of the two in the middle. "-" where that one has no number.
  std::string worst;   ///< The largest. "-" where a run has no number: its world faulted.

  bool operator==(const Shares&) const = default;
};

/// A run without a number is worse than any with one. @pre there is at least one outcome.
Shares shares_of(std::span<const Outcome> outcomes);

/// "20 0 0 0.0133 0.0145": runs that stand, sag and fail; median, worst.
std::string shares_words(const Shares& shares);

/// Shares by trial and method, all of equally many runs under one seed.
struct ShareTable {
  std::uint32_t runs = 0;
  std::uint64_t seed = 0;
  std::map<std::pair<std::string, std::string>, Shares> shares;
};

/// Reads "runs N seed S" and after it lines of "trial method stands sags fails median worst".
/// @returns false, and sets `mistake` to the line and what is wrong with it, leaving `table` as it
/// was.
bool read_shares(std::string_view text, ShareTable& table, std::string& mistake);

/// The same lines, in the order of `scenes::trials()` and `methods()`; trials that the table lacks
/// are left out.
std::string shares_text(const ShareTable& table);

/// Rows of trials, columns of the methods that the table has, for docs/stability.md.
std::string shares_markdown(const ShareTable& table);

}  // namespace cycloid::trials
