#include <algorithm>

#include "server/config/config.hpp"
#include "tests/fuzz/targets.hpp"

namespace cycloid::fuzz {

void run_config(Input input) {
  const std::string_view text(reinterpret_cast<const char*>(input.data()), input.size());
  const auto lines = static_cast<std::uint32_t>(std::ranges::count(text, '\n') + 1);
  const server::ConfigResult read = server::read_config(text, scenes::find);
  if (read.config.has_value() != read.mistakes.empty())
    fail("neither a configuration nor a mistake");
  for (const server::ConfigMistake& mistake : read.mistakes) {
    if (mistake.reason.empty()) fail("a configuration is refused without a reason");
    if (mistake.line > lines) fail("a mistake is behind the last line");
  }
  if (!read.config) return;
  const server::ConfigResult again = server::read_config(text, scenes::find);
  if (!again.config || again.config->values != read.config->values)
    fail("a configuration is another one when read again");
  if (!server::fixed_differences(*read.config, *again.config).empty())
    fail("a configuration cannot be taken over by itself");
}

std::vector<Seed> config_seeds() {
  const std::string rooms =
      "[template.duel]\nscene = \"stack-10\"\non_first_join = true\nempty_ttl_s = 60\n"
      "[[room]]\nname = \"arena\"\ntemplate = \"duel\"\n";
  std::vector<std::string> texts = {rooms, "[server]\nport = 0\nthreads = 2\n" + rooms};
  // Every key with what it is otherwise, in a section of its own.
  for (const server::ConfigKeyText& key : server::config_keys()) {
    const std::size_t dot = key.name.rfind('.');
    const bool listed = key.name.starts_with("template.") || key.name.starts_with("room.");
    if (dot == std::string::npos || listed || key.otherwise.empty()) continue;
    texts.push_back("[" + key.name.substr(0, dot) + "]\n" + key.name.substr(dot + 1) + " = " +
                    key.otherwise + "\n" + rooms);
  }
  std::vector<Seed> seeds;
  for (const std::string& each : texts) {
    const auto* begin = reinterpret_cast<const std::byte*>(each.data());
    seeds.emplace_back(begin, begin + each.size());
  }
  return seeds;
}

}  // namespace cycloid::fuzz
