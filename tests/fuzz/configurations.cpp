#include "server/config/config.hpp"
#include "tests/fuzz/targets.hpp"

namespace cycloid::fuzz {
namespace {

const char* const kConfiguration = R"(
[server]
port = 7777
threads = 2
[limits]
rooms = 12
catch_up_ticks = 8
[admission]
tokens = "ignored"
[operation]
enabled = true
[template.duel]
scene = "half-pipe"
on_first_join = true
tick_rate_hz = 60.0
[[room]]
name = "arena"
template = "duel"
)";

Seed bytes_of(const std::string& text) {
  const auto* data = reinterpret_cast<const std::byte*>(text.data());
  return {data, data + text.size()};
}

scenes::Loaded load_catalogue_scene(const std::string& name) {
  if (name == "half-pipe") return scenes::find(name);
  return {std::nullopt, {{"", "no such scene"}}};
}

}  // namespace

void run_configuration(Input input) {
  const unsigned mode = mode_of(input);
  const Seed bytes = mode % 2 == kRawMode ? Seed{input.begin(), input.end()}
                                          : edited(bytes_of(kConfiguration), input);
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const server::ConfigResult read = server::read_config(text, load_catalogue_scene);
  if (read.config.has_value() != read.mistakes.empty())
    fail("a configuration is taken with mistakes, or refused without");
  for (const server::ConfigMistake& mistake : read.mistakes) {
    if (mistake.reason.empty()) fail("a mistake without a reason");
  }
}

std::vector<Seed> configuration_seeds() {
  return {with_mode(kRawMode, bytes_of(kConfiguration)),
          with_mode(kEditMode, std::vector<std::byte>(8, std::byte{0})),
          with_mode(kEditMode, std::vector<std::byte>(16, std::byte{3}))};
}

}  // namespace cycloid::fuzz
