#include "solver/bodies/body_kernels.hpp"
#include "solver/fetch_ahead.hpp"
#include "solver/lane_widths.hpp"
#include "solver/stages/in_chunks.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Shapes whose boxes are about to be found.
struct MovingShapes {
  static constexpr int kMax = 64;
  std::uint32_t shapes[kMax];
  int count = 0;
};

template <int D>
static void find_box(const StepContext<D>& context, const WorldState<D>& state, std::uint32_t shape,
                     PairCache<D>& cache) {
  const Body<D>& body = state.bodies[state.shapes[shape].body];
  const Pose<D> pose{body.position, body.rotation};
  cache.boxes[shape] =
      along(bounds_of(state.shapes[shape], pose, context.tuning.speculative_distance),
            context.tick_s * body.velocity);
}

static void find_boxes(const StepContext<3>& context, const WorldState<3>& state,
                       const MovingShapes& moving, PairCache<3>& cache) {
  for (int i = 0; i < moving.count; ++i) find_box(context, state, moving.shapes[i], cache);
}

static void find_boxes(const StepContext<2>& context, const WorldState<2>& state,
                       const MovingShapes& moving, PairCache<2>& cache) {
  FlyingShape flying[MovingShapes::kMax];
  MovingShapes few;
  for (int i = 0; i < moving.count; ++i) {
    const std::uint32_t s = moving.shapes[i];
    const Shape<2>& shape = state.shapes[s];
    if (shape.vertex_count == 0 || shape.vertex_count > 4) {
      find_box(context, state, s, cache);
      continue;
    }
    const Body<2>& body = state.bodies[shape.body];
    flying[few.count] = {{body.position, body.rotation},
                         context.tick_s * body.velocity,
                         shape.radius + context.tuning.speculative_distance,
                         static_cast<float>(shape.vertex_count - 1)};
    few.shapes[few.count++] = s;
  }
  const Shape<2>* shapes = state.shapes.data();
  Bounds<2>* boxes = cache.boxes.data();
  at_width(widest_lanes(context.lanes), [&]<int W>() {
    in_lanes<W>(0, few.count, [&]<int V>(int begin, int end) {
      BodyKernels<V>::find_boxes(flying + begin, few.shapes + begin, end - begin, shapes, boxes);
    });
  });
}

/// The fat box of a shape that left the one it had.
template <int D>
static Bounds<D> next_fat_box(const StepContext<D>& context, const WorldState<D>& state,
                              const PairCache<D>& cache, std::uint32_t shape) {
  const Bounds<D>& box = cache.boxes[shape];
  const Vec<D> flight = context.tick_s * state.bodies[state.shapes[shape].body].velocity;
  const float ticks =
      cache.fat.contains(shape) ? fat_ticks(cache.seen[shape]) : first_fat_ticks(box, flight);
  return fattened(box, flight, ticks);
}

/// Moves the boxes of these shapes, and lists the next fat ones of those that left theirs. None is
/// left in `moving`.
template <int D>
static void move_boxes_of(const StepContext<D>& context, const WorldState<D>& state,
                          MovingShapes& moving, PairCache<D>& cache,
                          std::vector<typename BoundsTree<D>::Leaf>& leaving) {
  find_boxes(context, state, moving, cache);
  for (int i = 0; i < moving.count; ++i) {
    const std::uint32_t s = moving.shapes[i];
    if (!cache.fat.contains(s) || !lies_in(cache.boxes[s], cache.fat.box(s)))
      leaving.push_back({next_fat_box(context, state, cache, s), s});
  }
  moving.count = 0;
}

/// All bodies are to be asked whether they take part, where that is not known of the others.
template <int D>
static void list_to_ask(const WorldState<D>& state, ActiveBodies& bodies) {
  const std::size_t count = state.bodies.size();
  if (bodies.is_known) {
    bodies.active.resize(count, 0);
    bodies.has_mass.resize(count, 0);
    return bodies.sort();
  }
  bodies.active.assign(count, 0);
  bodies.has_mass.assign(count, 0);
  bodies.asleep = 0;
  bodies.to_ask.resize(count);
  for (std::uint32_t i = 0; i < count; ++i) bodies.to_ask[i] = i;
  bodies.slots.clear();
  bodies.is_known = bodies.is_sorted = true;
}

/// What `ask_bodies` counts, over all threads.
struct AskedTally {
  Tally asleep;
  Tally asleep_before;
  Tally changes;  ///< Bodies that took part and do not now, or the other way round.
  Tally flips;    ///< Ranges with a shape that does.
};

/// Bodies whose shapes memory was asked for, to be looked at when some have come together.
struct FetchedBodies {
  static constexpr int kMax = 16;
  std::uint32_t first_shape[kMax];
  std::uint8_t active[kMax];
  int count = 0;
};

/// Who of a range takes part, and what follows for the boxes of its shapes.
template <int D>
struct Asking {
  const StepContext<D>& context;
  const WorldState<D>& state;
  PairCache<D>& cache;
  std::vector<typename BoundsTree<D>::Leaf>& leaving;
  FetchedBodies fetched;
  MovingShapes moving;
  bool flips = false;  ///< A shape takes part that did not, or the other way round.
};

/// Moves the boxes of all shapes of the fetched bodies, in the order of the bodies. None is left.
template <int D>
static void look_at_fetched(Asking<D>& asking) {
  PairCache<D>& cache = asking.cache;
  MovingShapes& moving = asking.moving;
  for (int i = 0; i < asking.fetched.count; ++i) {
    const std::uint8_t active = asking.fetched.active[i];
    for (std::uint32_t s = asking.fetched.first_shape[i]; s != kNone;
         s = asking.state.shapes[s].next) {
      asking.flips = asking.flips || cache.active[s] != active;
      cache.active[s] = active;
      cache.is_still[s] = active ^ 1;
      moving.shapes[moving.count++] = s;
      if (moving.count == MovingShapes::kMax)
        move_boxes_of(asking.context, asking.state, moving, cache, asking.leaving);
    }
  }
  asking.fetched.count = 0;
}

/// Asks a range of those that are to be asked, and moves the boxes of who takes part.
template <int D>
static void ask_bodies(const StepContext<D>& context, const WorldState<D>& state, Range range,
                       StepScratch<D>& scratch, AskedTally& tally,
                       std::vector<typename BoundsTree<D>::Leaf>& leaving) {
  ActiveBodies& bodies = scratch.kept->active_bodies;
  std::uint32_t asleep = 0;
  std::uint32_t asleep_before = 0;
  std::uint32_t changes = 0;
  Asking<D> asking{context, state, scratch.kept->pair_cache, leaving, {}, {}, false};
  FetchedBodies& fetched = asking.fetched;
  for (int i = range.begin; i < range.end; ++i) {
    const std::uint32_t slot = bodies.to_ask[static_cast<std::size_t>(i)];
    const Body<D>& body = state.bodies[slot];
    const bool moves = body.kind != BodyKind::kFree && body.kind != BodyKind::kStatic;
    const std::uint8_t active = moves && is_active(body) ? 1 : 0;
    const std::uint8_t has_mass = moves && body.inverse_mass > 0.0f ? 1 : 0;
    // Who takes part as before changes no number.
    if ((active & bodies.active[slot]) == 0 || has_mass != bodies.has_mass[slot]) {
      asleep_before += bodies.has_mass[slot] & ~bodies.active[slot];
      asleep += has_mass & ~active;
      changes += bodies.active[slot] ^ active;
      bodies.active[slot] = active;
      bodies.has_mass[slot] = has_mass;
    }
    if (!moves || body.first_shape == kNone) continue;
    if (active == 0 && asking.cache.is_still[body.first_shape] != 0) continue;
    fetch_ahead(state.shapes[body.first_shape]);
    fetched.first_shape[fetched.count] = body.first_shape;
    fetched.active[fetched.count++] = active;
    if (fetched.count == FetchedBodies::kMax) look_at_fetched(asking);
  }
  look_at_fetched(asking);
  move_boxes_of(context, state, asking.moving, asking.cache, leaving);
  tally.asleep.add(asleep);
  tally.asleep_before.add(asleep_before);
  tally.changes.add(changes);
  if (asking.flips) tally.flips.add(1);
}

/// Those of whom it was asked are all that may take part.
static void list_active(ActiveBodies& bodies) {
  bodies.slots.clear();
  for (const std::uint32_t slot : bodies.to_ask)
    if (bodies.active[slot] != 0) bodies.slots.push_back(slot);
}

/// The box of each shape that can move: widened by the speculative distance and along its body's
/// flight of a tick, so that what it will hit is among the pairs. Those that left their fat box
/// will look anew. @returns whether a shape takes part that did not in the tick before, or the
/// other way round.
///
/// Reads the bodies that were awake in the tick before or were touched since, and their shapes;
/// writes who is active and who has mass, boxes, fat boxes and who looks. Each body its own; who
/// leaves a fat box is listed in slot order.
template <int D>
bool move_boxes(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                StepScratch<D>& scratch) {
  PairCache<D>& cache = scratch.kept->pair_cache;
  ActiveBodies& bodies = scratch.kept->active_bodies;
  scratch.leaving.clear();
  AskedTally tally;
  list_to_ask(state, bodies);
  list_in_chunks(workers, static_cast<int>(bodies.to_ask.size()), kBodyGrain,
                 scratch.leaving_chunks, scratch.leaving,
                 [&](Range range, std::vector<typename BoundsTree<D>::Leaf>& leaving) {
                   ask_bodies(context, state, range, scratch, tally, leaving);
                 });
  bodies.asleep += static_cast<std::uint32_t>(tally.asleep.sum());
  bodies.asleep -= static_cast<std::uint32_t>(tally.asleep_before.sum());
  scratch.bodies_asleep = bodies.asleep;
  if (tally.changes.sum() > 0) list_active(bodies);
  for (const auto& [box, s] : scratch.leaving) {
    cache.fat.put(s, box);
    if (cache.looks[s] != 0) continue;
    cache.looks[s] = 1;
    scratch.looking.push_back(s);
  }
  cache.fat.settle(workers, scratch.tree_room);
  return tally.flips.sum() > 0;
}

template bool move_boxes(const StepContext<2>&, const WorldState<2>&, Workers&, StepScratch<2>&);
template bool move_boxes(const StepContext<3>&, const WorldState<3>&, Workers&, StepScratch<3>&);

}  // namespace cycloid::solver
