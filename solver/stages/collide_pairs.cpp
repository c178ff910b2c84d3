#include "solver/collision/collide.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// How far apart two shapes may be that get contact points, m: what they fly towards each other in
/// a tick. Not farther than the body's own reach, where continuous collision stops what flies
/// farther: a point between two surfaces that are forty metres apart would have an arm of twenty.
template <int D>
static float margin_of(const StepContext<D>& context, const Body<D>& a, const Body<D>& b) {
  float flight = context.tick_s * length(b.velocity - a.velocity);
  if (context.tuning.continuous != 0) {
    const float reach_a = a.kind == BodyKind::kStatic ? 0.0f : a.extent;
    const float reach_b = b.kind == BodyKind::kStatic ? 0.0f : b.extent;
    flight = min(flight, max(reach_a, reach_b));
  }
  return context.tuning.speculative_distance + flight;
}

template <int D>
static Manifold<D> collide_pair(const StepContext<D>& context, const WorldState<D>& state,
                                const ShapePair& pair) {
  const Shape<D>& shape_a = state.shapes[pair.shape_a];
  const Shape<D>& shape_b = state.shapes[pair.shape_b];
  const Body<D>& a = state.bodies[shape_a.body];
  const Body<D>& b = state.bodies[shape_b.body];
  return collide(shape_a, Pose<D>{a.position, a.rotation}, shape_b, Pose<D>{b.position, b.rotation},
                 margin_of(context, a, b), state.polyhedra);
}

/// The impulses of the point with the same feature, so that a contact which persists starts from
/// last tick's solution.
template <int D>
static void take_impulses(const Contact<D>& old, ContactPoint<D>& point) {
  for (std::uint32_t i = 0; i < old.point_count; ++i) {
    if (old.points[i].feature != point.feature) continue;
    point.normal_impulse = old.points[i].normal_impulse;
    point.tangent_impulse = old.points[i].tangent_impulse;
    return;
  }
}

template <int D>
static Contact<D> contact_of(const ShapePair& pair, const Manifold<D>& manifold, float slop,
                             const Contact<D>* old) {
  Contact<D> contact{};
  contact.shape_a = pair.shape_a;
  contact.shape_b = pair.shape_b;
  contact.point_count = manifold.point_count;
  for (std::uint32_t i = 0; i < manifold.point_count; ++i) {
    contact.points[i].feature = manifold.points[i].feature;
    if (manifold.points[i].separation <= slop) contact.touching = 1;
    if (old != nullptr) take_impulses(*old, contact.points[i]);
  }
  return contact;
}

/// Passes the old contacts before `key`. Those of bodies that both do nothing are kept as they are,
/// without a manifold: nobody looked for their pairs, and nothing has moved.
template <int D>
static auto keep_sleeping(const WorldState<D>& state,
                          typename std::vector<Contact<D>>::const_iterator old, std::uint64_t key,
                          StepScratch<D>& scratch) {
  for (; old != state.contacts.end(); ++old) {
    if (ShapePair{old->shape_a, old->shape_b}.key() >= key) break;
    const Body<D>& a = state.bodies[state.shapes[old->shape_a].body];
    const Body<D>& b = state.bodies[state.shapes[old->shape_b].body];
    if (is_active(a) || is_active(b)) continue;
    scratch.contacts.push_back(*old);
    scratch.manifolds.push_back({});
  }
  return old;
}

/// The contact points of every pair, with last tick's impulses where the same features met.
///
/// Reads pairs, shapes, poses, velocities and the old contacts; writes pair_manifolds, contacts and
/// manifolds. Each pair writes its own manifold; contacts are then listed in the order of the
/// pairs, which is that of the shapes' slots, beside the old ones in the same order.
template <int D>
void collide_pairs(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                   StepScratch<D>& scratch) {
  scratch.pair_manifolds.resize(scratch.pairs.size());
  workers.parallel_for(static_cast<int>(scratch.pairs.size()), kPairGrain, [&](Range range) {
    for (auto i = static_cast<std::size_t>(range.begin); i < static_cast<std::size_t>(range.end);
         ++i)
      scratch.pair_manifolds[i] = collide_pair(context, state, scratch.pairs[i]);
  });

  scratch.contacts.clear();
  scratch.manifolds.clear();
  auto old = state.contacts.begin();
  for (std::size_t i = 0; i < scratch.pairs.size(); ++i) {
    const ShapePair& pair = scratch.pairs[i];
    old = keep_sleeping(state, old, pair.key(), scratch);
    if (scratch.pair_manifolds[i].point_count == 0) continue;
    const bool persists =
        old != state.contacts.end() && old->shape_a == pair.shape_a && old->shape_b == pair.shape_b;
    scratch.contacts.push_back(contact_of(pair, scratch.pair_manifolds[i], context.tuning.slop,
                                          persists ? &*old : nullptr));
    scratch.manifolds.push_back(scratch.pair_manifolds[i]);
  }
  keep_sleeping(state, old, ~std::uint64_t{0}, scratch);
}

template void collide_pairs(const StepContext<2>&, const WorldState<2>&, Workers&, StepScratch<2>&);
template void collide_pairs(const StepContext<3>&, const WorldState<3>&, Workers&, StepScratch<3>&);

}  // namespace cycloid::solver
