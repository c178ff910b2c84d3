#include <chrono>
#include <ctime>
#include <iostream>
#include <memory>

#include "cli/commands.hpp"
#include "cli/log_file.hpp"
#include "cli/output.hpp"

namespace cycloid::cli {
namespace {

struct InfoOptions {
  std::string log;
  LoadOptions loading;
};

const char* state_name(protocol::LogState state) {
  switch (state) {
    case protocol::LogState::kComplete:
      return "complete";
    case protocol::LogState::kOpen:
      return "open";
    case protocol::LogState::kTorn:
      return "torn";
    case protocol::LogState::kCorrupt:
      return "corrupt";
    case protocol::LogState::kIncompatible:
      return "incompatible";
  }
  return "unknown";
}

/// "2026-11-21T16:41:39Z", or "" for a log that says no time.
std::string time_text(std::int64_t unix_ns) {
  if (unix_ns == 0) return "";
  const std::time_t seconds = unix_ns / 1'000'000'000;
  char text[32] = "";
  if (const std::tm* parts = std::gmtime(&seconds))
    (void)std::strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", parts);
  return text;
}

Json json_of(const LoadedLog& loaded) {
  const protocol::LogSummary& log = loaded.log;
  const protocol::LogHeader& header = log.header;
  Json keyframes = Json::array();
  for (const protocol::KeyframePlace& place : log.keyframes)
    keyframes.push_back({{"tick", place.tick}, {"at", place.at}});
  Json object = {{"log", loaded.file},
                 {"state", state_name(log.state)},
                 {"blemish", loaded.blemish()},
                 {"format", protocol::kLogFormat},
                 {"schema", header.schema},
                 {"protocol_version", header.protocol_version},
                 {"solver_version", header.solver_version},
                 {"build", header.build},
                 {"scene", header.scene_name},
                 {"scene_digest", hex16(header.scene_digest)},
                 {"scene_bytes", header.scene.size()},
                 {"tick_rate_millihertz", header.tick_rate_millihertz},
                 {"room", header.room},
                 {"start", time_text(header.start_unix_ns)},
                 {"log_id", hex16(header.log_id)},
                 {"parent_log_id", nullptr},
                 {"first_tick", loaded.first_tick()},
                 {"last_tick", log.last_tick},
                 {"ticks", log.tick_count()},
                 {"digest", hex16(log.last_digest)},
                 {"good_bytes", log.good_bytes},
                 {"lost_bytes", log.lost_bytes},
                 {"keyframe_bytes", log.keyframe_bytes},
                 {"keyframes", keyframes}};
  if (header.parent_log_id != 0) object["parent_log_id"] = hex16(header.parent_log_id);
  return object;
}

Exit print_info(const InfoOptions& options, bool json) {
  const LoadedLog loaded = load_log(options.log, options.loading);
  Json object = json_of(loaded);
  const Exit exit = loaded.exit();
  if (json) {
    print_json(std::move(object), exit);
    return exit;
  }
  object["keyframes"] = loaded.log.keyframes.size();
  for (const auto& [name, value] : object.items()) {
    if (value.is_null() || value == "") continue;
    print_member(name, value);
  }
  return exit;
}

}  // namespace

void add_info(CLI::App& app, Action& action) {
  auto options = std::make_shared<InfoOptions>();
  CLI::App* command =
      add_command(app, "info", "Print what a log is of, how far it goes and how it ends", action);
  command->add_option("LOG", options->log, "A .cylog file")->required();
  add_salvage_option(command, options->loading);
  command->callback([options, &action] {
    action.run = [=, &action] { return print_info(*options, action.json); };
  });
}

}  // namespace cycloid::cli
