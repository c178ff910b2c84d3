#include <sys/resource.h>

#include <filesystem>
#include <fstream>
#include <future>
#include <stdexcept>

#include "bench/load/lateness.hpp"
#include "bench/load/metrics_page.hpp"
#include "bench/load/places.hpp"
#include "bench/load/scenario.hpp"
#include "bench/load/server_process.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::load {
namespace {

constexpr double kWarmUpS = 5.0;
constexpr double kCatchUpS = 0.5;

/// A closed room with a ball for every seat.
scenes::Scene seats_scene(int seats) {
  scenes::Scene scene = *scenes::find("room:bodies=9").scene;
  const scenes::SceneBody ball = scene.bodies.back();
  const scenes::Seat seat = scene.seats.back();
  const scenes::SceneBody walls = scene.bodies.front();
  scene.name = "seats-" + std::to_string(seats);
  scene.bodies = {walls};
  scene.joints.clear();
  scene.seats.clear();
  for (int i = 0; i < seats; ++i) {
    scenes::SceneBody body = ball;
    body.name = "player-" + std::to_string(i);
    body.position = {static_cast<float>(i % 20) * 1.15f - 11.0f,
                     0.6f + static_cast<float>(i / 20) * 1.1f, 0.0f};
    scene.bodies.push_back(body);
    scenes::Seat mine = seat;
    mine.name = body.name;
    mine.controls.resize(2);  // Its drive and its jump, without what drops crates.
    for (scenes::Control& control : mine.controls) control.target = body.name;
    mine.script.clear();
    scene.seats.push_back(mine);
  }
  return scene;
}

scenes::Scene scene_of(const std::string& name) {
  if (name.rfind("seats:", 0) == 0) return seats_scene(std::stoi(name.substr(6)));
  return *scenes::find(name).scene;
}

void write_config(const std::filesystem::path& file, const Scenario& scenario,
                  const std::string& scene_file, std::uint16_t operation_port) {
  std::ofstream to(file);
  to << "[server]\nport = 0\nthreads = " << scenario.threads
     << "\ndrain_s = 0\nlog_level = \"error\"\n"
     << "[limits]\nrooms = 512\nconnections = 20000\npending = 20000\nroom_connections = 4000\n"
     << "snapshot_ticks = " << scenario.snapshot_ticks << "\nhello_ms = 600000\nidle_s = 600\n"
     << "[operation]\nport = " << operation_port << "\n[template.load]\nscene = \"" << scene_file
     << "\"\n";
  for (int i = 0; i < scenario.rooms; ++i) {
    to << "[[room]]\nname = \"room-" << i << "\"\ntemplate = \"load\"\n";
  }
}

/// Clients are elsewhere in earnest: where they share the server's cores, they are to take what it
/// leaves. Of this thread alone, which cannot take it back without being root; what it starts later
/// inherits it.
void give_way_to_the_server() {
  constexpr int kNice = 10;
  (void)::setpriority(PRIO_PROCESS, 0, kNice);
}

/// All clients of a scenario, on this thread.
class Crowd {
 public:
  Crowd(const Scenario& scenario, std::uint16_t port, std::uint64_t scene_digest)
      : scenario_(scenario) {
    for (const ClientGroup& group : scenario.groups) {
      results_.push_back(
          {group.name, group.behaviour, group.mode, group.per_room * scenario.rooms, {}});
    }
    for (std::size_t g = 0; g < scenario.groups.size(); ++g) {
      for (int i = 0; i < results_[g].clients; ++i) add(g, i, port, scene_digest);
    }
  }

  /// Serves the clients for so long.
  void run_for(double seconds) {
    io_.restart();
    io_.run_for(std::chrono::duration_cast<std::chrono::nanoseconds>(
        std::chrono::duration<double>(seconds)));
  }
  /// Takes what has come already. For a bounded time: clients that cannot keep up never have taken
  /// all.
  void catch_up() { run_for(kCatchUpS); }
  void begin_measuring() {
    for (GroupResult& result : results_) result.tally.begin_measuring();
  }
  std::vector<GroupResult> stop() {
    for (const auto& client : clients_) client->stop();
    run_for(0.2);
    return std::move(results_);
  }

 private:
  void add(std::size_t g, int i, std::uint16_t port, std::uint64_t scene_digest) {
    const ClientGroup& group = scenario_.groups[g];
    ClientPlan plan;
    plan.port = port;
    plan.room = "room-" + std::to_string(i % scenario_.rooms);
    plan.scene_digest = scene_digest;
    plan.mode = group.mode;
    plan.profile = group.profile;
    plan.behaviour = group.behaviour;
    clients_.push_back(std::make_shared<LoadClient>(io_, plan, results_[g].tally));
    // Not all at once: a backlog that overflows answers after a second, and that is not the point.
    auto timer = std::make_shared<asio::steady_timer>(io_);
    timer->expires_after(
        std::chrono::microseconds(static_cast<std::int64_t>(group.after_s * 1e6) + 100 * i));
    timer->async_wait(
        [timer, client = clients_.back()](const asio::error_code&) { client->start(); });
  }

  const Scenario& scenario_;
  asio::io_context io_{1};
  std::vector<GroupResult> results_;
  std::vector<std::shared_ptr<LoadClient>> clients_;
};

}  // namespace

/// What the server did between two pages of its metrics, since `began`.
static ScenarioResult server_figures(const MetricsPage& before, const MetricsPage& after,
                                     const Usage& used_before, const Usage& used,
                                     Clock::time_point began) {
  ScenarioResult result;
  result.seconds = std::chrono::duration<double>(Clock::now() - began).count();
  result.cpu_percent = 100.0 * (used.cpu_s - used_before.cpu_s) / result.seconds;
  result.resident_mb = static_cast<double>(used.resident_bytes) / 1e6;
  const auto grown = [&](const char* name) { return after.sum(name) - before.sum(name); };
  result.ticks = grown("cycloid_room_tick");
  result.catch_up_ticks = grown("cycloid_room_catch_up_ticks_total");
  result.slowed_ms = grown("cycloid_room_slowed_seconds_total") * 1e3;
  result.inputs_replaced = grown("cycloid_room_inputs_replaced_total");
  result.inputs_late = grown("cycloid_room_inputs_late_total");
  const auto each_us = [&](double of_s) {
    return result.ticks > 0.0 ? of_s * 1e6 / result.ticks : 0;
  };
  result.cpu_us_per_tick = each_us(used.cpu_s - used_before.cpu_s);
  result.tick_mean_us = each_us(grown("cycloid_room_tick_seconds_sum"));
  const std::string lateness = "cycloid_room_tick_lateness_seconds";
  result.tick_p99_ms = after.quantile_ms("cycloid_room_tick_seconds", 0.99, before);
  result.late_p50_ms = after.quantile_ms(lateness, 0.5, before);
  result.late_p99_ms = after.quantile_ms(lateness, 0.99, before);
  result.late_p999_ms = after.quantile_ms(lateness, 0.999, before);
  return result;
}

static ScenarioResult measure(const Scenario& scenario, const std::string& program, double seconds,
                              bool realtime) {
  const OwnFolder folder;
  const scenes::Scene scene = scene_of(scenario.scene);
  const std::filesystem::path scene_file = folder / "scene.json";
  std::ofstream(scene_file) << scenes::to_json(scene);
  const std::uint16_t operation_port = free_port();
  write_config(folder / "load.toml", scenario, scene_file.string(), operation_port);

  std::vector<std::string> words = {"serve", "--config", (folder / "load.toml").string()};
  if (realtime) words.push_back("--rt");
  ServerProcess server(program, words);
  BareTimer control;  // Before the clients give way, or it would, too; so the watch.
  OverrunWatch watch(operation_port, control);
  give_way_to_the_server();
  Crowd crowd(scenario, server.port(), scenes::scene_digest(scene));
  crowd.run_for(kWarmUpS);

  // The page blocks this thread, and so every client: what has come meanwhile is no measurement.
  const MetricsPage before = MetricsPage::fetch(operation_port);
  crowd.catch_up();
  crowd.begin_measuring();
  const Usage used_before = server.usage();
  const auto began = Clock::now();
  control.begin_measuring();
  watch.begin();
  crowd.run_for(seconds);
  std::vector<Stretch> overruns = watch.stop();
  Samples control_ms = control.stop();
  const MetricsPage after = MetricsPage::fetch(operation_port);
  const Usage used = server.usage();

  ScenarioResult result = server_figures(before, after, used_before, used, began);
  result.name = scenario.name;
  result.control_p50_ms = control_ms.quantile(500);
  result.control_p99_ms = control_ms.quantile(990);
  result.control_p999_ms = control_ms.quantile(999);
  result.control_max_ms = control_ms.quantile(1000);
  result.control_behind = static_cast<int>(control_ms.above(kTick_ms));
  result.overruns = std::move(overruns);
  result.groups = crowd.stop();
  (void)server.stop();
  return result;
}

ScenarioResult run_scenario(const Scenario& scenario, const std::string& program, double seconds,
                            bool realtime) {
  const auto on_its_own_thread = [&] { return measure(scenario, program, seconds, realtime); };
  return std::async(std::launch::async, on_its_own_thread).get();
}

}  // namespace cycloid::load
