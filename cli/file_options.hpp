#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "cli/output.hpp"

namespace cycloid::cli {

/// The options that name files, and what holds for all of them: what a command writes has a name,
/// can be written, and is no file that it reads or writes elsewhere.
class FileOptions {
 public:
  /// Each returns its option. What is read may also be no file: the name of a scene.
  CLI::Option* reads(CLI::Option* option);
  CLI::Option* writes(CLI::Option* option);
  /// Written by others, or as the work goes on.
  CLI::Option* streams(CLI::Option* option);

  /// Of the options that were given, before any work. A Failure names the option.
  void check() const;

 private:
  std::vector<CLI::Option*> read_;
  std::vector<CLI::Option*> written_;
  std::vector<CLI::Option*> streamed_;
};

/// A file that is read would be lost: nothing more may be written to it.
struct WouldBeLost : Failure {
  using Failure::Failure;
};

/// WouldBeLost where what one option has the program write is what another one names.
void refuse_same_file(const std::string& written_by, const std::string& written,
                      const std::string& named_by, const std::string& named);

}  // namespace cycloid::cli
