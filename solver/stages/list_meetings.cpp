#include "solver/stages/fast_bodies.hpp"
#include "solver/stages/in_chunks.hpp"
#include "solver/stages/may_touch.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Whether it moves so little in a tick that `is_fast` is false. Most do, and to be sure of it is
/// cheaper than its way.
template <int D>
static bool is_slow(const StepContext<D>& context, const Body<D>& body, const Motion<D>& motion) {
  const Spin<D> spun = context.tick_s * motion.spin;
  if (dot(spun, spun) > 9.0f) return false;
  const float way = length(motion.delta_position) + body.extent * turn_bound(motion.delta_rotation);
  return 1.001f * way < 0.5f * body.thickness;
}

/// Whether it moves so far in a tick that it could pass through something, or over its corner.
template <int D>
static bool is_fast(const Body<D>& body, const BodySweep<D>& sweep) {
  if (!responds(body.kind) || body.extent == 0.0f) return false;
  const float way = length(sweep.translation) + body.extent * length(sweep.turn);
  return way > 0.5f * body.thickness;
}

template <int D>
static void list_fast(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                      StepScratch<D>& scratch) {
  const std::vector<std::uint32_t>& awake = scratch.awake_bodies;
  scratch.fast_bodies.clear();
  const auto list = [&](Range range, std::vector<FastBody<D>>& fast) {
    for (auto i = static_cast<std::size_t>(range.begin); i < static_cast<std::size_t>(range.end);
         ++i) {
      const Body<D>& body = state.bodies[awake[i]];
      if (is_slow(context, body, scratch.motions[awake[i]])) continue;
      const BodySweep<D> sweep = sweep_of(context, state, scratch, awake[i]);
      if (is_fast(body, sweep)) fast.push_back({awake[i], sweep});
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
    const Vec<D> velocity_b = velocity_of(live.body_b, manifold.points[0].anchor_b);
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

/// Marks the shapes of fast bodies, with the boxes of their ways. Where the candidates of this tick
/// do not have all that such a box may meet, the shape will search.
template <int D>
static void mark_ways(const StepContext<D>& context, const WorldState<D>& state,
                      StepScratch<D>& scratch) {
  const PairCache<D>& cache = scratch.pair_cache;
  scratch.fast_of_shape.assign(state.shapes.size(), 0);
  scratch.ways.resize(state.shapes.size());
  scratch.searching.clear();
  for (std::uint32_t place = 0; place < scratch.fast_bodies.size(); ++place) {
    const FastBody<D>& fast = scratch.fast_bodies[place];
    const Body<D>& body = state.bodies[fast.slot];
    const float target = stop_distance(context.tuning, body.thickness);
    for (std::uint32_t s = body.first_shape; s != kNone; s = state.shapes[s].next) {
      scratch.fast_of_shape[s] = place + 1;
      scratch.ways[s] = bounds_of_way(state.shapes[s], body, fast.sweep, target);
      if (cache.active[s] == 0 || !lies_in(scratch.ways[s], cache.fat.box(s)))
        scratch.searching.push_back(s);
    }
  }
}

template <int D>
static void search(const WorldState<D>& state, const StepScratch<D>& scratch, std::uint32_t shape,
                   std::vector<ShapePair>& found) {
  const Bounds<D>& way = scratch.ways[shape];
  const std::vector<Bounds<D>>& boxes = scratch.pair_cache.boxes;
  const auto meet = [&](std::uint32_t other) {
    if (overlaps(boxes[other], way) && may_touch(state, scratch, shape, other))
      found.push_back(shape < other ? ShapePair{shape, other} : ShapePair{other, shape});
  };
  for (const std::uint32_t half_space : scratch.unbounded) meet(half_space);
  scratch.static_tree.query(way, [&](int rank) { meet(scratch.static_tree.leaf(rank).id); });
  scratch.pair_cache.fat.query(way, meet);
}

/// The pairs of shapes of which one is of a fast body and meets the box of the other on its way.
///
/// Reads motions, bodies, shapes and the boxes and candidates of find_pairs; writes the fast bodies
/// with their ways and the meetings. Which pairs those are depends on boxes and ways alone: a fat
/// box holds its candidates wherever it holds the way, so what is cached shows only in the order,
/// and in a pair that is listed twice, which changes no least fraction.
template <int D>
void list_meetings(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                   StepScratch<D>& scratch) {
  constexpr int kCandidateGrain = 1024;
  scratch.meetings.clear();
  list_fast(context, state, workers, scratch);
  if (scratch.fast_bodies.empty()) return;
  mark_ways(context, state, scratch);
  mark_pushed(context, scratch);
  const PairCache<D>& cache = scratch.pair_cache;
  const auto meets = [&](std::uint32_t fast, std::uint32_t other) {
    return scratch.fast_of_shape[fast] != 0 && overlaps(cache.boxes[other], scratch.ways[fast]);
  };
  const auto list = [&](Range range, std::vector<ShapePair>& pairs) {
    append_if(cache.candidates, range, pairs, [&](const ShapePair& pair) {
      return meets(pair.shape_a, pair.shape_b) || meets(pair.shape_b, pair.shape_a);
    });
  };
  list_in_chunks(workers, static_cast<int>(cache.candidates.size()), kCandidateGrain,
                 scratch.pair_chunks, scratch.meetings, list);
  const auto search_all = [&](Range range, std::vector<ShapePair>& pairs) {
    for (int i = range.begin; i < range.end; ++i)
      search(state, scratch, scratch.searching[static_cast<std::size_t>(i)], pairs);
  };
  list_in_chunks(workers, static_cast<int>(scratch.searching.size()), kPairGrain,
                 scratch.pair_chunks, scratch.meetings, search_all);
}

template void list_meetings(const StepContext<2>&, const WorldState<2>&, Workers&, StepScratch<2>&);
template void list_meetings(const StepContext<3>&, const WorldState<3>&, Workers&, StepScratch<3>&);

}  // namespace cycloid::solver
