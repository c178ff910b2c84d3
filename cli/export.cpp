#include <iostream>
#include <memory>
#include <optional>

#include "cli/commands.hpp"
#include "cli/log_file.hpp"
#include "cli/output.hpp"
#include "cli/whole_file.hpp"
#include "protocol/text.hpp"

namespace cycloid::cli {
namespace {

struct ExportOptions {
  std::string log;
  LoadOptions loading;
  std::string format = "json";
  std::string out;
};

Json json_of(const protocol::LogTick& tick) {
  Json seats = Json::array();
  for (const protocol::SeatFrame& seat : tick.frame.seats)
    seats.push_back({{"origin", protocol::origin_name(seat.origin)},
                     {"axes", seat.input.axes},
                     {"buttons", seat.input.buttons}});
  Json object = {{"tick", tick.frame.tick}, {"digest", hex16(tick.digest)}, {"seats", seats}};
  Json events = Json::array();
  for (const protocol::FrameEvent& event : tick.frame.events)
    events.push_back({{"kind", protocol::event_kind_name(event.kind)}, {"seat", event.seat}});
  for (const protocol::FrameChange& change : tick.frame.changes)
    events.push_back({{"kind", protocol::change_kind_name(change.kind)}, {"value", change.value}});
  if (!events.empty()) object["events"] = std::move(events);
  return object;
}

/// One object with a tick on each line, so that it is read by line, too.
void write_json(const LoadedLog& loaded, std::ostream& out) {
  const protocol::LogHeader& header = loaded.log.header;
  out << "{\"scene\":" << Json(header.scene_name).dump()
      << ",\"scene_digest\":" << Json(hex16(header.scene_digest)).dump()
      << ",\"solver_version\":" << header.solver_version << ",\"room\":" << Json(header.room).dump()
      << ",\"log_id\":" << Json(hex16(header.log_id)).dump()
      << ",\"blemish\":" << Json(loaded.blemish()).dump() << ",\"ticks\":[";
  TickReader reader(loaded);
  for (std::uint64_t tick = loaded.first_tick(); tick <= loaded.last_tick(); ++tick)
    out << (tick == loaded.first_tick() ? "\n" : ",\n") << json_of(reader.at(tick)).dump();
  out << "\n]}\n";
}

/// A row for every seat of every tick, and one for every event.
void write_csv(const LoadedLog& loaded, std::ostream& out) {
  out << "tick,digest,what,seat,axis0,axis1,axis2,axis3,buttons,value\n";
  TickReader reader(loaded);
  for (std::uint64_t number = loaded.first_tick(); number <= loaded.last_tick(); ++number) {
    const protocol::LogTick& tick = reader.at(number);
    const std::string begin = std::to_string(number) + "," + hex16(tick.digest) + ",";
    for (std::size_t seat = 0; seat < tick.frame.seats.size(); ++seat) {
      const protocol::SeatFrame& frame = tick.frame.seats[seat];
      out << begin << protocol::origin_name(frame.origin) << ',' << seat;
      for (const std::int16_t axis : frame.input.axes) out << ',' << axis;
      out << ',' << frame.input.buttons << ",\n";
    }
    for (const protocol::FrameEvent& event : tick.frame.events)
      out << begin << protocol::event_kind_name(event.kind) << ',' << event.seat << ",,,,,,\n";
    for (const protocol::FrameChange& change : tick.frame.changes)
      out << begin << protocol::change_kind_name(change.kind) << ",,,,,,," << change.value << '\n';
    if (tick.frame.seats.empty()) out << begin << "tick,,,,,,,\n";
  }
}

Exit export_log(const ExportOptions& options) {
  const LoadedLog loaded = load_log(options.log, options.loading);
  std::optional<WholeFile> file;
  if (!options.out.empty()) file.emplace(options.out);
  std::ostream& out = file ? file->stream() : std::cout;
  options.format == "csv" ? write_csv(loaded, out) : write_json(loaded, out);
  if (file) file->finish();
  print_blemish(loaded);
  return loaded.exit();
}

}  // namespace

void add_export(CLI::App& app, Action& action) {
  auto options = std::make_shared<ExportOptions>();
  CLI::App* command = app.add_subcommand(
      "export", "Write every tick of a log with its inputs, events and digest as JSON or CSV");
  command->footer(kExitCodesText);
  action.files.reads(command->add_option("LOG", options->log, "A .cylog file")->required());
  command->add_option("--format", options->format, "json or csv")
      ->capture_default_str()
      ->check(CLI::IsMember({"json", "csv"}));
  action.files.writes(command->add_option("-o,--out", options->out, "A file; else stdout"));
  add_salvage_option(command, options->loading);
  command->callback([options, &action] { action.run = [=] { return export_log(*options); }; });
}

}  // namespace cycloid::cli
