#include <iostream>
#include <memory>
#include <optional>
#include <vector>

#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "cli/replaying.hpp"
#include "cli/run_log.hpp"
#include "cli/steady_time.hpp"
#include "cli/whole_file.hpp"
#include "solver/version.hpp"

namespace cycloid::cli {
namespace {

struct RunOptions {
  std::string scene;
  std::uint64_t ticks = 600;
  std::uint64_t digest_every = 60;
  int workers = 1;
  int lanes = kLanesDefault;
  std::string log;
  std::uint64_t keyframe_every = 600;
  std::string poses;
};

/// The frame that a server would make of a full house that says what the script says.
protocol::InputFrame scripted_frame(const scenes::Scene& scene, int seats, std::uint64_t tick) {
  protocol::InputFrame frame;
  frame.tick = tick;
  for (int seat = 0; seat < seats; ++seat) {
    frame.seats.push_back({protocol::Origin::kGiven, scenes::scripted_input(scene, seat, tick)});
    if (tick != 1) continue;
    frame.events.push_back({protocol::EventKind::kJoin, static_cast<std::uint16_t>(seat)});
  }
  return frame;
}

/// A row per body and tick, for plots. Positions in m, rotations as quaternions.
class PoseTable {
 public:
  explicit PoseTable(const std::string& file) : file_(file) {
    file_.stream() << "tick,body,x,y,z,qx,qy,qz,qw\n";
  }
  void add(const scenes::Simulation& simulation) {
    for (const scenes::Pose& pose : simulation.poses()) {
      file_.stream() << simulation.tick() << ',' << pose.index;
      for (const float value : pose.position) file_.stream() << ',' << value;
      for (const float value : pose.rotation) file_.stream() << ',' << value;
      file_.stream() << '\n';
    }
  }
  void finish() { file_.finish(); }

 private:
  WholeFile file_;
};

Exit run_scene(const RunOptions& options, bool json) {
  const scenes::Scene scene = load_scene(options.scene);
  scenes::Simulation simulation = make_simulation(scene, 1, options.lanes);
  if (const solver::Error error = simulation.set_workers_at_most(options.workers, &steady_ns);
      !error.ok()) {
    throw Failure(kExitUsage, "--workers: " + error_text(error));
  }
  std::optional<RunLog> log;
  if (!options.log.empty()) log.emplace(options.log, scene, options.keyframe_every);

  std::optional<PoseTable> poses;
  if (!options.poses.empty()) poses.emplace(options.poses).add(simulation);

  Json digests = Json::array();
  std::vector<scenes::SeatInput> inputs;
  for (std::uint64_t tick = 1; tick <= options.ticks; ++tick) {
    const protocol::InputFrame frame = scripted_frame(scene, simulation.seats(), tick);
    inputs.clear();
    for (const protocol::SeatFrame& seat : frame.seats) inputs.push_back(seat.input);
    if (const solver::Error error = simulation.step(inputs); !error.ok()) {
      if (poses) poses->finish();
      throw Failure(kExitDiverged, options.scene + ": the world does not step to tick " +
                                       std::to_string(tick) + ": " + error_text(error));
    }
    if (log) log->tick(frame, simulation);
    if (poses) poses->add(simulation);
    const bool wanted = options.digest_every != 0 && tick % options.digest_every == 0;
    if (!wanted && tick != options.ticks) continue;
    const std::string digest = hex16(simulation.digest());
    if (json) digests.push_back({{"tick", tick}, {"digest", digest}});
    if (!json) std::cout << tick << ' ' << digest << '\n';
  }
  if (log) log->finish(simulation);
  if (poses) poses->finish();
  if (json) {
    print_json({{"scene", scene.name},
                {"scene_digest", hex16(scenes::scene_digest(scene))},
                {"solver_version", solver::kSolverVersion},
                {"ticks", options.ticks},
                {"digest", hex16(simulation.digest())},
                {"digests", digests}},
               kExitGood);
  }
  return kExitGood;
}

}  // namespace

void add_run(CLI::App& app, Action& action) {
  auto options = std::make_shared<RunOptions>();
  CLI::App* command = add_command(
      app, "run", "Step a scene headless with its scripted inputs; prints 'tick digest'", action);
  action.files.reads(
      command->add_option("SCENE", options->scene, "A catalogue name or a scene file")->required());
  command->add_option("--ticks", options->ticks, "How many ticks")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  command->add_option("--digest-every", options->digest_every, "Ticks between lines; 0: the last")
      ->capture_default_str();
  command
      ->add_option("--workers", options->workers,
                   "Threads at most: one alone while that is faster; changes no bit")
      ->capture_default_str()
      ->check(CLI::Range(1, 64));
  add_lanes_option(command, options->lanes);
  action.files.streams(command->add_option(
      "--log", options->log, "Write a log of the run to this file; one that is there is replaced"));
  command
      ->add_option("--keyframe-every", options->keyframe_every,
                   "Ticks between two exact states in the log; 0: none")
      ->capture_default_str();
  action.files.writes(command->add_option("--poses", options->poses,
                                          "Write every body's pose at every tick as CSV"));
  command->callback([options, &action] {
    action.run = [=, &action] { return run_scene(*options, action.json); };
  });
}

}  // namespace cycloid::cli
