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

/// Of the fresh candidates those whose keys are from that of the old one at `places.begin` on, and
/// below that at `places.end`: of the first and the last range, whatever is below or above.
template <int D>
static void take_fresh(const PairCache<D>& cache, Range places, const std::vector<ShapePair>& fresh,
                       std::vector<ShapePair>& taken) {
  const auto end = static_cast<int>(cache.candidates.size());
  const auto key_at = [&](int place) {
    return cache.candidates[static_cast<std::size_t>(place)].key();
  };
  const std::uint64_t least = places.begin == 0 ? 0 : key_at(places.begin);
  const std::uint64_t above = places.end == end ? ~std::uint64_t{0} : key_at(places.end);
  taken.clear();
  append_if(fresh, {0, static_cast<int>(fresh.size())}, taken,
            [&](const ShapePair& pair) { return pair.key() >= least && pair.key() < above; });
}

/// Old candidates and new ones become one list in the order of their keys, without the old ones of
/// shapes that looked anew; after it nobody looks. Several threads each take a range of keys, with
/// as many old ones as any other.
///
/// Reads the fresh candidates, in any order, and who looks; writes the candidates, and leaves of
/// the fresh ones none. Keys are whole pairs, so ranges cannot be seen in the list.
template <int D>
void merge_candidates(std::uint32_t shapes, Workers& workers, StepScratch<D>& scratch) {
  PairCache<D>& cache = scratch.kept->pair_cache;
  std::vector<CandidateRange>& ranges = scratch.candidate_ranges;
  const int count = cache.candidates.size() < kSharedMin ? 1 : workers.count();
  if (ranges.size() < static_cast<std::size_t>(count))
    ranges.resize(static_cast<std::size_t>(count));
  const auto fresh_of = [&](CandidateRange& range) -> std::vector<ShapePair>& {
    return count == 1 ? scratch.fresh_candidates : range.fresh;
  };
  const auto begin_of = [&](int range) {
    return static_cast<int>(cache.candidates.size() * static_cast<std::size_t>(range) /
                            static_cast<std::size_t>(count));
  };
  workers.parallel_for(count, 1, [&](Range one) {
    CandidateRange& range = ranges[static_cast<std::size_t>(one.begin)];
    const Range places{begin_of(one.begin), begin_of(one.end)};
    keep_old(cache, places, range.kept);
    if (count > 1) take_fresh(cache, places, scratch.fresh_candidates, range.fresh);
    sort_pairs(shapes, range.room, fresh_of(range));
  });
  std::size_t end = 0;
  for (int i = 0; i < count; ++i) {
    CandidateRange& range = ranges[static_cast<std::size_t>(i)];
    range.begin = end;
    end += range.kept.size() + fresh_of(range).size();
  }
  cache.candidates.resize(end);
  workers.parallel_for(count, 1, [&](Range one) {
    CandidateRange& range = ranges[static_cast<std::size_t>(one.begin)];
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
  static constexpr auto kMerge = &merge_candidates<D>;
  static constexpr auto kWake = &wake_candidates<D>;
  static constexpr auto kLay = &lay_candidates_to_rest<D>;
};
template struct InstantiateCandidates<2>;
template struct InstantiateCandidates<3>;

}  // namespace cycloid::solver
