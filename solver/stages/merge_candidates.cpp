#include <algorithm>

#include "solver/collision/sort_pairs.hpp"
#include "solver/stages/in_chunks.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Of fewer old candidates each thread would have less to do than to wait for.
static constexpr std::size_t kSharedMin = 4096;

static bool is_below(const ShapePair& one, const ShapePair& other) {
  return one.key() < other.key();
}

/// Of the old candidates those in `places` whose shapes have not looked anew.
template <int D>
static void keep_old(const PairCache<D>& cache, Range places, std::vector<ShapePair>& kept) {
  kept.clear();
  append_if(cache.candidates, places, kept, [&](const ShapePair& pair) {
    return (cache.looks[pair.shape_a] | cache.looks[pair.shape_b]) == 0;
  });
}

/// All that was found for a range.
template <int D>
static void take_fresh(std::size_t at, StepScratch<D>& scratch) {
  std::vector<ShapePair>& fresh = scratch.candidate_ranges[at].fresh;
  fresh.clear();
  for (std::size_t chunk = 0; chunk < scratch.fresh_chunks; ++chunk) {
    const auto& part = scratch.fresh_parts[chunk * scratch.used_ranges + at];
    fresh.insert(fresh.end(), part.begin(), part.end());
  }
}

/// Cuts the keys into ranges that have as many old candidates as any other, one for each thread.
///
/// Reads the candidates; writes the ranges, which cannot be seen in what is made of them.
template <int D>
void cut_candidates(const Workers& workers, StepScratch<D>& scratch) {
  const std::vector<ShapePair>& candidates = scratch.kept->pair_cache.candidates;
  std::vector<CandidateRange>& ranges = scratch.candidate_ranges;
  scratch.used_ranges =
      candidates.size() < kSharedMin ? 1 : static_cast<std::size_t>(workers.count());
  if (ranges.size() < scratch.used_ranges) ranges.resize(scratch.used_ranges);
  const auto begin_of = [&](std::size_t range) {
    return static_cast<int>(candidates.size() * range / scratch.used_ranges);
  };
  for (std::size_t i = 0; i < scratch.used_ranges; ++i) {
    ranges[i].places = {begin_of(i), begin_of(i + 1)};
    ranges[i].least =
        i == 0 ? 0 : candidates[static_cast<std::size_t>(ranges[i].places.begin)].key();
    ranges[i].above = ~std::uint64_t{0};
    if (i > 0) ranges[i - 1].above = ranges[i].least;
  }
}

/// Old candidates and new ones become one list in the order of their keys, without the old ones of
/// shapes that looked anew; after it nobody looks. Each thread takes a range of keys.
///
/// Reads the fresh candidates, in any order, and who looks; writes the candidates, and leaves of
/// the fresh ones none. Keys are whole pairs, so ranges cannot be seen in the list.
/// @pre cut_candidates.
template <int D>
void merge_candidates(std::uint32_t shapes, Workers& workers, StepScratch<D>& scratch) {
  PairCache<D>& cache = scratch.kept->pair_cache;
  const auto count = static_cast<int>(scratch.used_ranges);
  const auto fresh_of = [&](CandidateRange& range) -> std::vector<ShapePair>& {
    return count == 1 ? scratch.fresh_candidates : range.fresh;
  };
  workers.parallel_for(count, 1, [&](Range one) {
    const auto at = static_cast<std::size_t>(one.begin);
    CandidateRange& range = scratch.candidate_ranges[at];
    keep_old(cache, range.places, range.kept);
    if (count > 1) take_fresh(at, scratch);
    sort_pairs(shapes, range.room, fresh_of(range));
  });
  std::size_t end = 0;
  for (std::size_t i = 0; i < scratch.used_ranges; ++i) {
    CandidateRange& range = scratch.candidate_ranges[i];
    range.begin = end;
    end += range.kept.size() + fresh_of(range).size();
  }
  cache.candidates.resize(end);
  workers.parallel_for(count, 1, [&](Range one) {
    CandidateRange& range = scratch.candidate_ranges[static_cast<std::size_t>(one.begin)];
    const std::vector<ShapePair>& fresh = fresh_of(range);
    std::merge(range.kept.begin(), range.kept.end(), fresh.begin(), fresh.end(),
               cache.candidates.begin() + static_cast<std::ptrdiff_t>(range.begin), is_below);
  });
  scratch.fresh_candidates.clear();
  for (const std::uint32_t shape : scratch.looking) cache.looks[shape] = 0;
  scratch.looking.clear();
}

/// All candidates become one list again, where dormant ones may be so no longer.
template <int D>
void wake_candidates(StepScratch<D>& scratch) {
  PairCache<D>& cache = scratch.kept->pair_cache;
  if (cache.dormant.empty()) return;
  std::vector<ShapePair>& merged = scratch.fresh_candidates;
  merged.resize(cache.candidates.size() + cache.dormant.size());
  std::merge(cache.candidates.begin(), cache.candidates.end(), cache.dormant.begin(),
             cache.dormant.end(), merged.begin(), is_below);
  cache.candidates.assign(merged.begin(), merged.end());
  cache.dormant.clear();
}

/// Puts those aside of which neither shape takes part. @pre none is put aside.
template <int D>
void lay_candidates_to_rest(PairCache<D>& cache) {
  std::size_t kept = 0;
  for (const ShapePair& pair : cache.candidates) {
    if ((cache.active[pair.shape_a] | cache.active[pair.shape_b]) != 0)
      cache.candidates[kept++] = pair;
    else
      cache.dormant.push_back(pair);
  }
  cache.candidates.resize(kept);
}

template <int D>
struct InstantiateCandidates {
  static constexpr auto kCut = &cut_candidates<D>;
  static constexpr auto kMerge = &merge_candidates<D>;
  static constexpr auto kWake = &wake_candidates<D>;
  static constexpr auto kLay = &lay_candidates_to_rest<D>;
};
template struct InstantiateCandidates<2>;
template struct InstantiateCandidates<3>;

}  // namespace cycloid::solver
