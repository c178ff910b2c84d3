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
static PlacedPair<D> placed(const StepContext<D>& context, const WorldState<D>& state,
                            const ShapePair& pair) {
  const Body<D>& a = state.bodies[state.shapes[pair.shape_a].body];
  const Body<D>& b = state.bodies[state.shapes[pair.shape_b].body];
  return {{a.position, a.rotation},
          {b.position, b.rotation},
          pair.shape_a,
          pair.shape_b,
          margin_of(context, a, b)};
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

/// The points of a manifold as those of a contact; whether they touch.
template <int D>
static void take_points(const Manifold<D>& manifold, float slop, const Contact<D>* old,
                        Contact<D>& contact) {
  contact.point_count = manifold.point_count;
  for (std::uint32_t i = 0; i < manifold.point_count; ++i) {
    contact.points[i].feature = manifold.points[i].feature;
    if (manifold.points[i].separation <= slop) contact.touching = 1;
    if (old != nullptr) take_impulses(*old, contact.points[i]);
  }
}

template <int D>
static std::uint64_t key_of(const Contact<D>& contact) {
  return ShapePair{contact.shape_a, contact.shape_b}.key();
}

/// Whether neither body of an old contact takes part by itself.
template <int D>
static bool rests(const Contact<D>& old, const PairCache<D>& cache) {
  return (cache.active[old.shape_a] | cache.active[old.shape_b]) == 0;
}

/// The old contacts from `old` on whose key is below `key`: their pairs have no points, or were not
/// found. Those of bodies that both do nothing are kept as they are, without a manifold: nobody
/// looked for their pairs, and nothing has moved. There may be very many, so they are copied at
/// once.
template <int D>
static void pass_old(const WorldState<D>& state, std::uint64_t key, std::uint32_t& old,
                     StepScratch<D>& scratch) {
  const auto count = static_cast<std::uint32_t>(state.contacts.size());
  const auto is_passed = [&] { return old < count && key_of(state.contacts[old]) < key; };
  while (is_passed()) {
    const std::uint32_t begin = old;
    while (is_passed() && rests(state.contacts[old], scratch.pair_cache)) ++old;
    if (begin != old) {
      scratch.contacts.insert(scratch.contacts.end(), state.contacts.begin() + begin,
                              state.contacts.begin() + old);
      scratch.manifolds.resize(scratch.contacts.size());
    }
    if (!is_passed()) return;
    if (state.contacts[old].touching != 0) scratch.ended.push_back(old);
    ++old;
  }
}

/// Lists the contact of a pair with points. `old` is where to go on among the old contacts.
template <int D>
static void add_contact(const WorldState<D>& state, const ShapePair& pair,
                        const Manifold<D>& manifold, std::uint32_t& old, StepScratch<D>& scratch) {
  const auto count = static_cast<std::uint32_t>(state.contacts.size());
  pass_old(state, pair.key(), old, scratch);
  if (manifold.point_count == 0) return;
  scratch.live_contacts.push_back(static_cast<int>(scratch.contacts.size()));
  const bool persists = old < count && key_of(state.contacts[old]) == pair.key();
  const Contact<D>* before = persists ? &state.contacts[old] : nullptr;
  Contact<D>& contact = scratch.contacts.emplace_back();
  contact.shape_a = pair.shape_a;
  contact.shape_b = pair.shape_b;
  take_points(manifold, state.header.tuning.slop, before, contact);
  scratch.manifolds.push_back(manifold);
  const bool touched = persists && before->touching != 0;
  if (contact.touching != 0 && !touched)
    scratch.began.push_back(static_cast<std::uint32_t>(scratch.contacts.size() - 1));
  if (contact.touching == 0 && touched) scratch.ended.push_back(old);
  if (persists) ++old;
}

/// The contact points of every pair, with last tick's impulses where the same features met, and
/// which contacts began and ended.
///
/// Reads pairs, shapes, poses, velocities, who is active and the old contacts; writes
/// pair_manifolds, contacts, manifolds, which contacts are live, began and ended. Each pair writes
/// its own manifold; contacts are then listed in the order of the pairs, which is that of the
/// shapes' slots, beside the old ones in the same order. One thread does so batch by batch, while
/// they are at hand; several find all manifolds first.
template <int D>
void collide_pairs(int lanes, const StepContext<D>& context, const WorldState<D>& state,
                   Workers& workers, StepScratch<D>& scratch) {
  scratch.contacts.clear();
  scratch.manifolds.clear();
  scratch.live_contacts.clear();
  scratch.began.clear();
  scratch.ended.clear();
  const int count = static_cast<int>(scratch.pairs.size());
  const int batch = workers.count() == 1 && count > kPairGrain ? kPairGrain : count;
  scratch.pair_manifolds.resize(static_cast<std::size_t>(batch));
  const Collider<D> collider{state.shapes.data(), state.polyhedra, lanes};
  std::uint32_t old = 0;
  for (int begin = 0; begin < count; begin += batch) {
    const ShapePair* pairs = scratch.pairs.data() + begin;
    const int size = count - begin < batch ? count - begin : batch;
    workers.parallel_for(size, kPairGrain, [&](Range range) {
      PlacedPair<D> in_range[kPairGrain];
      for (int i = range.begin; i < range.end; ++i)
        in_range[i - range.begin] = placed(context, state, pairs[i]);
      collider(in_range, range.end - range.begin, scratch.pair_manifolds.data() + range.begin);
    });
    for (int i = 0; i < size; ++i)
      add_contact(state, pairs[i], scratch.pair_manifolds[static_cast<std::size_t>(i)], old,
                  scratch);
  }
  pass_old(state, ~std::uint64_t{0}, old, scratch);
}

template void collide_pairs(int, const StepContext<2>&, const WorldState<2>&, Workers&,
                            StepScratch<2>&);
template void collide_pairs(int, const StepContext<3>&, const WorldState<3>&, Workers&,
                            StepScratch<3>&);

}  // namespace cycloid::solver
