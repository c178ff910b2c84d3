#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "cli/exit_codes.hpp"
#include "cli/file_options.hpp"

namespace cycloid::cli {

/// What the command line asks for: filled in by the parser, run by main.
struct Action {
  bool json = false;  ///< One JSON object on stdout instead of text.
  FileOptions files;
  std::function<Exit()> run;
};

/// A subcommand with the flags that all have.
CLI::App* add_command(CLI::App& app, const std::string& name, const std::string& summary,
                      Action& action);

struct LoadOptions;

/// `--salvage`, where a log is read.
void add_salvage_option(CLI::App* command, LoadOptions& options);

/// `--lanes`, beside a command's `--workers`.
void add_lanes_option(CLI::App* command, int& lanes);

// One file each. Every one of them adds its options to `app` and, when chosen, sets `action.run`.
void add_run(CLI::App& app, Action& action);
void add_replay(CLI::App& app, Action& action);
void add_verify(CLI::App& app, Action& action);
void add_info(CLI::App& app, Action& action);
void add_cut(CLI::App& app, Action& action);
void add_export(CLI::App& app, Action& action);
void add_golden(CLI::App& app, Action& action);
void add_diff(CLI::App& app, Action& action);
void add_trace(CLI::App& app, Action& action);
void add_bisect(CLI::App& app, Action& action);
void add_profile(CLI::App& app, Action& action);
void add_scene(CLI::App& app, Action& action);
void add_experiments(CLI::App& app, Action& action);
void add_trials(CLI::App& app, Action& action);
void add_chart(CLI::App& app, Action& action);
void add_tune(CLI::App& app, Action& action);
void add_version(CLI::App& app, Action& action);
void add_serve(CLI::App& app, Action& action);
void add_join(CLI::App& app, Action& action);
void add_synctest(CLI::App& app, Action& action);
void add_demo(CLI::App& app, Action& action);
void add_token(CLI::App& app, Action& action);
void add_desync(CLI::App& app, Action& action);
void add_sim(CLI::App& app, Action& action);

}  // namespace cycloid::cli
