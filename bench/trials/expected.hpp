#pragma once

#include <map>
#include <string>
#include <string_view>
#include <utility>

namespace cycloid::trials {

using TrialAndMethod = std::pair<std::string, std::string>;

/// What every trial came to under every method when somebody last looked: by trial and method, the
/// text of the outcome ("sags 0.123").
using ExpectedTable = std::map<TrialAndMethod, std::string>;

/// Reads lines of "trial method outcome". @returns false, and sets `mistake` to the line and what
/// is wrong with it, leaving `table` as it was.
bool read_expected(std::string_view text, ExpectedTable& table, std::string& mistake);

/// The same lines, in the order of `scenes::trials()` and `methods()`; trials that the table lacks
/// are left out.
std::string expected_text(const ExpectedTable& table);

/// The text of an outcome as a cell: "**0.0123**" stands, "0.123" sags, "x 1.2" fails.
std::string outcome_cell(const std::string& outcome);

/// Rows of trials, columns of the methods that have a cell, for docs/stability.md.
std::string table_markdown(const std::map<TrialAndMethod, std::string>& cells);

/// The table of these outcomes.
std::string expected_markdown(const ExpectedTable& table);

}  // namespace cycloid::trials
