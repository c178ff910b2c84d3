#pragma once

#include <cstdint>
#include <fstream>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "cli/exit_codes.hpp"
#include "protocol/log_format.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::cli {

/// As many as a world takes by itself.
inline constexpr int kLanesDefault = 4;

/// A log with the scene that it carries.
struct LoadedLog {
  std::string file;
  protocol::Log log;
  scenes::Scene scene;

  /// Whether it ends as a log should, or why not.
  std::string blemish() const;
};

/// Reads a log of which at least a prefix is good. A Failure (corrupt, incompatible, I/O) names the
/// file and what is wrong with it.
LoadedLog load_log(const std::string& file);
/// The same of bytes that are in memory; `file` is what a Failure calls them.
LoadedLog parse_log(const std::string& file, std::span<const std::byte> bytes);

/// Writes a log of a headless run.
class LogWriter {
 public:
  LogWriter(std::string file, const scenes::Scene& scene);
  void tick(const protocol::LogTick& tick);
  void finish(const protocol::LogFooter& footer);

 private:
  void write();

  std::string file_;
  std::ofstream stream_;
  protocol::Bytes bytes_;
  std::optional<protocol::LogEncoder> encoder_;
};

/// A tick whose digest is not the recorded one.
struct Divergence {
  std::uint64_t tick = 0;
  std::uint64_t recorded = 0;
  std::uint64_t replayed = 0;
  std::string fault;  ///< Where the replay could not make the tick at all.
};

struct Replayed {
  std::uint64_t ticks = 0;  ///< Made and found equal.
  std::uint64_t digest = 0;
  std::optional<Divergence> divergence;
};

struct ReplayOptions {
  std::uint64_t to = 0;  ///< Last tick; 0: all.
  int workers = 1;
  int lanes = kLanesDefault;
  std::function<void(std::uint64_t tick, std::uint64_t digest)> on_tick;
};

/// Steps the scene by the frames and compares the digest of every tick; stops at the first that
/// differs.
Replayed replay(const LoadedLog& loaded, const ReplayOptions& options);

/// "diverged at tick 7: recorded ..., replayed ..."
std::string divergence_text(const Divergence& divergence);

/// A simulation of the scene, or a Failure that says why there is none.
scenes::Simulation make_simulation(const scenes::Scene& scene, int workers,
                                   int lanes = kLanesDefault);

/// What a step that failed means: "kFaulted position".
std::string error_text(const solver::Error& error);

}  // namespace cycloid::cli
