#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <utility>
#include <vector>

#include "cli/child.hpp"
#include "cli/commands.hpp"
#include "cli/demo_table.hpp"
#include "cli/output.hpp"
#include "cli/replaying.hpp"
#include "cli/signals.hpp"
#include "cli/visible.hpp"

namespace cycloid::cli {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::seconds;

constexpr seconds kListenDeadline{10};
constexpr seconds kMatchSlack{20};  ///< Beyond the match's own length.
constexpr seconds kStopDeadline{15};

struct DemoOptions {
  std::string scene;
  double seconds = 10.0;
  std::string log = "demo.cylog";
  bool forever = false;
};

/// The real parts: a server and three clients, each a process, over loopback TCP.
class Demo {
 public:
  explicit Demo(DemoOptions options)
      : options_(std::move(options)), scene_(load_scene(options_.scene)) {
    const scenes::Simulation simulation = make_simulation(scene_, 1);
    seats_ = simulation.seats();
    result_.scene = scene_.name;
    result_.log = options_.log;
    result_.tick_ms = 1000.0 * double(simulation.tick_s());
    result_.ticks =
        options_.forever ? 0 : std::uint64_t(std::ceil(options_.seconds / simulation.tick_s()));
  }

  Exit run(bool json) {
    catch_stop_signals();
    remove_older_log();
    if (start_server()) {
      start_clients();
      play();
    }
    collect();
    for (const auto& child : children_) {
      if (child->exit_code() != kExitGood) explain(*child);
    }
    judge(result_);
    const Exit exit = result_.failures.empty() ? kExitGood : exit_of_failure();
    if (json) print_json(to_json(result_), exit);
    if (!json) print_table(result_);
    for (const std::string& failure : result_.failures)
      std::cerr << "cycloid: " << visible_lines(failure) << '\n';
    return exit;
  }

 private:
  Child& start(const std::string& name, const std::vector<std::string>& arguments) {
    std::vector<std::string> command = {this_program()};
    command.insert(command.end(), arguments.begin(), arguments.end());
    children_.push_back(std::make_unique<Child>(name, command));
    everyone_.push_back(children_.back().get());
    return *children_.back();
  }

  /// A server writes only new logs. An older demo's may go; anything else may not.
  void remove_older_log() const {
    std::error_code error;
    if (!std::filesystem::exists(options_.log, error)) return;
    if (!is_log_file(options_.log)) {
      throw Failure(kExitUsage, "--log: " + options_.log + " is there and is no log");
    }
    std::filesystem::remove(options_.log);
  }

  bool start_server() {
    Child& server = start(
        "server", {"serve", options_.scene, "--address", "127.0.0.1", "--port", "0", "--ticks",
                   std::to_string(result_.ticks), "--log", options_.log, "--json"});
    // "listening on 127.0.0.1:12345\n" on stderr; stdout is for its report.
    const std::string words = "listening on ";
    const auto listening = [&] {
      const std::size_t at = server.err().find(words);
      return at != std::string::npos && server.err().find('\n', at) != std::string::npos;
    };
    if (!pump(everyone_, Clock::now() + kListenDeadline, listening)) {
      result_.failures.push_back("server: did not start to listen");
      return false;
    }
    const std::size_t begin = server.err().find(words) + words.size();
    address_ = server.err().substr(begin, server.err().find('\n', begin) - begin);
    if (options_.forever)
      std::cerr << "serving " << visible(result_.scene) << " on " << address_ << '\n';
    return true;
  }

  /// The lockstep clients take the first two seats, the snapshot client the third; who finds none
  /// looks on.
  void start_clients() {
    for (int client = 0; client < 3; ++client) {
      const std::string name = "client " + std::to_string(client + 1);
      const std::string seat = client < seats_ ? std::to_string(client) : "spectator";
      std::vector<std::string> arguments = {"join", address_, options_.scene, "--seat",
                                            seat,   "--name", name,           "--json"};
      if (client == 2) arguments.push_back("--snapshot");
      start(name, arguments);
      roles_.push_back((client == 2 ? "snapshot, " : "lockstep, ") +
                       (client < seats_ ? "seat " + seat : seat));
    }
  }

  void play() {
    const auto length = std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double>(options_.seconds));
    const auto deadline =
        options_.forever ? Clock::time_point::max() : Clock::now() + length + kMatchSlack;
    const bool stopped = pump(everyone_, deadline, stop_requested);
    if (finished()) return;
    if (!stopped) result_.failures.push_back("the match did not end in time; it was stopped");
    if (stopped && !options_.forever) result_.failures.push_back("stopped by a signal");
    children_.front()->ask_to_stop();
    pump(everyone_, Clock::now() + kStopDeadline, [] { return false; });
  }

  bool finished() const {
    for (const Child* child : everyone_) {
      if (!child->finished()) return false;
    }
    return true;
  }

  void collect() {
    for (std::size_t i = 0; i < children_.size(); ++i) {
      DemoPart part;
      part.name = children_[i]->name();
      part.role = i == 0 ? "authority" : roles_[i - 1];
      const Json report = Json::parse(children_[i]->out(), nullptr, /*allow_exceptions=*/false);
      part.there = report.is_object() && report.contains("digest");
      if (part.there) {
        part.ticks = report.value("tick", std::uint64_t{0});
        part.digest = report.value("digest", "");
        part.ticks_present = part.ticks - report.value("first_tick", std::uint64_t{0});
        part.bytes_in = report.value("bytes_in", std::uint64_t{0});
        part.bytes_out = report.value("bytes_out", std::uint64_t{0});
        result_.inputs_replaced += report.value("inputs_replaced", std::uint64_t{0});
      }
      if (i == 0)
        result_.worst_tick_ms = report.is_object() ? report.value("worst_tick_ms", 0.0) : 0;
      if (i == 0 && options_.forever) result_.ticks = part.ticks;
      result_.parts.push_back(std::move(part));
    }
    if (!result_.parts.empty() && result_.parts.front().there) replay_log();
  }

  void replay_log() {
    DemoPart part{"replay", "headless", false, 0, "", 0, 0, 0};
    try {
      const LoadedLog loaded = load_log(options_.log);
      const Replayed replayed = replay(loaded, {});
      part.there = !replayed.divergence;
      part.ticks = replayed.ticks;
      part.digest = hex16(replayed.digest);
      if (replayed.divergence) {
        result_.failures.push_back("replay: " + divergence_text(*replayed.divergence));
      }
      if (!loaded.blemish().empty()) result_.failures.push_back("replay: " + loaded.blemish());
    } catch (const Failure& failure) {  // The other parts still have something to say.
      result_.failures.push_back(std::string("replay: ") + failure.what());
    }
    result_.parts.push_back(std::move(part));
  }

  void explain(const Child& child) {
    const std::string& words = child.err();
    const std::string tail = words.size() > 2000 ? words.substr(words.size() - 2000) : words;
    const std::string how =
        child.exit_code() ? "ended with " + std::to_string(*child.exit_code()) : "had to be killed";
    result_.failures.push_back(child.name() + " " + how + "; its last words:\n" + tail +
                               "start the parts one by one to see more: cycloid serve " +
                               options_.scene + ", cycloid join HOST:PORT " + options_.scene);
  }

  /// Of the part that failed, the worst; where all ended well, they disagree.
  Exit exit_of_failure() const {
    for (const auto& child : children_) {
      if (child->exit_code().value_or(kExitIo) != kExitGood) {
        const int code = child->exit_code().value_or(kExitIo);
        return code <= kExitIo ? static_cast<Exit>(code) : kExitIo;
      }
    }
    return kExitDiverged;
  }

  DemoOptions options_;
  scenes::Scene scene_;
  int seats_ = 0;
  std::string address_;
  std::vector<std::unique_ptr<Child>> children_;
  std::vector<Child*> everyone_;
  std::vector<std::string> roles_;
  DemoResult result_;
};

}  // namespace

void add_demo(CLI::App& app, Action& action) {
  auto options = std::make_shared<DemoOptions>();
  CLI::App* command = add_command(
      app, "demo", "A server and three clients over loopback, then a replay; all must agree",
      action);
  action.files.reads(
      command->add_option("SCENE", options->scene, "A catalogue name or a scene file")->required());
  command->add_option("--seconds", options->seconds, "How long the match is")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 86400.0));
  action.files.streams(command
                           ->add_option("--log", options->log,
                                        "Where the server writes the match; replaces an older log")
                           ->capture_default_str());
  command->add_flag("--forever", options->forever, "Until a signal, instead of --seconds");
  command->callback([options, &action] {
    action.run = [=, &action] { return Demo(*options).run(action.json); };
  });
}

}  // namespace cycloid::cli
