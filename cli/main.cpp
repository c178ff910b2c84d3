#include <CLI/CLI.hpp>
#include <algorithm>
#ifndef __wasm__
#include <csignal>
#endif
#include <exception>
#include <iostream>
#include <string_view>
#if defined(_WIN32)
#include <fcntl.h>
#include <io.h>
#include <stdio.h>
#endif

#include "cli/commands.hpp"
#include "cli/log_file.hpp"
#include "cli/numbers.hpp"
#include "cli/output.hpp"
#include "cli/visible.hpp"
#include "scenes/reasons.hpp"
#include "solver/floating_point_mode.hpp"

namespace cycloid::cli {

CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& summary,
                      Action& action) {
  CLI::App* command = app.add_subcommand(name, summary);
  command->add_flag("--json", action.json, "One JSON object on stdout");
  command->footer(kExitCodesText);
  return command;
}

void add_salvage_option(CLI::App* command, LoadOptions& options) {
  command->add_flag("--salvage", options.salvage,
                    "Of a log with damage in its middle take the good ticks before");
}

void add_lanes_option(CLI::App* command, int& lanes) {
  command
      ->add_option(
          "--lanes", lanes,
          "Contacts an instruction: 1, 4, 8, 16 as far as the processor has them, or 0 for "
          "what suits; changes no bit")
      ->capture_default_str()
      ->check(CLI::IsMember({0, 1, 4, 8, 16}));
}

static Exit parse_and_run(int argc, char** argv) {
  CLI::App app("Cycloid: a deterministic lockstep physics server", "cycloid");
  app.footer(kExitCodesText);
  Action action;
#ifdef CYCLOID_NETWORK
  add_serve(app, action);
  add_join(app, action);
  add_synctest(app, action);
  add_demo(app, action);
  add_token(app, action);
  add_desync(app, action);
  add_sim(app, action);
#endif
  add_run(app, action);
  add_replay(app, action);
  add_verify(app, action);
  add_golden(app, action);
#ifdef CYCLOID_TOOLS
  add_info(app, action);
  add_cut(app, action);
  add_export(app, action);
  add_diff(app, action);
  add_trace(app, action);
  add_bisect(app, action);
  add_profile(app, action);
  add_scene(app, action);
  add_version(app, action);
#endif
#ifdef CYCLOID_EXPERIMENTS
  add_experiments(app, action);
  add_trials(app, action);
  add_chart(app, action);
  add_tune(app, action);
#endif
  check_numbers(app);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    app.exit(help);
    return kExitGood;
  } catch (const CLI::ParseError& error) {
    throw Failure(kExitUsage, std::string(error.what()) + " (see --help)");
  }
  if (!action.run) throw Failure(kExitUsage, "a subcommand is required (see --help)");
  if (const auto error = solver::check_arithmetic(solver::rounds_as_written()); !error.ok())
    throw Failure(kExitIncompatible, std::string(error.field) + " " + scenes::reason_of(error));
  action.files.check();
  return action.run();
}

static Exit report_failure(Exit exit, const std::string& what, bool json) {
  std::cerr << "cycloid: " << visible_lines(what) << '\n';
  if (json) print_json({{"error", what}}, exit);
  return exit;
}

/// A file that may grow no further (`ulimit -f`) is an error of the disk, as a full one is: each
/// command says so, and a server's other matches go on.
static void take_file_size_limit_as_error() {
#ifdef SIGXFSZ
  std::signal(SIGXFSZ, SIG_IGN);
#endif
}

}  // namespace cycloid::cli

int main(int argc, char** argv) {
  using namespace cycloid::cli;
#if defined(_WIN32)  // The same bytes on stdout everywhere: no \r\n, and binary scenes whole.
  _setmode(_fileno(stdout), _O_BINARY);
#endif
  take_file_size_limit_as_error();
  const bool json =
      std::any_of(argv, argv + argc, [](std::string_view word) { return word == "--json"; });
  Exit exit = kExitGood;
  try {
    exit = parse_and_run(argc, argv);
  } catch (const Failure& failure) {
    exit = report_failure(failure.exit, failure.what(), json);
  } catch (const std::exception& error) {  // What the environment did: memory, disk, network.
    exit = report_failure(kExitIo, error.what(), json);
  }
  if (!std::cout.flush()) exit = report_failure(kExitIo, "stdout: cannot be written", false);
  return exit;
}
