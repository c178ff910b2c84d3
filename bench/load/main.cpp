// Loads a server over real sockets on loopback and prints a table; see docs/server.md.
#include <sys/resource.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <stdexcept>

#include "bench/load/join_age.hpp"
#include "bench/load/scenario.hpp"

namespace cycloid::load {
namespace {

using Json = nlohmann::ordered_json;

/// Null where nothing was measured.
Json quantile_of(Samples& samples, std::size_t permille) {
  return samples.size() == 0 ? Json() : Json(samples.quantile(permille));
}

Json to_json(ScenarioResult& result) {
  Json groups = Json::array();
  for (GroupResult& group : result.groups) {
    ClientTally& tally = group.tally;
    const double updates = static_cast<double>(tally.frames + tally.snapshots);
    if (!result.inputs_show(group)) tally.input_to_state_ms.clear();
    groups.push_back(
        {{"name", group.name},
         {"clients", group.clients},
         {"joined", tally.joined},
         {"refused", tally.refused},
         {"closed", tally.closed},
         {"last_refusal", tally.last_refusal},
         {"frames", tally.frames},
         {"snapshots", tally.snapshots},
         {"gaps", tally.gaps},
         {"bytes_per_update",
          updates > 0.0 ? Json(static_cast<double>(tally.update_bytes) / updates) : Json()},
         {"update_gap_p99_ms", quantile_of(tally.frame_gap_ms, 990)},
         {"input_to_state_p50_ms", quantile_of(tally.input_to_state_ms, 500)},
         {"input_to_state_p99_ms", quantile_of(tally.input_to_state_ms, 990)},
         {"input_to_state_p999_ms", quantile_of(tally.input_to_state_ms, 999)},
         {"join_p99_ms", quantile_of(tally.join_ms, 990)}});
  }
  Json overruns = Json::array();
  for (const Stretch& stretch : result.overruns) {
    overruns.push_back({{"from_s", stretch.from_s},
                        {"to_s", stretch.to_s},
                        {"behind", stretch.behind},
                        {"control_worst_ms", stretch.control_worst_ms}});
  }
  return {{"scenario", result.name},
          {"seconds", result.seconds},
          {"cpu_percent", result.cpu_percent},
          {"resident_mb", result.resident_mb},
          {"ticks", result.ticks},
          {"catch_up_ticks", result.catch_up_ticks},
          {"slowed_ms", result.slowed_ms},
          {"inputs_replaced", result.inputs_replaced},
          {"inputs_late", result.inputs_late},
          {"cpu_us_per_tick", result.cpu_us_per_tick},
          {"tick_mean_us", result.tick_mean_us},
          {"tick_p99_ms", result.tick_p99_ms},
          {"late_ms", {result.late_p50_ms, result.late_p99_ms, result.late_p999_ms}},
          {"control_ms",
           {result.control_p50_ms, result.control_p99_ms, result.control_p999_ms,
            result.control_max_ms}},
          {"control_behind", result.control_behind},
          {"own_overruns", result.own_overruns()},
          {"overruns", std::move(overruns)},
          {"groups", std::move(groups)}};
}

/// With so many digits behind the point; a dash where nothing was measured.
std::string with_digits(const Json& value, int digits) {
  if (value.is_null()) return "-";
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value.get<double>();
  return text.str();
}

void print_group(const Json& group) {
  std::cout << "  " << group["name"].get<std::string>() << ": " << with_digits(group["joined"], 0)
            << " of " << with_digits(group["clients"], 0) << " joined, "
            << with_digits(group["closed"], 0) << " closed; "
            << with_digits(group["bytes_per_update"], 0) << " B an update, gap p99 "
            << with_digits(group["update_gap_p99_ms"], 1) << " ms; input to state "
            << with_digits(group["input_to_state_p50_ms"], 1) << "/"
            << with_digits(group["input_to_state_p99_ms"], 1) << "/"
            << with_digits(group["input_to_state_p999_ms"], 1) << " ms; join p99 "
            << with_digits(group["join_p99_ms"], 0) << " ms\n"
            << std::flush;
}

void print(const Json& result) {
  const auto number = [](const Json& value) { return value.get<double>(); };
  std::printf("%-11s %4.0f s  cpu %3.0f %%  %5.0f MB  ticks %.0f, behind %.0f, slowed %.0f ms\n",
              result["scenario"].get<std::string>().c_str(), number(result["seconds"]),
              number(result["cpu_percent"]), number(result["resident_mb"]), number(result["ticks"]),
              number(result["catch_up_ticks"]), number(result["slowed_ms"]));
  std::printf("  %.0f us of the server for each tick of a room, which took %.0f us to make\n",
              number(result["cpu_us_per_tick"]), number(result["tick_mean_us"]));
  const Json& late = result["late_ms"];
  const Json& control = result["control_ms"];
  std::printf(
      "  late p50/p99/p99.9 <= %.2f/%.2f/%.2f ms; bare timer %.2f/%.2f/%.2f ms, at most %.2f, "
      "behind %.0f\n",
      number(late[0]), number(late[1]), number(late[2]), number(control[0]), number(control[1]),
      number(control[2]), number(control[3]), number(result["control_behind"]));
  for (const Json& stretch : result["overruns"]) {
    std::printf("  second %.0f to %.0f: %.0f behind; the bare timer was %.2f ms late at most\n",
                number(stretch["from_s"]), number(stretch["to_s"]), number(stretch["behind"]),
                number(stretch["control_worst_ms"]));
  }
  std::printf("  inputs replaced %.0f, late %.0f\n", number(result["inputs_replaced"]),
              number(result["inputs_late"]));
  std::fflush(stdout);
  for (const Json& group : result["groups"]) print_group(group);
}

/// A match of one minute, and of one hour, at 60 Hz.
constexpr std::uint64_t kMinuteTicks = 60 * 60;
constexpr std::uint64_t kHourTicks = 60 * kMinuteTicks;
constexpr const char* kJoinsName = "joins";

Json joins_at_both_ages(const std::string& program) {
  std::printf("Newcomers to a match of a minute's and of an hour's ticks\n");
  Json ages = Json::array();
  for (const JoinAge& age : measure_joins(program, {kMinuteTicks, kHourTicks})) {
    std::printf(
        "%-11s tick %7llu: %d joined, state whole after p50 %.2f, at most %.2f ms; %.0f MB\n",
        kJoinsName, static_cast<unsigned long long>(age.tick), age.joins, age.p50_ms, age.max_ms,
        age.resident_mb);
    ages.push_back({{"tick", age.tick},
                    {"joins", age.joins},
                    {"p50_ms", age.p50_ms},
                    {"max_ms", age.max_ms},
                    {"resident_mb", age.resident_mb}});
  }
  std::fflush(stdout);
  return {{"scenario", kJoinsName}, {"ages", std::move(ages)}};
}

/// Two descriptors per connection of the largest scenario, on both sides; the server inherits it.
void raise_descriptors() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  (void)::setrlimit(RLIMIT_NOFILE, &limit);
}

bool is_scenario(const std::string& name) {
  if (name == kJoinsName) return true;
  const std::vector<Scenario> all = scenarios();
  return std::any_of(all.begin(), all.end(), [&](const auto& one) { return one.name == name; });
}

void write_json(const std::string& file, const Json& all) {
  std::ofstream stream(file);
  stream << all.dump(2) << '\n';
  stream.close();
  if (!stream) throw std::runtime_error(file + ": cannot be written");
}

/// @returns 0, 1 where the server has not held up a load, 2 for a command line that makes no sense.
int run(int argc, char** argv) {
  CLI::App app("Loads a server over real sockets on loopback; prints a table.");
  std::string program;
  std::vector<std::string> wanted;
  double seconds = 20.0;
  std::string json_file;
  bool realtime = false;
  app.add_option("--program", program, "The cycloid to load")->required()->check(CLI::ExistingFile);
  app.add_option("--seconds", seconds, "Of each scenario")->check(CLI::PositiveNumber);
  app.add_option("--json", json_file, "Write the results here, too");
  app.add_flag("--rt", realtime, "Have the server ask for real-time threads");
  app.add_option("SCENARIO", wanted, "Only these");
  CLI11_PARSE(app, argc, argv);
  for (const std::string& name : wanted) {
    if (is_scenario(name)) continue;
    std::cerr << "SCENARIO: there is no " << name << '\n';
    return 2;
  }
  raise_descriptors();
  int exit = 0;
  Json all = Json::array();
  for (const Scenario& scenario : scenarios()) {
    if (!wanted.empty() && std::find(wanted.begin(), wanted.end(), scenario.name) == wanted.end()) {
      continue;
    }
    std::printf("%s\n", scenario.what.c_str());
    ScenarioResult result = run_scenario(scenario, program, seconds, realtime);
    const std::vector<std::string> failures = failures_of(result);
    all.push_back(to_json(result));
    all.back()["failures"] = failures;
    print(all.back());
    for (const std::string& failure : failures) std::printf("  not held: %s\n", failure.c_str());
    if (!failures.empty()) exit = 1;
  }
  if (wanted.empty() || std::find(wanted.begin(), wanted.end(), kJoinsName) != wanted.end()) {
    all.push_back(joins_at_both_ages(program));
  }
  if (!json_file.empty()) write_json(json_file, all);
  return exit;
}

}  // namespace
}  // namespace cycloid::load

int main(int argc, char** argv) {
  try {
    return cycloid::load::run(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "cycloid_load: " << error.what() << '\n';
    return 1;
  }
}
