#pragma once

#include <algorithm>
#include <span>
#include <vector>

#include "solver/workers.hpp"

namespace cycloid::solver {

/// How colours are run on all threads. The one place that knows why lanes and threads cannot change
/// a bit: what runs at the same time shares no body that moves.

/// So many blocks, or joints, of a colour take less time than for two threads to meet after them.
inline constexpr int kFewOfColor = 8;

inline bool is_shared(const Range& color) {
  return color.end - color.begin > kFewOfColor;
}

/// Runs `run(range)` for a member's part of a colour: of one with few the leader has all.
template <class Run>
void run_part(const Member& member, const Range& color, Run&& run) {
  if (is_shared(color)) {
    const Range part = member.share_of(color);
    if (part.begin < part.end) run(part);
  } else if (member.leads() && color.begin < color.end) {
    run(color);
  }
}

/// Has a member meet the others between colours, but for those that the leader has alone.
class ColorOrder {
 public:
  explicit ColorOrder(Member& member) : member_(member) {}
  void begin_color(bool shared) {
    if (has_begun_ && (shared || was_shared_)) member_.meet();
    has_begun_ = true;
    was_shared_ = shared;
  }

 private:
  Member& member_;
  bool has_begun_ = false;
  bool was_shared_ = false;
};

/// Whether it is worth to call other threads for these.
inline bool is_any_shared(std::span<const Range> colors, const Workers& workers) {
  return workers.count() > 1 && std::any_of(colors.begin(), colors.end(), is_shared);
}

/// Runs `run(index)` for what fitted no colour.
template <class Run>
void run_overflow(const Member& member, const Range& overflow, ColorOrder& order, Run&& run) {
  if (overflow.begin == overflow.end) return;
  order.begin_color(false);
  if (!member.leads()) return;
  for (int i = overflow.begin; i < overflow.end; ++i) run(i);
}

/// Runs `run(range)` for ranges of every colour in order, those of one colour in parallel, and for
/// the overflow one by one.
template <class Run>
void for_each_range_by_color(std::span<const Range> colors, Range overflow, Workers& workers,
                             Run&& run) {
  const auto run_one = [&](int i) { run(Range{i, i + 1}); };
  if (!is_any_shared(colors, workers)) {
    for (const Range& color : colors)
      if (color.begin < color.end) run(color);
    for (int i = overflow.begin; i < overflow.end; ++i) run_one(i);
    return;
  }
  workers.together([&](Member& member) {
    ColorOrder order(member);
    for (const Range& color : colors) {
      order.begin_color(is_shared(color));
      run_part(member, color, run);
    }
    run_overflow(member, overflow, order, run_one);
  });
}

/// The same for what asks for no order.
template <class Run>
void for_each_part_of_colors(std::span<const Range> colors, Range overflow, Workers& workers,
                             Run&& run) {
  auto run_parts = [&](Member& member) {
    for (const Range& color : colors) run_part(member, color, run);
    if (member.leads() && overflow.begin < overflow.end) run(overflow);
  };
  if (is_any_shared(colors, workers)) return workers.together(run_parts);
  Member alone;
  run_parts(alone);
}

/// Appends to `out` what `list(range, list_of_range)` lists for every colour and the overflow, in
/// their order. As `list_in_chunks`, but each thread looks at what it solves: a block that another
/// one has looked at has to be fetched back from its cache.
template <class T, class List>
void list_by_color(std::span<const Range> colors, Range overflow, Workers& workers,
                   std::vector<std::vector<T>>& parts, std::vector<T>& out, List&& list) {
  if (!is_any_shared(colors, workers)) {
    for (const Range& color : colors) list(color, out);
    return list(overflow, out);
  }
  const auto threads = static_cast<std::size_t>(workers.count());
  const std::size_t used = (colors.size() + 1) * threads;
  if (parts.size() < used) parts.resize(used);
  workers.together([&](Member& member) {
    const auto part_of = [&](std::size_t color) -> std::vector<T>& {
      return parts[color * threads + static_cast<std::size_t>(member.number())];
    };
    for (std::size_t color = 0; color <= colors.size(); ++color) part_of(color).clear();
    for (std::size_t color = 0; color < colors.size(); ++color)
      run_part(member, colors[color], [&](Range range) { list(range, part_of(color)); });
    if (member.leads()) list(overflow, part_of(colors.size()));
  });
  for (std::size_t i = 0; i < used; ++i) out.insert(out.end(), parts[i].begin(), parts[i].end());
}

}  // namespace cycloid::solver
