#include "solver/version.hpp"

#include <iostream>

#include "cli/commands.hpp"
#include "cli/output.hpp"
#include "protocol/messages.hpp"

namespace cycloid::cli {
namespace {

Exit print_version(bool json) {
  if (json) {
    print_json({{"version", CYCLOID_VERSION},
                {"solver_version", solver::kSolverVersion},
                {"protocol_version", protocol::kProtocolVersion},
                {"compiler", __VERSION__}},
               kExitGood);
  } else {
    std::cout << "cycloid " << CYCLOID_VERSION << "\nsolver " << solver::kSolverVersion
              << "\nprotocol " << protocol::kProtocolVersion << "\ncompiler " << __VERSION__
              << '\n';
  }
  return kExitGood;
}

}  // namespace

void add_version(CLI::App& app, Action& action) {
  CLI::App* command = add_command(
      app, "version", "The versions that two sides must share to stay in lockstep", action);
  command->callback([&action] { action.run = [&action] { return print_version(action.json); }; });
}

}  // namespace cycloid::cli
