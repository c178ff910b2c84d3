#include <nlohmann/json.hpp>

#include "server/desync/report.hpp"

namespace cycloid::server {
namespace {

using OrderedJson = nlohmann::ordered_json;

std::string string_of(const OrderedJson& json, const char* member) {
  return json.at(member).get<std::string>();
}

std::string number_of(const OrderedJson& json, const char* member) {
  return std::to_string(json.at(member).get<std::uint64_t>());
}

/// "body 3 'left' (bodies 2 and 5): position[0]"
std::string place_of(const OrderedJson& value) {
  std::string text = string_of(value, "object");
  const std::string name = string_of(value, "name");
  const std::string about = string_of(value, "about");
  const std::string field = string_of(value, "field");
  if (!name.empty()) text += " '" + name + "'";
  if (!about.empty()) text += " (" + about + ")";
  return field.empty() ? text : text + ": " + field;
}

void add_values(const OrderedJson& json, std::string& text) {
  for (const OrderedJson& value : json.at("values")) {
    const auto bits = value.at("bits").get<int>();
    text += "  " + place_of(value) + "\n    server " + string_of(value, "server") +
            "\n    client " + string_of(value, "client");
    text += bits == 1 ? "  (one bit differs)\n" : "\n";
  }
  const auto all = json.at("differences").get<std::uint64_t>();
  const std::uint64_t shown = json.at("values").size();
  if (all > shown)
    text += "  and " + std::to_string(all - shown) + " more numbers, ";
  else if (all > 0)
    text += "  and no other number, ";
  const std::string objects = number_of(json, "objects");
  if (all > 0) text += "in " + objects + (objects == "1" ? " object\n" : " objects\n");
}

void add_sides(const OrderedJson& json, std::string& text) {
  const OrderedJson& server = json.at("server");
  const OrderedJson& client = json.at("client");
  text += "server: " + string_of(server, "digest") + "  " + string_of(server, "build") + "\n";
  if (!server.at("digest_made_again").is_null()) {
    text += "        " + string_of(server, "digest_made_again") + "  made again from tick " +
            number_of(server, "made_again_from_tick") + "\n";
  }
  text += "client: " + string_of(client, "digest") + "  " + string_of(client, "build") +
          "\n        peer " + number_of(client, "peer") + " \"" + string_of(client, "name") + "\"" +
          (client.at("seat").is_null() ? ", a spectator" : ", seat " + number_of(client, "seat")) +
          "\n";
  const OrderedJson& votes = json.at("votes");
  text += "replicas at tick " + number_of(votes, "tick") + ": " + number_of(votes, "replicas") +
          ", of which " + number_of(votes, "with_server") + " agree with the server";
  if (votes.at("largest_other").get<std::uint64_t>() > 0) {
    text += " and " + number_of(votes, "largest_other") + " on " + string_of(votes, "other_digest");
  }
  text += "\n";
}

void add_inputs(const OrderedJson& json, std::string& text) {
  text += "inputs around it:\n";
  for (const OrderedJson& tick : json.at("inputs")) {
    const bool here = tick.at("tick") == json.at("tick");
    text += (here ? "> " : "  ") + number_of(tick, "tick") + "  " + string_of(tick, "digest");
    std::size_t seat = 0;
    for (const OrderedJson& said : tick.at("seats")) {
      text += "  seat " + std::to_string(seat++) + ": " + said.at("axes").dump() + " " +
              number_of(said, "buttons");
      if (const std::string origin = string_of(said, "origin"); origin != "given")
        text += " " + origin;
    }
    for (const OrderedJson& event : tick.at("events")) {
      text += "  " + string_of(event, "kind");
      text += event.contains("seat") ? " of seat " + number_of(event, "seat")
                                     : " to " + number_of(event, "value");
    }
    text += "\n";
  }
}

std::string text_of(const OrderedJson& json) {
  std::string text = "desync in room \"" + string_of(json, "room") + "\", scene " +
                     string_of(json, "scene") + " (" + string_of(json, "scene_digest") + ")\n";
  const bool first = json.at("tick_is_first").get<bool>();
  text += "tick " + number_of(json, "tick") +
          (first ? ", the first that differs" : ", the first that could be compared") +
          "; noticed at tick " + number_of(json, "noticed_tick") + "\n";
  if (json.at("values_tick") != json.at("tick"))
    text += "values of tick " + number_of(json, "values_tick") + ":\n";
  add_values(json, text);
  if (!json.at("phase").is_null()) {
    text += "phase: " + string_of(json, "phase") + ": " + string_of(json, "phase_reason") + "\n";
  }
  text += "wrong: " + string_of(json, "verdict") + "\n";
  add_sides(json, text);
  for (const OrderedJson& note : json.at("notes"))
    text += "note: " + note.get<std::string>() + "\n";
  add_inputs(json, text);
  if (json.at("log").is_null())
    text += "no log: " + string_of(json, "log_reason") + "\n";
  else
    text += "log: " + string_of(json, "log") + "\nrepeat: " + string_of(json, "repeat") + "\n";
  return text;
}

/// What comes from a file goes to a terminal: nothing in it may act there.
std::string printable_text(std::string text) {
  for (char& c : text)
    if ((static_cast<unsigned char>(c) < 0x20 && c != '\n') || c == 0x7f) c = '?';
  return text;
}

}  // namespace

std::optional<std::string> report_as_text(const std::string& json, std::string& error) {
  try {
    const OrderedJson report = OrderedJson::parse(json);
    const auto version = report.at("schema_version").get<int>();
    if (version != kReportSchemaVersion || string_of(report, "kind") != "desync") {
      error = "schema_version " + std::to_string(version) + " of a " + string_of(report, "kind") +
              " report, here " + std::to_string(kReportSchemaVersion) + " of a desync report";
      return std::nullopt;
    }
    return printable_text(text_of(report));
  } catch (const OrderedJson::exception& wrong) {
    error = std::string("not a desync report: ") + wrong.what();
    return std::nullopt;
  }
}

}  // namespace cycloid::server
