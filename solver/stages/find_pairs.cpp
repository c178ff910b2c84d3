#include <algorithm>
#include <limits>

#include "solver/stages/in_chunks.hpp"
#include "solver/stages/may_touch.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Where a shape meets so many boxes on the average, keeping candidates does not pay.
static constexpr std::uint64_t kSeenPerShapeMax = 64;

/// Bodies that all lie in one place make pairs with the square of their number. So many more pairs
/// than contacts, and boxes that were looked at in vain, no world needs.
struct PairTally {
  PairTally(std::uint64_t pairs_max, std::uint64_t candidates_max)
      : pairs(pairs_max), candidates(candidates_max) {}
  bool is_over() const { return pairs.is_over() || candidates.is_over(); }

  Tally pairs;
  Tally candidates;
};

template <int D>
static void list_jointed_bodies(const WorldState<D>& state, PairCache<D>& cache) {
  cache.jointed_bodies.clear();
  for (const Joint<D>& joint : state.joints)
    if (joint.kind != JointKind::kFree && joint.collide_connected == 0)
      cache.jointed_bodies.push_back(body_pair_key(joint.body_a, joint.body_b));
  // Total order: equal integers are one and the same.
  std::sort(cache.jointed_bodies.begin(), cache.jointed_bodies.end());
  cache.first_jointed.clear();
  for (std::size_t i = 0; i < cache.jointed_bodies.size(); ++i)
    cache.first_jointed.resize((cache.jointed_bodies[i] >> 32) + 1, static_cast<std::uint32_t>(i));
  cache.first_jointed.push_back(static_cast<std::uint32_t>(cache.jointed_bodies.size()));
}

/// A floor or a wall along an axis of the world is open on all sides but one; any other half-space,
/// and one that can move, is everywhere. Wider by far more than what rounding makes of a height, so
/// that it leaves out nothing that would get contact points.
template <int D>
static Bounds<D> bounds_of_half_space(const Body<D>& body, const Shape<D>& shape) {
  constexpr float kEverywhere = std::numeric_limits<float>::infinity();
  Bounds<D> box;
  for (int i = 0; i < D; ++i) {
    box.lower[i] = -kEverywhere;
    box.upper[i] = kEverywhere;
  }
  if (body.kind != BodyKind::kStatic) return box;
  const Vec<D> normal = rotate(body.rotation, shape.normal);
  for (int i = 0; i < D; ++i) {
    if (abs(normal[i]) != 1.0f || dot(normal, normal) != 1.0f) continue;
    const float height = body.position[i] + normal[i] * shape.offset;
    const float slack = 1.0e-3f + 1.0e-5f * (abs(body.position[i]) + abs(shape.offset));
    if (normal[i] > 0.0f)
      box.upper[i] = height + slack;
    else
      box.lower[i] = height - slack;
  }
  return box;
}

/// Their boxes are not widened, because those of all that may meet them are; so they stay the same
/// as long as no static body comes, goes or is moved.
template <int D>
static void list_statics(const WorldState<D>& state, Workers& workers, StepScratch<D>& scratch) {
  scratch.leaves.clear();
  scratch.kept->unbounded.clear();
  for (std::uint32_t s = 0; s < state.shapes.size(); ++s) {
    const Shape<D>& shape = state.shapes[s];
    if (shape.kind == ShapeKind::kFree) continue;
    const Body<D>& body = state.bodies[shape.body];
    Bounds<D>& box = scratch.kept->pair_cache.boxes[s];
    if (shape.kind == ShapeKind::kHalfSpace) {
      scratch.kept->unbounded.push_back(s);
      box = bounds_of_half_space(body, shape);
    } else if (body.kind == BodyKind::kStatic) {
      box = bounds_of(shape, Pose<D>{body.position, body.rotation}, 0.0f);
      scratch.leaves.push_back({box, s});
    }
  }
  scratch.kept->static_tree.build(scratch.leaves, workers, scratch.tree_room);
}

template <int D>
static void start_anew(const WorldState<D>& state, Workers& workers, StepScratch<D>& scratch) {
  PairCache<D>& cache = scratch.kept->pair_cache;
  const std::size_t count = state.shapes.size();
  cache.boxes.resize(count);
  cache.active.assign(count, 0);
  cache.is_still.assign(count, 0);
  cache.looks.assign(count, 0);
  cache.seen.assign(count, 0);
  cache.seen_sum = 0;
  cache.candidates.clear();
  cache.dormant.clear();
  cache.forgotten.clear();
  cache.fat.clear();
  // Who was active is not known, so those whose contacts are listed as active may be asleep now.
  scratch.kept->active_contacts.is_known = false;
  scratch.kept->active_bodies.forget_all();
  clear(scratch.kept->held_pairs);
  list_jointed_bodies(state, cache);
  if (!cache.statics_are_known) list_statics(state, workers, scratch);
  cache.statics_are_known = true;
  cache.is_known = true;
}

/// Of shapes that were changed by a call, or are gone, nothing is known any more.
template <int D>
static void forget_changed(const WorldState<D>& state, StepScratch<D>& scratch) {
  PairCache<D>& cache = scratch.kept->pair_cache;
  const std::size_t count = state.shapes.size();
  cache.boxes.resize(count);
  cache.active.resize(count, 0);
  cache.is_still.resize(count, 0);
  cache.looks.resize(count, 0);
  cache.seen.resize(count, 0);
  for (const std::uint32_t shape : cache.forgotten) {
    if (cache.looks[shape] != 0) continue;
    cache.fat.remove(shape);
    cache.active[shape] = 0;
    cache.is_still[shape] = 0;
    cache.looks[shape] = 1;
    scratch.looking.push_back(shape);
  }
  cache.forgotten.clear();
  clear(scratch.kept->held_pairs);
  list_jointed_bodies(state, cache);
}

static ShapePair ordered(std::uint32_t a, std::uint32_t b) {
  return a < b ? ShapePair{a, b} : ShapePair{b, a};
}

/// Whether one looks that takes no part: what it finds, and what it found, may be dormant.
template <int D>
static bool sleepers_look(const StepScratch<D>& scratch) {
  for (const std::uint32_t s : scratch.looking)
    if (scratch.kept->pair_cache.active[s] == 0) return true;
  return false;
}

/// The candidates of one shape: half-spaces, static shapes, and those that can move. Of two that
/// both look, the lower slot reports the pair.
template <int D>
static std::uint32_t look(const WorldState<D>& state, const StepScratch<D>& scratch,
                          std::uint32_t shape, std::vector<ShapePair>& found) {
  const PairCache<D>& cache = scratch.kept->pair_cache;
  const Bounds<D>& bounds = cache.fat.box(shape);
  auto seen = static_cast<std::uint32_t>(scratch.kept->unbounded.size());
  const auto report = [&](std::uint32_t other) {
    if (may_touch(state, scratch, shape, other)) found.push_back(ordered(shape, other));
  };
  for (const std::uint32_t half_space : scratch.kept->unbounded)
    if (overlaps(bounds, cache.boxes[half_space])) report(half_space);
  scratch.kept->static_tree.query(bounds, [&](int rank) {
    ++seen;
    report(scratch.kept->static_tree.leaf(rank).id);
  });
  cache.fat.query(bounds, [&](std::uint32_t other) {
    ++seen;
    if (other != shape && (cache.looks[other] == 0 || shape < other)) report(other);
  });
  return seen;
}

/// Parts what a chunk has found by the ranges that are merged of it.
template <int D>
static void part_found(const std::vector<ShapePair>& found, std::size_t chunk,
                       StepScratch<D>& scratch) {
  for (std::size_t i = 0; i < scratch.used_ranges; ++i) {
    const CandidateRange& keys = scratch.candidate_ranges[i];
    std::vector<ShapePair>& part = scratch.fresh_parts[chunk * scratch.used_ranges + i];
    part.clear();
    append_if(found, {0, static_cast<int>(found.size())}, part,
              [&](const ShapePair& pair) { return keys.has(pair); });
  }
}

/// Lists by chunks, as `list_in_chunks` does, but leaves what each has found in parts: one thread
/// would be long about putting all of it into one list.
template <int D, class List>
static void list_parted(Workers& workers, int count, StepScratch<D>& scratch, List&& list) {
  scratch.fresh_chunks = static_cast<std::size_t>((count + kPairGrain - 1) / kPairGrain);
  const std::size_t parts = scratch.fresh_chunks * scratch.used_ranges;
  if (scratch.fresh_parts.size() < parts) scratch.fresh_parts.resize(parts);
  fill_chunks(workers, count, kPairGrain, scratch.pair_chunks,
              [&](Range range, std::vector<ShapePair>& found) {
                list(range, found);
                part_found(found, static_cast<std::size_t>(range.begin / kPairGrain), scratch);
              });
}

/// The candidates of all that look. False where there are more than `tally` takes.
template <int D>
static bool look_up(const WorldState<D>& state, Workers& workers, PairTally& tally,
                    StepScratch<D>& scratch) {
  PairCache<D>& cache = scratch.kept->pair_cache;
  const int count = static_cast<int>(scratch.looking.size());
  for (const std::uint32_t shape : scratch.looking) cache.seen_sum -= cache.seen[shape];
  tally.candidates.add(cache.seen_sum);
  scratch.fresh_candidates.clear();
  const auto look_all = [&](Range range, std::vector<ShapePair>& found) {
    for (int i = range.begin; i < range.end; ++i) {
      if (tally.is_over()) return;
      const std::uint32_t shape = scratch.looking[static_cast<std::size_t>(i)];
      const std::size_t before = found.size();
      cache.seen[shape] = cache.fat.contains(shape) ? look(state, scratch, shape, found) : 0;
      tally.pairs.add(found.size() - before);
      tally.candidates.add(cache.seen[shape]);
    }
  };
  cut_candidates(workers, scratch);
  if (scratch.used_ranges > 1)
    list_parted(workers, count, scratch, look_all);
  else
    list_in_chunks(workers, count, kPairGrain, scratch.pair_chunks, scratch.fresh_candidates,
                   look_all);
  if (tally.is_over()) return false;
  for (const std::uint32_t shape : scratch.looking) cache.seen_sum += cache.seen[shape];
  return true;
}

/// In a crowd: every box as it is, and every active shape looks in every tick, up to a bound that
/// depends on the state alone.
template <int D>
static bool look_up_crowd(const WorldState<D>& state, Workers& workers, StepScratch<D>& scratch) {
  PairCache<D>& cache = scratch.kept->pair_cache;
  cache.fat.clear();
  scratch.looking.clear();
  cache.candidates.clear();
  cache.dormant.clear();
  cache.seen_sum = 0;
  for (const Body<D>& body : state.bodies) {
    if (body.kind == BodyKind::kFree || body.kind == BodyKind::kStatic) continue;
    for (std::uint32_t s = body.first_shape; s != kNone; s = state.shapes[s].next) {
      cache.fat.put(s, cache.boxes[s]);
      cache.seen[s] = 0;
      cache.looks[s] = cache.active[s];
      if (cache.active[s] != 0) scratch.looking.push_back(s);
    }
  }
  cache.fat.settle(workers, scratch.tree_room);
  const std::uint64_t pairs_max = 8 * std::uint64_t{state.header.limits.contacts} + 65536;
  PairTally tally(pairs_max, 64 * pairs_max);
  cache.is_known = false;
  return look_up(state, workers, tally, scratch);
}

/// The candidates whose boxes overlap now and of which one takes part.
template <int D>
static void list_pairs(Workers& workers, StepScratch<D>& scratch) {
  const PairCache<D>& cache = scratch.kept->pair_cache;
  const auto meets = [&](const ShapePair& pair) {
    return overlaps(cache.boxes[pair.shape_a], cache.boxes[pair.shape_b]);
  };
  const auto list = [&](Range range, std::vector<ShapePair>& pairs) {
    append_if(cache.candidates, range, pairs, meets);
  };
  list_anew_in_chunks(workers, static_cast<int>(cache.candidates.size()), kLookGrain,
                      scratch.pair_chunks, scratch.pairs, list);
}

/// Every pair of shapes whose boxes overlap and that may touch; those of bodies that can move are
/// widened by the speculative distance and a tick's flight.
///
/// Reads shapes, joints, and the bodies that were awake in the tick before or were touched since;
/// writes the tree of static shapes, the pair cache, who is active and who has mass, and pairs;
/// empties the held pairs where a shape came, went or was changed.
/// Pairs are those of the boxes of this tick in the order of shape slots, so neither threads nor
/// what the cache holds show in the result.
/// @returns false, and no pairs, where there are far more than `limits.contacts`.
template <int D>
bool find_pairs(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                StepScratch<D>& scratch) {
  PairCache<D>& cache = scratch.kept->pair_cache;
  scratch.looking.clear();
  if (!cache.is_known)
    start_anew(state, workers, scratch);
  else if (!cache.forgotten.empty())
    forget_changed(state, scratch);
  const bool flips = move_boxes(context, state, workers, scratch);
  if (flips) scratch.kept->active_contacts.is_known = false;
  const bool sorts_anew = flips || sleepers_look(scratch);
  if (sorts_anew) wake_candidates(scratch);
  if (!scratch.looking.empty()) {
    // Each pair of boxes that overlap was seen by one of the two at least. So with this bound a
    // tick that is within it is also within the bound of a crowd.
    const std::uint64_t pairs_max = 8 * std::uint64_t{state.header.limits.contacts} + 65536;
    const std::uint64_t seen_max = std::min(pairs_max, kSeenPerShapeMax * (cache.fat.size() + 16));
    PairTally tally(seen_max, seen_max);
    if (!look_up(state, workers, tally, scratch) && !look_up_crowd(state, workers, scratch)) {
      scratch.pairs.clear();
      return false;
    }
    merge_candidates(static_cast<std::uint32_t>(state.shapes.size()), workers, scratch);
  }
  if (sorts_anew) lay_candidates_to_rest(cache);
  list_pairs(workers, scratch);
  return true;
}

template bool find_pairs(const StepContext<2>&, const WorldState<2>&, Workers&, StepScratch<2>&);
template bool find_pairs(const StepContext<3>&, const WorldState<3>&, Workers&, StepScratch<3>&);

}  // namespace cycloid::solver
