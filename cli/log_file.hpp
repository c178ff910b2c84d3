#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cli/exit_codes.hpp"
#include "protocol/log_format.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::cli {

/// A log with the scene that it carries. Its ticks stay bytes: a TickReader reads them.
struct LoadedLog {
  std::string file;
  protocol::LogSummary log;
  std::shared_ptr<const std::vector<std::byte>> bytes;  ///< The good prefix.
  scenes::Scene scene;
  bool salvaged = false;  ///< Torn or corrupt, and only its good prefix was asked for.

  std::uint64_t first_tick() const { return log.header.branch_tick + 1; }
  std::uint64_t last_tick() const { return log.last_tick; }
  /// Whether it ends as a log should, or why not and what is lost.
  std::string blemish() const;
  /// Of a command that has done with it what it could: a log that was not closed is a match that
  /// was killed, its ticks are good; one that is torn has lost something.
  Exit exit() const;
};

struct LoadOptions {
  bool salvage = false;  ///< Take the good prefix of a log with damage in its middle.
};

/// Whether a regular file begins as a log does. A Failure where it cannot be read.
bool is_log_file(const std::string& file);
/// The bytes of a log in a file or pipe, and a Failure as of any file. A device is refused: it may
/// have no end.
std::vector<std::byte> read_log_bytes(const std::string& file);
/// Reads a log of which at least a prefix is good. A Failure (corrupt, incompatible, I/O) names the
/// file and what is wrong with it.
LoadedLog load_log(const std::string& file, const LoadOptions& options = {});
/// The same of bytes that are in memory; `file` is what a Failure calls them.
LoadedLog parse_log(const std::string& file, std::span<const std::byte> bytes,
                    const LoadOptions& options = {});

/// Says on stderr how a log does not end as it should, and what is lost; nothing of one that does.
void print_blemish(const LoadedLog& loaded);

/// The ticks of a log in any order; quick where each is the one after the last.
class TickReader {
 public:
  explicit TickReader(const LoadedLog& loaded);
  /// @pre first_tick() <= tick <= last_tick(). Valid until the next call.
  const protocol::LogTick& at(std::uint64_t tick);

 private:
  void rewind(std::uint64_t tick);

  std::shared_ptr<const std::vector<std::byte>> bytes_;
  protocol::LogStart start_;
  std::vector<protocol::KeyframePlace> keyframes_;
  std::optional<protocol::LogCursor> cursor_;
};

}  // namespace cycloid::cli
