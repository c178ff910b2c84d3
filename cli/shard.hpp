#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>

namespace cycloid::cli {

/// A part of a set of files that many jobs share out among them.
struct Shard {
  std::uint32_t number = 1;  ///< From 1.
  std::uint32_t count = 1;

  /// Whether a file of these bytes is in this part. Every file is in exactly one, whatever it is
  /// called and in whichever order it is found.
  bool holds(std::span<const std::byte> bytes) const;
};

/// What an environment variable says, "" where it says nothing.
using Environment = std::function<std::string(const std::string& name)>;
Environment system_environment();

/// "2/5", or "auto": what a Kubernetes Indexed Job (JOB_COMPLETION_INDEX, with JOB_COMPLETIONS),
/// a Slurm array (SLURM_ARRAY_TASK_ID, _MIN, _COUNT, _STEP) or GNU parallel (PARALLEL_SEQ) says of
/// this job; CYCLOID_SHARDS is the number of jobs where the scheduler does not say it. A Failure
/// with kExitUsage names the variable that is missing or wrong.
Shard shard_of(const std::string& text, const Environment& environment);

}  // namespace cycloid::cli
