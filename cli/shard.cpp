#include "cli/shard.hpp"

#include <charconv>
#include <cstdlib>
#include <optional>
#include <vector>

#include "cli/output.hpp"
#include "protocol/crc32c.hpp"

namespace cycloid::cli {
namespace {

std::optional<std::uint32_t> number_of(std::string_view text) {
  std::uint32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return {};
  return number;
}

/// The number in a variable; `otherwise` where it is not set.
std::uint32_t variable(const Environment& environment, const std::string& name,
                       std::optional<std::uint32_t> otherwise = {}) {
  const std::string text = environment(name);
  if (text.empty() && otherwise) return *otherwise;
  if (text.empty()) throw Failure(kExitUsage, "--shard auto: " + name + " is not set");
  const std::optional<std::uint32_t> number = number_of(text);
  if (!number) throw Failure(kExitUsage, "--shard auto: " + name + " is no number: " + text);
  return *number;
}

/// As the scheduler numbers its jobs, brought to a number from 1.
Shard checked(const std::string& what, std::uint32_t number, std::uint32_t count) {
  if (count == 0 || number == 0 || number > count) {
    throw Failure(kExitUsage, "--shard " + what + ": " + std::to_string(number) + " of " +
                                  std::to_string(count) + " is no part");
  }
  return {number, count};
}

Shard of_kubernetes(const Environment& environment) {
  const std::uint32_t index = variable(environment, "JOB_COMPLETION_INDEX");
  const bool named = !environment("JOB_COMPLETIONS").empty();
  return checked("auto (JOB_COMPLETION_INDEX)", index + 1,
                 variable(environment, named ? "JOB_COMPLETIONS" : "CYCLOID_SHARDS"));
}

Shard of_slurm(const Environment& environment) {
  const std::uint32_t id = variable(environment, "SLURM_ARRAY_TASK_ID");
  const std::uint32_t first = variable(environment, "SLURM_ARRAY_TASK_MIN", 0);
  const std::uint32_t step = variable(environment, "SLURM_ARRAY_TASK_STEP", 1);
  const std::uint32_t count = variable(environment, "SLURM_ARRAY_TASK_COUNT");
  if (id < first || step == 0 || (id - first) % step != 0) {
    throw Failure(kExitUsage, "--shard auto: task " + std::to_string(id) + " of an array from " +
                                  std::to_string(first) + " in steps of " + std::to_string(step));
  }
  return checked("auto (SLURM_ARRAY_TASK_ID)", (id - first) / step + 1, count);
}

Shard of_parallel(const Environment& environment) {
  return checked("auto (PARALLEL_SEQ)", variable(environment, "PARALLEL_SEQ"),
                 variable(environment, "CYCLOID_SHARDS"));
}

}  // namespace

bool Shard::holds(std::span<const std::byte> bytes) const {
  return protocol::crc32c(bytes) % count == number - 1;
}

Environment system_environment() {
  return [](const std::string& name) {
    const char* value = std::getenv(name.c_str());
    return std::string(value == nullptr ? "" : value);
  };
}

Shard shard_of(const std::string& text, const Environment& environment) {
  if (text == "auto") {
    struct Scheduler {
      const char* variable;
      Shard (*shard)(const Environment&);
    };
    std::vector<Scheduler> found;
    for (const Scheduler& known :
         {Scheduler{"JOB_COMPLETION_INDEX", of_kubernetes},
          Scheduler{"SLURM_ARRAY_TASK_ID", of_slurm}, Scheduler{"PARALLEL_SEQ", of_parallel}})
      if (!environment(known.variable).empty()) found.push_back(known);
    if (found.empty()) {
      throw Failure(kExitUsage,
                    "--shard auto: none of JOB_COMPLETION_INDEX, SLURM_ARRAY_TASK_ID and "
                    "PARALLEL_SEQ is set");
    }
    if (found.size() > 1) {
      throw Failure(kExitUsage, std::string("--shard auto: both ") + found[0].variable + " and " +
                                    found[1].variable + " are set; say it as --shard I/N");
    }
    return found[0].shard(environment);
  }
  const std::size_t slash = text.find('/');
  const auto number = number_of(std::string_view(text).substr(0, slash));
  const auto count =
      slash == text.npos ? std::nullopt : number_of(std::string_view(text).substr(slash + 1));
  if (!number || !count) throw Failure(kExitUsage, "--shard: 'auto' or I/N, not '" + text + "'");
  return checked(text, *number, *count);
}

}  // namespace cycloid::cli
