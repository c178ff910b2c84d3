#include "cli/numbers.hpp"

#include <cerrno>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

namespace cycloid::cli {
namespace {

/// What is wrong with a word that one of C's functions has read up to `end`.
std::string whole_mistake(const std::string& word, const char* end) {
  if (word.empty() || *end != '\0') return "'" + word + "' is no whole number";
  return errno == ERANGE ? "'" + word + "' is too large" : "";
}

std::string unsigned_mistake(const std::string& word) {
  if (word.find('-') != std::string::npos) return "'" + word + "' is no whole number from 0";
  char* end = nullptr;
  errno = 0;
  (void)std::strtoull(word.c_str(), &end, 0);
  return whole_mistake(word, end);
}

std::string signed_mistake(const std::string& word) {
  char* end = nullptr;
  errno = 0;
  (void)std::strtoll(word.c_str(), &end, 0);
  return whole_mistake(word, end);
}

std::string real_mistake(const std::string& word) {
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  const bool is_number = !word.empty() && *end == '\0' && std::isfinite(value);
  return is_number ? "" : "'" + word + "' is no number";
}

/// @param type  Of the option, with what it is checked for, as help shows it: "UINT:POSITIVE".
std::string number_mistake(const std::string& type, const std::string& word) {
  const std::string mistake = type.starts_with("UINT")  ? unsigned_mistake(word)
                              : type.starts_with("INT") ? signed_mistake(word)
                                                        : real_mistake(word);
  if (!mistake.empty()) return mistake;
  const double value = std::strtod(word.c_str(), nullptr);
  // The parser itself would refuse such a number without a word of what there is.
  const bool beyond_int = std::abs(value) > double{std::numeric_limits<int>::max()};
  if (type.starts_with("INT:{") && beyond_int)
    return "'" + word + "' not in " + type.substr(type.find('{'));
  if (type.ends_with(":POSITIVE") && !(value > 0.0)) return "'" + word + "' is not above 0";
  if (type.ends_with(":NONNEGATIVE") && value < 0.0) return "'" + word + "' is below 0";
  return "";
}

}  // namespace

void check_numbers(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const std::string type = option->get_type_name();
    if (!type.starts_with("UINT") && !type.starts_with("INT") && !type.starts_with("FLOAT"))
      continue;
    // Checks of the option itself come behind: their words are for numbers that it can hold.
    option->transform(CLI::Validator(
        [type](std::string& word) { return number_mistake(type, word); }, std::string()));
  }
  for (CLI::App* command : app.get_subcommands({})) check_numbers(*command);
}

}  // namespace cycloid::cli
