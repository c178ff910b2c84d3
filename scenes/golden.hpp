#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/scene.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::scenes {

/// The number in the first line of a golden file.
inline constexpr std::uint32_t kGoldenFormat = 1;
/// The last tick of a scene is not behind this one, two weeks at 60 Hz: a file's words must not
/// take a reader, who folds the whole script, as long as they please.
inline constexpr std::uint64_t kGoldenTicksMax = 100'000'000;
/// What a chain is before the first tick.
inline constexpr std::uint64_t kChainStart = 0;

/// What a scene, played by its own script, is after a tick.
struct GoldenRow {
  std::uint64_t tick = 0;
  std::uint64_t digest = 0;
  std::uint64_t encoded_bytes = 0;
  std::uint64_t chain = kChainStart;  ///< Over the digests of all ticks from 1 to this one.
  int line = 0;                       ///< Of the file that it was read from; 0: of none.
};

struct GoldenScene {
  std::string name;  ///< Of the catalogue, or a path relative to the file's folder: see `is_path`.
  std::uint64_t ticks = 0;  ///< The tick of the last row.
  std::uint64_t scene_digest = 0;
  std::uint64_t inputs_digest = 0;  ///< Over what the script says up to that tick.
  std::vector<GoldenRow> rows;      ///< At least one, by rising ticks.
  int line = 0;
};

/// What a golden file says. docs/ci.md has the format.
struct GoldenFile {
  std::uint32_t solver_version = 0;
  std::vector<GoldenScene> scenes;  ///< At least one; no name twice.
};

/// Why a text is no golden file.
struct GoldenMistake {
  int line = 0;  ///< From 1.
  std::string reason;
  bool other_format = false;  ///< It may be one, of another format than `kGoldenFormat`.
};

struct ParsedGolden {
  std::optional<GoldenFile> file;
  GoldenMistake mistake;  ///< Where there is no file.
};

/// The text of a golden file: the same for the same content, one line for each scene and row.
std::string to_golden_text(const GoldenFile& file);

/// Reads what `to_golden_text` writes, and nothing else but lines that end with CR LF: a line too
/// few, a number in another spelling or rows out of order are mistakes.
ParsedGolden parse_golden(std::string_view text);

/// Whether the name of a scene is a path: it holds a '/' or '.', as no name of the catalogue does.
bool is_path(std::string_view name);

/// XXH3-64 of the two as little-endian words. With a chain and the digest of the next tick it is
/// the next chain, so that two runs with equal chains had equal digests at every tick.
std::uint64_t fold(std::uint64_t chain, std::uint64_t word);

/// What the script lets every seat say at the ticks 1 to `ticks`, folded.
std::uint64_t inputs_digest(const Scene& scene, std::uint64_t ticks);

/// Plays a scene by its own script and keeps the chain.
class GoldenWalk {
 public:
  /// @param scene must outlive the walk.
  /// @param simulation of that scene, at tick 0.
  GoldenWalk(const Scene& scene, Simulation simulation);

  /// Steps to a tick that is not behind.
  /// @returns the error of the step that failed; `tick()` is then the tick before it.
  solver::Result<GoldenRow> walk_to(std::uint64_t tick);
  std::uint64_t tick() const { return simulation_.tick(); }

 private:
  const Scene& scene_;
  Simulation simulation_;
  std::uint64_t chain_ = kChainStart;
};

/// The first row that is not what it should be.
struct GoldenMismatch {
  GoldenRow expected;
  GoldenRow found;
  std::uint64_t first = 0;  ///< The first tick that differs is not before this one,
  std::uint64_t last = 0;   ///< nor after this one.
  solver::Error fault;      ///< Of the step from `last` - 1, where there is no row to compare.
};

/// Walks to each row up to `ticks_max` and compares digest, size and chain; stops at the first that
/// differs.
std::optional<GoldenMismatch> compare_golden(const GoldenScene& golden, GoldenWalk& walk,
                                             std::uint64_t ticks_max);

/// "tick 100: expected digest ..., found ...; the first difference is in ticks 11 to 100"
std::string mismatch_text(const GoldenMismatch& mismatch);

}  // namespace cycloid::scenes
