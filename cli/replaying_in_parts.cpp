#include <algorithm>
#include <exception>
#include <vector>

#include "cli/replaying.hpp"
#include "cli/side_by_side.hpp"

namespace cycloid::cli {
namespace {

/// The last ticks of up to `count` parts of about the same length; all but the last are keyframes.
std::vector<std::uint64_t> ends_of_parts(const LoadedLog& loaded, const ReplayOptions& options,
                                         int count) {
  const std::uint64_t last = options.to.value_or(loaded.last_tick());
  std::uint64_t begin = std::max(options.from, loaded.log.header.branch_tick);
  const std::uint64_t length = last - std::min(begin, last);
  const auto parts = static_cast<std::uint64_t>(std::max(count, 1));
  std::vector<std::uint64_t> ends;
  for (std::uint64_t i = 1; i < parts; ++i) {
    const auto* place = loaded.log.keyframe_before(last - length / parts * (parts - i));
    if (place == nullptr || place->tick <= begin) continue;
    begin = place->tick;
    ends.push_back(begin);
  }
  ends.push_back(last);
  return ends;
}

struct Part {
  Replayed replayed;
  std::exception_ptr failure;  ///< It could not begin.
};

void add(const Replayed& part, Replayed& whole) {
  whole.ticks += part.ticks;
  whole.keyframes += part.keyframes;
  whole.digest = part.digest;
  whole.divergence = part.divergence;
  whole.timed_out = part.timed_out;
}

}  // namespace

Replayed replay_in_parts(const LoadedLog& loaded, const ReplayOptions& options, int jobs) {
  const std::vector<std::uint64_t> ends = ends_of_parts(loaded, options, jobs);
  std::vector<Part> parts(ends.size());
  side_by_side(parts.size(), jobs, [&](std::size_t i) {
    ReplayOptions of_part = options;
    if (i > 0) of_part.from = ends[i - 1];
    of_part.to = ends[i];
    try {
      parts[i].replayed = replay(loaded, of_part);
    } catch (...) {  // A part before it may say more: that its keyframe is not what was made.
      parts[i].failure = std::current_exception();
    }
  });
  Replayed whole;
  whole.from = parts.front().replayed.from;
  for (const Part& part : parts) {
    if (part.failure) std::rethrow_exception(part.failure);
    if (!whole.timed_out)
      add(part.replayed, whole);
    else  // Behind ticks that nobody has compared; what is found there is found.
      whole.divergence = part.replayed.divergence;
    if (whole.divergence) break;
  }
  return whole;
}

}  // namespace cycloid::cli
