#pragma once

#include <CLI/CLI.hpp>

namespace cycloid::cli {

/// Has every option of a number, of all commands, refuse what is none that it can hold: the parser
/// would wrap a negative one around, cut a large one off, and take one that is not finite.
void check_numbers(CLI::App& app);

}  // namespace cycloid::cli
