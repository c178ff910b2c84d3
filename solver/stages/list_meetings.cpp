#include <bit>

#include "solver/bodies/body_kernels.hpp"
#include "solver/lane_widths.hpp"
#include "solver/stages/fast_bodies.hpp"
#include "solver/stages/in_chunks.hpp"
#include "solver/stages/may_touch.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// The box of all places of a shape on its way, m, and of what it would stop at. Its corners leave
/// the chords of their arcs by at most an eighth of the square of the turn.
template <int D>
static Bounds<D> bounds_of_way(const Shape<D>& shape, const Body<D>& body,
                               const BodySweep<D>& sweep, float target) {
  const float square = dot(sweep.turn, sweep.turn);
  if (square > kPi * kPi) {
    Vec<D> reach;
    for (float& value : reach.v) value = body.extent + target;
    const Vec<D> end = sweep.start.position + sweep.translation;
    return merged(Bounds<D>{sweep.start.position - reach, sweep.start.position + reach},
                  Bounds<D>{end - reach, end + reach});
  }
  const float margin = target + 0.126f * square * body.extent;
  return merged(bounds_of(shape, sweep.start, margin),
                bounds_of(shape, pose_at(sweep, 1.0f), margin));
}

/// Whether the ways of all shapes of a fast body lie in their boxes of this tick, as its motion
/// tells by itself: it flies no farther than it was going to when the boxes were made, and what it
/// turns by is within their margin. Says no where that is not certain.
template <int D>
static bool stays_in_boxes(const StepContext<D>& context, const Body<D>& body,
                           const Motion<D>& motion, float target) {
  // The corners of a hull's bounding box in space are farther from the centre than the hull.
  constexpr float kCorner = Dim<D>::kSpin == 1 ? 1.0f : 1.75f;
  constexpr float kRounding = 4.0e-6f;
  if (winds(context, motion)) return false;
  const float turn = turn_bound(motion.delta_rotation);
  const float reach = target + turn * (kCorner + 0.126f * turn) * body.extent;
  for (int i = 0; i < D; ++i) {
    const float flight = context.tick_s * body.velocity[i];
    const float way = motion.delta_position[i];
    const float rounding =
        kRounding * (abs(body.position[i]) + body.extent + abs(flight) + abs(way));
    const float room = context.tuning.speculative_distance - reach - rounding;
    if (max(way, 0.0f) - max(flight, 0.0f) > room) return false;
    if (min(flight, 0.0f) - min(way, 0.0f) > room) return false;
  }
  return true;
}

/// Finds the way of a shape of a fast body.
template <int D>
static void find_way(const StepContext<D>& context, const WorldState<D>& state, std::uint32_t shape,
                     StepScratch<D>& scratch) {
  const std::uint32_t slot = state.shapes[shape].body;
  const Body<D>& body = state.bodies[slot];
  scratch.ways[shape] =
      bounds_of_way(state.shapes[shape], body, sweep_of(context, state, scratch, slot),
                    stop_distance(context.tuning, body.thickness));
}

/// Of a range of fast bodies the shapes whose ways do not lie in their boxes of this tick.
template <int D>
static void list_outside(const StepContext<D>& context, const WorldState<D>& state, Range range,
                         StepScratch<D>& scratch, std::vector<std::uint32_t>& outside) {
  const PairCache<D>& cache = scratch.kept->pair_cache;
  for (int i = range.begin; i < range.end; ++i) {
    const std::uint32_t slot = scratch.fast_bodies[static_cast<std::size_t>(i)].slot;
    const Body<D>& body = state.bodies[slot];
    const bool stays = stays_in_boxes(context, body, scratch.motions[slot],
                                      stop_distance(context.tuning, body.thickness));
    for (std::uint32_t s = body.first_shape; s != kNone; s = state.shapes[s].next) {
      if (stays && cache.active[s] != 0) continue;
      find_way(context, state, s, scratch);
      scratch.way_is[s] = WayIs::kListed;
      if (cache.active[s] == 0 || !lies_in(scratch.ways[s], cache.boxes[s])) outside.push_back(s);
    }
  }
}

/// Sorts the shapes of fast bodies by where all that they may meet is listed: among the pairs of
/// this tick where their way lies in their box, else among the candidates where it lies in their
/// fat box; else they will search.
template <int D>
static void mark_ways(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                      StepScratch<D>& scratch) {
  const PairCache<D>& cache = scratch.kept->pair_cache;
  scratch.ways.resize(state.shapes.size());
  scratch.way_is.assign(state.shapes.size(), WayIs::kUnknown);
  scratch.straying.clear();
  scratch.searching.clear();
  std::vector<std::uint32_t>& outside = scratch.looking;
  outside.clear();
  list_in_chunks(workers, static_cast<int>(scratch.fast_bodies.size()), kPairGrain,
                 scratch.slot_chunks, outside, [&](Range range, std::vector<std::uint32_t>& out) {
                   list_outside(context, state, range, scratch, out);
                 });
  for (const std::uint32_t s : outside) {
    const bool is_near = cache.active[s] != 0 && lies_in(scratch.ways[s], cache.fat.box(s));
    (is_near ? scratch.straying : scratch.searching).push_back(s);
  }
}

/// Whether a fast body of two shapes may be stopped at the other.
template <int D>
static bool may_stop(const WorldState<D>& state, const StepScratch<D>& scratch,
                     const ShapePair& pair) {
  const auto [a, b] = pair;
  return place_if_stopped_at(state, scratch, a, b) != 0 ||
         place_if_stopped_at(state, scratch, b, a) != 0;
}

/// A bit for each pair of bodies of which one may pass through the other in the tick.
template <int D>
static std::uint64_t who_can_pass(const StepContext<D>& context, const WorldState<D>& state,
                                  const StepScratch<D>& scratch, const BodyPairs& pairs) {
  return at_width(widest_lanes(context.lanes), [&]<int W>() {
    const Body<D>* bodies = state.bodies.data();
    const Motion<D>* motions = scratch.motions.data();
    return in_lanes_that_hold<W>(pairs.count, [&]<int V>() {
      return BodyKernels<V>::can_pass(context.tick_s, bodies, motions, pairs);
    });
  });
}

/// Appends those pairs whose bodies can pass one another. @pre there are kPairGrain at most.
template <int D>
static void append_passing(const StepContext<D>& context, const WorldState<D>& state,
                           const StepScratch<D>& scratch, std::span<const ShapePair> pairs,
                           std::vector<ShapePair>& passing) {
  if (pairs.empty()) return;
  BodyPairs bodies;
  for (const ShapePair& pair : pairs) {
    bodies.a[bodies.count] = state.shapes[pair.shape_a].body;
    bodies.b[bodies.count++] = state.shapes[pair.shape_b].body;
  }
  std::uint64_t who = who_can_pass(context, state, scratch, bodies);
  for (; who != 0; who &= who - 1)
    passing.push_back(pairs[static_cast<std::size_t>(std::countr_zero(who))]);
}

/// Appends to `out` those of the pairs of which a fast body may be stopped that can pass through
/// the other.
template <int D>
static void list_passing(const StepContext<D>& context, const WorldState<D>& state,
                         const std::vector<ShapePair>& pairs, Workers& workers,
                         StepScratch<D>& scratch, std::vector<ShapePair>& out) {
  constexpr int kGrain = 16 * kPairGrain;
  const auto list = [&](Range range, std::vector<ShapePair>& passing) {
    ShapePair waiting[kPairGrain];
    std::size_t count = 0;
    for (int i = range.begin; i < range.end; ++i) {
      waiting[count] = pairs[static_cast<std::size_t>(i)];
      count += may_stop(state, scratch, waiting[count]) ? 1 : 0;
      if (count < kPairGrain) continue;
      append_passing<D>(context, state, scratch, waiting, passing);
      count = 0;
    }
    append_passing<D>(context, state, scratch, std::span(waiting).first(count), passing);
  };
  list_in_chunks(workers, static_cast<int>(pairs.size()), kGrain, scratch.pair_chunks, out, list);
}

/// The ways of those shapes of fast bodies that are in one of these pairs and have none yet.
template <int D>
static void find_ways(const StepContext<D>& context, const WorldState<D>& state,
                      const std::vector<ShapePair>& pairs, Workers& workers,
                      StepScratch<D>& scratch) {
  std::vector<std::uint32_t>& wanted = scratch.looking;
  wanted.clear();
  for (const ShapePair& pair : pairs)
    for (const std::uint32_t s : {pair.shape_a, pair.shape_b}) {
      if (scratch.fast_of_shape[s] == 0 || scratch.way_is[s] != WayIs::kUnknown) continue;
      scratch.way_is[s] = WayIs::kListed;
      wanted.push_back(s);
    }
  workers.parallel_for(static_cast<int>(wanted.size()), kPairGrain, [&](Range range) {
    for (int i = range.begin; i < range.end; ++i)
      find_way(context, state, wanted[static_cast<std::size_t>(i)], scratch);
  });
}

/// Whether the box of a shape is met on the way of another, of which it is known how it is looked
/// up.
template <int D>
static bool meets(const StepScratch<D>& scratch, WayIs found, std::uint32_t fast,
                  std::uint32_t other) {
  return scratch.way_is[fast] == found &&
         overlaps(scratch.kept->pair_cache.boxes[other], scratch.ways[fast]);
}

/// The meetings on the way of a shape that searches, but for those that a lower one finds.
template <int D>
static void search(const WorldState<D>& state, const StepScratch<D>& scratch, std::uint32_t shape,
                   std::vector<ShapePair>& found) {
  const Bounds<D>& way = scratch.ways[shape];
  const auto meet = [&](std::uint32_t other) {
    if (!meets(scratch, WayIs::kSearched, shape, other)) return;
    if (other < shape && meets(scratch, WayIs::kSearched, other, shape)) return;
    if (may_touch(state, scratch, shape, other))
      found.push_back(shape < other ? ShapePair{shape, other} : ShapePair{other, shape});
  };
  for (const std::uint32_t half_space : scratch.kept->unbounded) meet(half_space);
  scratch.kept->static_tree.query(way,
                                  [&](int rank) { meet(scratch.kept->static_tree.leaf(rank).id); });
  scratch.kept->pair_cache.fat.query(way, meet);
}

/// Appends what shapes that search meet on their ways.
template <int D>
static void search_all(const WorldState<D>& state, Workers& workers, StepScratch<D>& scratch,
                       std::vector<ShapePair>& out) {
  const std::vector<std::uint32_t>& searching = scratch.searching;
  const auto list = [&](Range range, std::vector<ShapePair>& found) {
    for (int i = range.begin; i < range.end; ++i)
      search(state, scratch, searching[static_cast<std::size_t>(i)], found);
  };
  list_in_chunks(workers, static_cast<int>(searching.size()), kPairGrain, scratch.pair_chunks, out,
                 list);
}

/// Appends the pairs of which one meets the other's box on its way and no search finds it.
template <int D>
static void list_met(const std::vector<ShapePair>& pairs, Workers& workers, StepScratch<D>& scratch,
                     std::vector<ShapePair>& out) {
  const auto is_listed = [&](std::uint32_t fast, std::uint32_t other) {
    return meets(scratch, WayIs::kListed, fast, other) &&
           !meets(scratch, WayIs::kSearched, other, fast);
  };
  const auto list = [&](Range range, std::vector<ShapePair>& found) {
    append_if(pairs, range, found, [&](const ShapePair& pair) {
      return is_listed(pair.shape_a, pair.shape_b) || is_listed(pair.shape_b, pair.shape_a);
    });
  };
  list_in_chunks(workers, static_cast<int>(pairs.size()), kLookGrain, scratch.pair_chunks, out,
                 list);
}

/// The pairs of shapes of which one is of a fast body that may be stopped at the other, can pass
/// through it, and meets its box on its way.
///
/// Reads fast bodies, motions, bodies, shapes and the boxes, pairs and candidates of find_pairs;
/// writes ways and the meetings. Which pairs those are depends on bodies, boxes and ways alone: a
/// box has its pairs, and a fat box its candidates, wherever it holds the way; so what is cached
/// shows only in their order, which changes no least fraction.
template <int D>
void list_meetings(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                   StepScratch<D>& scratch) {
  // So many candidates are passed by in the time of one search.
  constexpr std::size_t kCandidatesPerSearch = 100;
  scratch.meetings.clear();
  if (scratch.fast_bodies.empty()) return;
  mark_ways(context, state, workers, scratch);
  const std::vector<ShapePair>& candidates = scratch.kept->pair_cache.candidates;
  std::vector<std::uint32_t>& searching = scratch.searching;
  const bool many_leave = scratch.straying.size() * kCandidatesPerSearch > candidates.size();
  if (!many_leave)
    searching.insert(searching.end(), scratch.straying.begin(), scratch.straying.end());
  for (const std::uint32_t s : searching) scratch.way_is[s] = WayIs::kSearched;
  std::vector<ShapePair>& some = scratch.some_pairs;
  some.clear();
  if (many_leave) {
    // Most of them are not near. Who leaves has a way; who stays in its box meets but its pairs.
    find_ways(context, state, scratch.pairs, workers, scratch);
    list_met(candidates, workers, scratch, some);
    list_passing(context, state, some, workers, scratch, scratch.meetings);
  } else {
    // All are near, most fly side by side, and have no ways.
    list_passing(context, state, scratch.pairs, workers, scratch, some);
    find_ways(context, state, some, workers, scratch);
    list_met(some, workers, scratch, scratch.meetings);
  }
  some.clear();
  search_all(state, workers, scratch, some);
  list_passing(context, state, some, workers, scratch, scratch.meetings);
}

template void list_meetings(const StepContext<2>&, const WorldState<2>&, Workers&, StepScratch<2>&);
template void list_meetings(const StepContext<3>&, const WorldState<3>&, Workers&, StepScratch<3>&);

}  // namespace cycloid::solver
