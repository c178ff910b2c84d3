#include <bit>

#include "solver/bodies/body_kernels.hpp"
#include "solver/lane_widths.hpp"
#include "solver/stages/fast_bodies.hpp"
#include "solver/stages/in_chunks.hpp"
#include "solver/stages/may_touch.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Whether it moves so little in a tick that `is_fast` is false. Most do, and to be sure of it is
/// cheaper than its way.
static bool is_slow(const StepContext<3>& context, const Body<3>& body, const Motion<3>& motion) {
  const Spin<3> spun = context.tick_s * motion.spin;
  if (dot(spun, spun) > 9.0f) return false;
  const float way = length(motion.delta_position) + body.extent * turn_bound(motion.delta_rotation);
  return 1.001f * way < 0.5f * body.thickness;
}

/// Whether it moves so far in a tick that it could pass through something, or over its corner. What
/// flies that far is asked for no turn.
template <int D>
static bool is_fast(const StepContext<D>& context, const Body<D>& body, const Motion<D>& motion) {
  if (!responds(body.kind) || body.extent == 0.0f) return false;
  const float flown = length(motion.delta_position);
  const float enough = 0.5f * body.thickness;
  return flown > enough || flown + body.extent * length(turn_in(context, motion)) > enough;
}

/// A bit for each of these bodies of which is_slow is not certain. @pre there are 64 at most.
static std::uint64_t moved_far(const StepContext<3>& context, const WorldState<3>& state,
                               std::span<const std::uint32_t> slots,
                               const StepScratch<3>& scratch) {
  std::uint64_t far = 0;
  for (std::size_t i = 0; i < slots.size(); ++i)
    if (!is_slow(context, state.bodies[slots[i]], scratch.motions[slots[i]]))
      far |= std::uint64_t{1} << i;
  return far;
}
static std::uint64_t moved_far(const StepContext<2>& context, const WorldState<2>& state,
                               std::span<const std::uint32_t> slots,
                               const StepScratch<2>& scratch) {
  return at_width(widest_lanes(context.lanes), [&]<int W>() {
    return BodyKernels<W>::moved_far(context.tick_s, state.bodies.data(), slots.data(),
                                     static_cast<int>(slots.size()), scratch.motions.data());
  });
}

template <int D>
static void list_fast(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                      StepScratch<D>& scratch) {
  const std::vector<std::uint32_t>& awake = scratch.awake_bodies;
  scratch.fast_bodies.clear();
  const auto list = [&](Range range, std::vector<FastBody>& fast) {
    for (int begin = range.begin; begin < range.end; begin += kPairGrain) {
      const auto slots = std::span(awake).subspan(
          static_cast<std::size_t>(begin),
          static_cast<std::size_t>(std::min(kPairGrain, range.end - begin)));
      std::uint64_t far = moved_far(context, state, slots, scratch);
      for (; far != 0; far &= far - 1) {
        const std::uint32_t slot = slots[static_cast<std::size_t>(std::countr_zero(far))];
        if (is_fast(context, state.bodies[slot], scratch.motions[slot])) fast.push_back({slot});
      }
    }
  };
  list_in_chunks(workers, static_cast<int>(awake.size()), kPairGrain, scratch.fast_chunks,
                 scratch.fast_bodies, list);
}

/// Of the speed of what is pushed, how much at the least its contact shares.
static constexpr float kPushShare = 0.25f;

/// Marks the fast bodies that another one pushes along: through a contact that carries an impulse
/// and itself moves on, along its normal, at a good part of the body's speed; and farther than
/// contacts are made, so that to lose that way matters. Cards, of which the slowest is fast, would
/// otherwise pass through one another.
template <int D>
static void mark_pushed(const StepContext<D>& context, StepScratch<D>& scratch) {
  const float near = context.tuning.speculative_distance;
  const auto mark = [&](std::uint32_t shape, float along, const Vec<D>& velocity) {
    if (scratch.fast_of_shape[shape] == 0) return;
    if (context.tick_s * along > near && along > kPushShare * length(velocity))
      scratch.fast_bodies[scratch.fast_of_shape[shape] - 1].is_pushed = true;
  };
  for (const LiveContact<D>& live : scratch.live) {
    const Contact<D>& contact = scratch.contacts[live.contact];
    const std::uint32_t a = contact.shape_a;
    const std::uint32_t b = contact.shape_b;
    if ((scratch.fast_of_shape[a] | scratch.fast_of_shape[b]) == 0) continue;
    float impulse = 0.0f;
    for (std::uint32_t p = 0; p < contact.point_count; ++p)
      impulse += contact.points[p].normal_impulse;
    if (!(impulse > 0.0f)) continue;
    const Manifold<D>& manifold = live.manifold;
    const auto velocity_of = [&](std::uint32_t body, const Vec<D>& arm) {
      const Motion<D>& motion = scratch.motions[body];
      return motion.velocity + spin_cross(motion.spin, arm);
    };
    const Vec<D> velocity_a = velocity_of(live.body_a, manifold.points[0].anchor_a);
    const Vec<D> velocity_b =
        velocity_of(live.body_b, anchor_b_of(manifold.points[0], live.between));
    const float along_a = dot(manifold.normal, velocity_a);
    const float along_b = dot(manifold.normal, velocity_b);
    mark(b, min(along_a, along_b), velocity_b);
    mark(a, min(-along_a, -along_b), velocity_a);
  }
}

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

/// Sorts the shapes of fast bodies by where all that they may meet is listed: among the pairs of
/// this tick where their way lies in their box, else among the candidates where it lies in their
/// fat box; else they will search.
template <int D>
static void mark_ways(const StepContext<D>& context, const WorldState<D>& state,
                      StepScratch<D>& scratch) {
  const PairCache<D>& cache = scratch.kept->pair_cache;
  scratch.fast_of_shape.assign(state.shapes.size(), 0);
  scratch.ways.resize(state.shapes.size());
  scratch.way_is.assign(state.shapes.size(), WayIs::kUnknown);
  scratch.leaving.clear();
  scratch.searching.clear();
  for (std::uint32_t place = 0; place < scratch.fast_bodies.size(); ++place) {
    const std::uint32_t slot = scratch.fast_bodies[place].slot;
    const Body<D>& body = state.bodies[slot];
    const Motion<D>& motion = scratch.motions[slot];
    const bool stays =
        stays_in_boxes(context, body, motion, stop_distance(context.tuning, body.thickness));
    for (std::uint32_t s = body.first_shape; s != kNone; s = state.shapes[s].next) {
      scratch.fast_of_shape[s] = place + 1;
      if (stays && cache.active[s] != 0) continue;
      find_way(context, state, s, scratch);
      scratch.way_is[s] = WayIs::kListed;
      if (cache.active[s] != 0 && lies_in(scratch.ways[s], cache.boxes[s])) continue;
      if (cache.active[s] != 0 && lies_in(scratch.ways[s], cache.fat.box(s)))
        scratch.leaving.push_back(s);
      else
        scratch.searching.push_back(s);
    }
  }
}

/// The ways of those shapes of fast bodies that are in a pair and have none yet.
template <int D>
static void find_ways_of_pairs(const StepContext<D>& context, const WorldState<D>& state,
                               Workers& workers, StepScratch<D>& scratch) {
  std::vector<std::uint32_t>& wanted = scratch.looking;
  wanted.clear();
  for (const ShapePair& pair : scratch.pairs)
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

/// Appends the meetings among these pairs that no search finds.
template <int D>
static void list_among(const std::vector<ShapePair>& pairs, Workers& workers,
                       StepScratch<D>& scratch) {
  constexpr int kGrain = 1024;
  const auto is_listed = [&](std::uint32_t fast, std::uint32_t other) {
    return meets(scratch, WayIs::kListed, fast, other) &&
           !meets(scratch, WayIs::kSearched, other, fast);
  };
  const auto list = [&](Range range, std::vector<ShapePair>& found) {
    append_if(pairs, range, found, [&](const ShapePair& pair) {
      return is_listed(pair.shape_a, pair.shape_b) || is_listed(pair.shape_b, pair.shape_a);
    });
  };
  list_in_chunks(workers, static_cast<int>(pairs.size()), kGrain, scratch.pair_chunks,
                 scratch.meetings, list);
}

/// The pairs of shapes of which one is of a fast body and meets the box of the other on its way.
///
/// Reads motions, bodies, shapes and the boxes, pairs and candidates of find_pairs; writes the fast
/// bodies, ways and the meetings. Which pairs those are depends on boxes and ways alone: a box has
/// its pairs, and a fat box its candidates, wherever it holds the way; so what is cached shows only
/// in their order, which changes no least fraction.
template <int D>
void list_meetings(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                   StepScratch<D>& scratch) {
  // So many candidates are passed by in the time of one search.
  constexpr std::size_t kCandidatesPerSearch = 100;
  scratch.meetings.clear();
  list_fast(context, state, workers, scratch);
  if (scratch.fast_bodies.empty()) return;
  mark_ways(context, state, scratch);
  mark_pushed(context, scratch);
  find_ways_of_pairs(context, state, workers, scratch);
  const std::vector<ShapePair>& candidates = scratch.kept->pair_cache.candidates;
  std::vector<std::uint32_t>& searching = scratch.searching;
  const bool many_leave = scratch.leaving.size() * kCandidatesPerSearch > candidates.size();
  if (!many_leave)
    searching.insert(searching.end(), scratch.leaving.begin(), scratch.leaving.end());
  for (const std::uint32_t s : searching) scratch.way_is[s] = WayIs::kSearched;
  list_among(many_leave ? candidates : scratch.pairs, workers, scratch);
  const auto search_all = [&](Range range, std::vector<ShapePair>& pairs) {
    for (int i = range.begin; i < range.end; ++i)
      search(state, scratch, searching[static_cast<std::size_t>(i)], pairs);
  };
  list_in_chunks(workers, static_cast<int>(searching.size()), kPairGrain, scratch.pair_chunks,
                 scratch.meetings, search_all);
}

template void list_meetings(const StepContext<2>&, const WorldState<2>&, Workers&, StepScratch<2>&);
template void list_meetings(const StepContext<3>&, const WorldState<3>&, Workers&, StepScratch<3>&);

}  // namespace cycloid::solver
