#include <algorithm>

#include "solver/stages/may_touch.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

template <int D>
static void list_jointed_bodies(const WorldState<D>& state, StepScratch<D>& scratch) {
  scratch.jointed_bodies.clear();
  for (const Joint<D>& joint : state.joints)
    if (joint.kind != JointKind::kFree && joint.collide_connected == 0)
      scratch.jointed_bodies.push_back(body_pair_key(joint.body_a, joint.body_b));
  // Total order: equal integers are one and the same.
  std::sort(scratch.jointed_bodies.begin(), scratch.jointed_bodies.end());
}

/// A body reaches as far as it flies in a tick, so that what it will hit is among the pairs.
template <int D>
static float flight_of(const StepContext<D>& context, const Body<D>& body) {
  return context.tuning.speculative_distance + context.tick_s * length(body.velocity);
}

/// Their boxes are not widened, because those of all that may meet them are; so they stay the same
/// as long as no static body comes, goes or is moved.
template <int D>
static void list_statics(const WorldState<D>& state, StepScratch<D>& scratch) {
  if (scratch.statics_are_listed) return;
  scratch.leaves.clear();
  scratch.unbounded.clear();
  for (std::uint32_t s = 0; s < state.shapes.size(); ++s) {
    const Shape<D>& shape = state.shapes[s];
    if (shape.kind == ShapeKind::kHalfSpace) scratch.unbounded.push_back(s);
    if (shape.kind == ShapeKind::kFree || shape.kind == ShapeKind::kHalfSpace) continue;
    const Body<D>& body = state.bodies[shape.body];
    if (body.kind != BodyKind::kStatic) continue;
    scratch.leaves.push_back({bounds_of(shape, Pose<D>{body.position, body.rotation}, 0.0f), s});
  }
  scratch.static_tree.build(scratch.leaves);
  scratch.statics_are_listed = true;
}

template <int D>
static void list_leaves(const StepContext<D>& context, const WorldState<D>& state,
                        StepScratch<D>& scratch) {
  scratch.leaves.clear();
  for (const Body<D>& body : state.bodies) {
    if (body.kind == BodyKind::kFree || body.kind == BodyKind::kStatic) continue;
    const Pose<D> pose{body.position, body.rotation};
    const float flight = flight_of(context, body);
    for (std::uint32_t s = body.first_shape; s != kNone; s = state.shapes[s].next)
      scratch.leaves.push_back({bounds_of(state.shapes[s], pose, flight), s});
  }
}

static ShapePair ordered(std::uint32_t a, std::uint32_t b) {
  return a < b ? ShapePair{a, b} : ShapePair{b, a};
}

/// Bodies that all lie in one place make pairs with the square of their number. So many more pairs
/// than contacts, and boxes that were looked at in vain, no world needs.
struct PairTally {
  explicit PairTally(std::uint64_t contacts_max)
      : pairs(8 * contacts_max + 65536), candidates(64 * (8 * contacts_max + 65536)) {}

  Tally pairs;
  Tally candidates;
};

/// Pairs of the leaves in `range`: each with the half-spaces, with the static shapes and with the
/// leaves it overlaps. Of two that both move, the lower rank reports the pair; a leaf that is
/// asleep never looks.
template <int D>
static void find_in_range(const WorldState<D>& state, const StepScratch<D>& scratch, Range range,
                          PairTally& tally, std::vector<ShapePair>& found) {
  found.clear();
  std::size_t counted = 0;
  std::uint64_t seen = 0;
  const auto moving = [&](std::uint32_t shape) {
    return is_active(state.bodies[state.shapes[shape].body]);
  };
  for (int rank = range.begin; rank < range.end; ++rank) {
    const auto& leaf = scratch.tree.leaf(rank);
    if (!moving(leaf.id)) continue;
    if (tally.pairs.is_over() || tally.candidates.is_over()) return;
    seen += scratch.unbounded.size();
    for (const std::uint32_t half_space : scratch.unbounded)
      if (may_touch(state, scratch, leaf.id, half_space))
        found.push_back(ordered(leaf.id, half_space));
    scratch.static_tree.query(leaf.bounds, [&](int other_rank) {
      ++seen;
      const std::uint32_t other = scratch.static_tree.leaf(other_rank).id;
      if (may_touch(state, scratch, leaf.id, other)) found.push_back(ordered(leaf.id, other));
    });
    scratch.tree.query(leaf.bounds, [&](int other_rank) {
      ++seen;
      const std::uint32_t other = scratch.tree.leaf(other_rank).id;
      if (other == leaf.id || (other_rank < rank && moving(other))) return;
      if (may_touch(state, scratch, leaf.id, other)) found.push_back(ordered(leaf.id, other));
    });
    tally.pairs.add(found.size() - counted);
    tally.candidates.add(seen);
    counted = found.size();
    seen = 0;
  }
}

/// Every pair of shapes whose boxes overlap and that may touch; those of bodies that can move are
/// widened by the speculative distance and a tick's flight.
///
/// Reads shapes, bodies and joints; writes leaves, both trees and pairs. Chunks of leaves write
/// lists of their own, and the lists are sorted by shape slots at the end, so neither threads nor
/// the shape of the tree show in the result.
/// @returns false, and no pairs, where there are far more than `limits.contacts`.
template <int D>
bool find_pairs(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                StepScratch<D>& scratch) {
  list_jointed_bodies(state, scratch);
  list_statics(state, scratch);
  list_leaves(context, state, scratch);
  scratch.tree.build(scratch.leaves);
  const int chunks = (scratch.tree.size() + kPairGrain - 1) / kPairGrain;
  if (scratch.found.size() < static_cast<std::size_t>(chunks))
    scratch.found.resize(static_cast<std::size_t>(chunks));
  PairTally tally(state.header.limits.contacts);
  workers.parallel_for(scratch.tree.size(), kPairGrain, [&](Range range) {
    find_in_range(state, scratch, range, tally,
                  scratch.found[static_cast<std::size_t>(range.begin / kPairGrain)]);
  });
  scratch.pairs.clear();
  if (tally.pairs.is_over() || tally.candidates.is_over()) return false;
  for (int i = 0; i < chunks; ++i) {
    const auto& found = scratch.found[static_cast<std::size_t>(i)];
    scratch.pairs.insert(scratch.pairs.end(), found.begin(), found.end());
  }
  // Total order: a pair of slots is found once.
  std::sort(scratch.pairs.begin(), scratch.pairs.end(),
            [](const ShapePair& a, const ShapePair& b) { return a.key() < b.key(); });
  return true;
}

template bool find_pairs(const StepContext<2>&, const WorldState<2>&, Workers&, StepScratch<2>&);
template bool find_pairs(const StepContext<3>&, const WorldState<3>&, Workers&, StepScratch<3>&);

}  // namespace cycloid::solver
