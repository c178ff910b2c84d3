#pragma once

#include <algorithm>
#include <vector>

#include "solver/workers.hpp"

namespace cycloid::solver {

/// Calls `list(range, chunk)` for ranges of `grain` that cover [0, count), each with an empty chunk
/// of its own. @returns how many chunks those are, in the order of the ranges.
template <class T, class List>
std::size_t fill_chunks(Workers& workers, int count, int grain, std::vector<std::vector<T>>& chunks,
                        List&& list) {
  const auto used = static_cast<std::size_t>((count + grain - 1) / grain);
  if (chunks.size() < used) chunks.resize(used);
  workers.parallel_for(count, grain, [&](Range range) {
    std::vector<T>& chunk = chunks[static_cast<std::size_t>(range.begin / grain)];
    chunk.clear();
    list(range, chunk);
  });
  return used;
}

/// Appends to `out` what `list(range, list_of_range)` lists for ranges that cover [0, count), in
/// their order. One thread lists all at once into `out`; of several each fills lists of its own,
/// the `chunks`, which keep their memory for the next time. So threads cannot be seen, as long as
/// what a range lists does not depend on where it begins.
template <class T, class List>
void list_in_chunks(Workers& workers, int count, int grain, std::vector<std::vector<T>>& chunks,
                    std::vector<T>& out, List&& list) {
  if (workers.count() == 1 || count <= grain) return list(Range{0, count}, out);
  const std::size_t used = fill_chunks(workers, count, grain, chunks, list);
  for (std::size_t i = 0; i < used; ++i) out.insert(out.end(), chunks[i].begin(), chunks[i].end());
}

/// As list_in_chunks, but what is listed takes the place of what was in `out`, and each thread puts
/// its chunks there itself: of many records one thread alone would have to fetch half from another.
template <class T, class List>
void list_anew_in_chunks(Workers& workers, int count, int grain,
                         std::vector<std::vector<T>>& chunks, std::vector<T>& out, List&& list) {
  if (workers.count() == 1 || count <= grain) {
    out.clear();
    return list(Range{0, count}, out);
  }
  const std::size_t used = fill_chunks(workers, count, grain, chunks, list);
  const auto listed_before = [&](std::size_t end) {
    std::size_t listed = 0;
    for (std::size_t i = 0; i < end; ++i) listed += chunks[i].size();
    return static_cast<std::ptrdiff_t>(listed);
  };
  out.resize(static_cast<std::size_t>(listed_before(used)));
  workers.parallel_for(count, grain, [&](Range range) {
    const auto chunk = static_cast<std::size_t>(range.begin / grain);
    std::copy(chunks[chunk].begin(), chunks[chunk].end(), out.begin() + listed_before(chunk));
  });
}

/// Appends those of from[range] that `keep` says yes to. Without a branch, because which do is
/// anybody's guess where this is asked.
template <class T, class Keep>
void append_if(const std::vector<T>& from, Range range, std::vector<T>& out, Keep&& keep) {
  std::size_t kept = out.size();
  out.resize(kept + static_cast<std::size_t>(range.end - range.begin));
  for (int i = range.begin; i < range.end; ++i) {
    const T& record = from[static_cast<std::size_t>(i)];
    out[kept] = record;
    kept += keep(record) ? 1 : 0;
  }
  out.resize(kept);
}

}  // namespace cycloid::solver
