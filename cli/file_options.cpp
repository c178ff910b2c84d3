#include "cli/file_options.hpp"

#include "cli/files.hpp"
#include "cli/whole_file.hpp"

namespace cycloid::cli {
namespace {

/// A word of the command line and the option that it belongs to.
struct NamedFile {
  std::string option;
  std::string file;
};

void add_named(const std::vector<CLI::Option*>& options, std::vector<NamedFile>& files) {
  for (const CLI::Option* option : options)
    for (const std::string& file : option->results()) files.push_back({option->get_name(), file});
}

}  // namespace

CLI::Option* FileOptions::reads(CLI::Option* option) {
  read_.push_back(option);
  return option;
}

CLI::Option* FileOptions::writes(CLI::Option* option) {
  written_.push_back(option);
  return option;
}

CLI::Option* FileOptions::streams(CLI::Option* option) {
  streamed_.push_back(option);
  return option;
}

void refuse_same_file(const std::string& written_by, const std::string& written,
                      const std::string& named_by, const std::string& named) {
  if (!same_file(written, named)) return;
  throw WouldBeLost(kExitUsage,
                    written_by + ": " + written + " would be lost: " + named_by + " names it, too");
}

void FileOptions::check() const {
  std::vector<NamedFile> read;
  std::vector<NamedFile> written;
  add_named(read_, read);
  add_named(written_, written);
  const std::size_t whole = written.size();
  add_named(streamed_, written);
  for (std::size_t i = 0; i < written.size(); ++i) {
    const auto& [option, file] = written[i];
    if (file.empty()) throw Failure(kExitUsage, option + ": is no name of a file");
    for (const NamedFile& input : read)
      if (kind_of(input.file).exists) refuse_same_file(option, file, input.option, input.file);
    for (std::size_t other = 0; other < i; ++other)
      refuse_same_file(option, file, written[other].option, written[other].file);
  }
  for (std::size_t i = 0; i < whole; ++i) check_output(written[i].file);
}

}  // namespace cycloid::cli
