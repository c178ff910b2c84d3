#pragma once

#include <cstdint>
#include <fstream>
#include <optional>
#include <string>

#include "protocol/log_format.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::cli {

/// A file that is written from front to back; a Failure with kExitIo names it where it cannot be.
class OutputFile {
 public:
  explicit OutputFile(std::string file);
  void write(std::span<const std::byte> bytes);
  void close();

 private:
  void check();

  std::string file_;
  std::ofstream stream_;
};

/// Writes a log of a headless run. The same run writes the same bytes everywhere, so the header
/// names neither a build nor a time.
class RunLog {
 public:
  /// @param keyframe_every  Ticks between two; 0: none.
  RunLog(std::string file, const scenes::Scene& scene, std::uint64_t keyframe_every);
  void tick(const protocol::InputFrame& frame, const scenes::Simulation& simulation);
  void finish(const scenes::Simulation& simulation);

 private:
  void write();

  OutputFile file_;
  std::uint64_t keyframe_every_;
  protocol::Bytes bytes_;
  protocol::Bytes state_;
  std::optional<protocol::LogEncoder> encoder_;
};

}  // namespace cycloid::cli
