#include "server/desync/report.hpp"

#include <nlohmann/json.hpp>

#include "protocol/text.hpp"
#include "solver/version.hpp"
#include "solver/world.hpp"

namespace cycloid::server {
namespace {

/// Keeps the order of insertion, so that a report reads well as it is.
using OrderedJson = nlohmann::ordered_json;

OrderedJson value_json(const ReportedValue& value) {
  return {{"object", value.object}, {"name", value.name},     {"about", value.about},
          {"field", value.field},   {"server", value.server}, {"client", value.client},
          {"bits", value.bits}};
}

OrderedJson inputs_json(const protocol::LogTick& tick) {
  OrderedJson seats = OrderedJson::array();
  for (const protocol::SeatFrame& seat : tick.frame.seats) {
    seats.push_back({{"origin", protocol::origin_name(seat.origin)},
                     {"axes", seat.input.axes},
                     {"buttons", seat.input.buttons}});
  }
  OrderedJson events = OrderedJson::array();
  for (const protocol::FrameEvent& event : tick.frame.events)
    events.push_back({{"kind", protocol::event_kind_name(event.kind)}, {"seat", event.seat}});
  for (const protocol::FrameChange& change : tick.frame.changes)
    events.push_back({{"kind", protocol::change_kind_name(change.kind)}, {"value", change.value}});
  return {{"tick", tick.frame.tick},
          {"digest", protocol::hex16(tick.digest)},
          {"seats", std::move(seats)},
          {"events", std::move(events)}};
}

void add_sides_json(const DesyncReport& report, OrderedJson& json) {
  json["server"] = {{"build", report.room.build},
                    {"solver_version", solver::kSolverVersion},
                    {"digest", protocol::hex16(report.server_digest)},
                    {"digest_made_again", nullptr},
                    {"made_again_from_tick", nullptr},
                    {"suspect", report.server_suspect}};
  if (report.remade_digest) {
    json["server"]["digest_made_again"] = protocol::hex16(*report.remade_digest);
    json["server"]["made_again_from_tick"] = report.remade_from_tick;
  }
  json["client"] = {{"peer", report.client.peer},
                    {"name", report.client.name},
                    {"seat", nullptr},
                    {"build", report.client.build},
                    {"digest", protocol::hex16(report.client_digest)}};
  if (report.client.seat >= 0) json["client"]["seat"] = report.client.seat;
  json["votes"] = {{"tick", report.noticed_tick},
                   {"replicas", report.votes.replicas},
                   {"with_server", report.votes.with_server},
                   {"largest_other", report.votes.largest_other},
                   {"other_digest", protocol::hex16(report.votes.other_digest)}};
}

}  // namespace

std::string report_json_text(const DesyncReport& report, const ReportFiles& files) {
  OrderedJson json = {{"schema_version", kReportSchemaVersion},
                      {"kind", "desync"},
                      {"room", report.room.room},
                      {"scene", report.room.scene->name},
                      {"scene_digest", protocol::hex16(report.room.scene_digest)},
                      {"tick_rate_millihertz", report.room.tick_rate_millihertz},
                      {"tick", report.tick},
                      {"tick_is_first", report.is_first},
                      {"noticed_tick", report.noticed_tick},
                      {"values_tick", report.values_tick},
                      {"phase", nullptr},
                      {"phase_reason", report.phase_reason},
                      {"written_in", report.written_in},
                      {"object", nullptr},
                      {"field", nullptr},
                      {"value_server", nullptr},
                      {"value_client", nullptr},
                      {"differences", report.differences},
                      {"objects", report.objects}};
  if (!report.phase.empty()) json["phase"] = report.phase;
  if (!report.values.empty()) {
    json["object"] = report.values.front().object;
    json["field"] = report.values.front().field;
    json["value_server"] = report.values.front().server;
    json["value_client"] = report.values.front().client;
  }
  json["values"] = OrderedJson::array();
  for (const ReportedValue& value : report.values) json["values"].push_back(value_json(value));
  add_sides_json(report, json);
  json["verdict"] = report.verdict;
  json["notes"] = report.notes;
  json["inputs"] = OrderedJson::array();
  for (const protocol::LogTick& tick : report.inputs) json["inputs"].push_back(inputs_json(tick));
  json["log"] = files.log.empty() ? OrderedJson(nullptr) : OrderedJson(files.log);
  json["log_reason"] = files.log_reason;
  json["repeat"] = files.log.empty() ? OrderedJson(nullptr)
                                     : OrderedJson("cycloid desync repeat " + files.report);
  // Names come from outside: what is not UTF-8 must not cost the report.
  return json.dump(2, ' ', false, OrderedJson::error_handler_t::replace) + "\n";
}

}  // namespace cycloid::server
