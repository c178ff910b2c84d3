#include <algorithm>

#include "solver/collision/collide.hpp"
#include "solver/lane_widths.hpp"
#include "solver/stages/active_contacts.hpp"
#include "solver/stages/set_live.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// How far a body flies in a tick that nothing stops, m.
template <int D>
static float unstopped_flight(const StepContext<D>& context, const Body<D>& body) {
  return body.kind == BodyKind::kKinematic ? context.tick_s * length(body.velocity) : 0.0f;
}

/// How far apart two shapes may be that get contact points, m: what they fly towards each other in
/// a tick. Not farther than the body's own reach and what a kinematic one flies, where continuous
/// collision stops what flies farther: a point between two surfaces that are forty metres apart
/// would have an arm of twenty.
template <int D>
static float margin_of(const StepContext<D>& context, const Body<D>& a, const Body<D>& b) {
  float flight = context.tick_s * length(b.velocity - a.velocity);
  if (context.tuning.continuous != 0) {
    const float reach_a = a.kind == BodyKind::kStatic ? 0.0f : a.extent;
    const float reach_b = b.kind == BodyKind::kStatic ? 0.0f : b.extent;
    const float unstopped = unstopped_flight(context, a) + unstopped_flight(context, b);
    flight = min(flight, max(reach_a, reach_b) + unstopped);
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
static void take_impulses(const Contact<D>& old, std::uint32_t number, ContactPoint<D>& point) {
  // Nearly always the same features meet in the same order.
  std::uint32_t i = number;
  if (i >= old.point_count || old.points[i].feature != point.feature)
    for (i = 0; i < old.point_count; ++i)
      if (old.points[i].feature == point.feature) break;
  if (i == old.point_count) return;
  point.normal_impulse = old.points[i].normal_impulse;
  point.tangent_impulse = old.points[i].tangent_impulse;
}

/// The points of a manifold as those of a contact; whether they touch as the tick begins.
template <int D>
static void take_points(const Manifold<D>& manifold, float slop, const Contact<D>* old,
                        Contact<D>& contact) {
  contact.point_count = manifold.point_count;
  for (std::uint32_t i = 0; i < manifold.point_count; ++i) {
    contact.points[i].feature = manifold.points[i].feature;
    if (manifold.points[i].separation <= slop) contact.touching = 1;
    if (old != nullptr) take_impulses(*old, i, contact.points[i]);
  }
}

/// The old contacts from `old` on whose key is below `key`: their pairs have no points, or were not
/// found. Inlined, as set_live is.
template <int D>
[[gnu::always_inline]] static inline void pass_old(const OldContacts<D>& contacts,
                                                   std::uint64_t key, std::uint32_t& old,
                                                   ContactList<D>& list) {
  for (; old < contacts.size() && contacts.key(old) < key; ++old)
    if (contacts[old].touching != 0) list.ended.push_back(contacts.place(old));
}

template <int D>
static std::uint64_t key_of(const PlacedPair<D>& pair) {
  return ShapePair{pair.shape_a, pair.shape_b}.key();
}

template <int D>
static std::uint32_t count_of(const ContactList<D>& list) {
  return list.room.used + static_cast<std::uint32_t>(list.contacts.size());
}

/// Lists the contact of a pair with points. `old` is where to go on among the old contacts.
template <int D>
static void add_contact(const WorldState<D>& state, const OldContacts<D>& contacts,
                        const PlacedPair<D>& pair, const Manifold<D>& manifold,
                        MaterialPair& materials, std::uint32_t& old, ContactList<D>& list) {
  if (manifold.point_count == 0) return;
  const std::uint32_t number = count_of(list);
  ContactRoom<D>& room = list.room;
  const bool has_room = room.used < room.size;
  LiveContact<D>& live = has_room ? room.live[room.used] : list.live.emplace_back();
  Contact<D>& contact = has_room ? room.contacts[room.used++] : list.contacts.emplace_back();
  if (has_room) contact = {};
  set_live(state, pair, manifold, room.first + number, materials, live);
  const bool persists = old < contacts.size() && contacts.key(old) == key_of(pair);
  const Contact<D>* before = persists ? &contacts[old] : nullptr;
  contact.shape_a = pair.shape_a;
  contact.shape_b = pair.shape_b;
  take_points(manifold, state.header.tuning.slop, before, contact);
  const bool touched = persists && before->touching != 0;
  if (contact.touching == 0)
    list.apart.push_back({number, touched ? contacts.place(old) : kNone});
  else if (!touched)
    list.began.push_back(number);
  if (persists) ++old;
}

/// All but contacts and live ones.
template <int D>
static void clear_lists(ContactList<D>& list) {
  list.began.clear();
  list.ended.clear();
  list.apart.clear();
  clear(list.held_pairs);
  list.room = {};
}
template <int D>
static void clear(ContactList<D>& list) {
  list.contacts.clear();
  list.live.clear();
  clear_lists(list);
}

/// Lists the contacts of a range of the pairs, and the old ones from the first of them up to the
/// next range: batch by batch, while manifolds are at hand.
template <int D>
static void collide_range(const Collider<D>& collider, const StepContext<D>& context,
                          const WorldState<D>& state, const StepScratch<D>& scratch, Range range,
                          ContactList<D>& list) {
  const std::vector<ShapePair>& pairs = scratch.pairs;
  const auto key_at = [&](int i) { return pairs[static_cast<std::size_t>(i)].key(); };
  const OldContacts<D> contacts(state, scratch.kept->active_contacts);
  std::uint32_t old = range.begin > 0 ? contacts.lower_bound(key_at(range.begin)) : 0;
  list.found.resize(kPairGrain);
  MaterialPair materials(state.materials);
  PairMemory<D> memory(state, scratch.kept->held_pairs,
                       range.begin < range.end ? key_at(range.begin) : 0, list.held_pairs);
  for (int begin = range.begin; begin < range.end; begin += kPairGrain) {
    const int size = std::min(kPairGrain, range.end - begin);
    PlacedPair<D> batch[kPairGrain];
    for (int i = 0; i < size; ++i)
      batch[i] = placed(context, state, pairs[static_cast<std::size_t>(begin + i)]);
    contacts.fetch(old, static_cast<std::uint32_t>(size));
    collider(batch, size, list.found.data(), memory);
    for (int i = 0; i < size; ++i) {
      pass_old(contacts, key_of(batch[i]), old, list);
      add_contact(state, contacts, batch[i], list.found[static_cast<std::size_t>(i)], materials,
                  old, list);
    }
  }
  const bool is_last = range.end == static_cast<int>(pairs.size());
  pass_old(contacts, is_last ? ~std::uint64_t{0} : key_at(range.end), old, list);
}

/// Pairs that a thread takes at once.
static constexpr int kChunk = 8 * kPairGrain;

/// The room of the chunk of these pairs. @pre contacts and live ones are as many as the old ones.
template <int D>
static ContactRoom<D> room_of(const OldContacts<D>& old, Range range, StepScratch<D>& scratch) {
  const auto place_of = [&](int pair) {
    if (pair == 0) return 0u;
    if (pair == static_cast<int>(scratch.pairs.size())) return old.size();
    return old.lower_bound(scratch.pairs[static_cast<std::size_t>(pair)].key());
  };
  const std::uint32_t first = place_of(range.begin);
  return {scratch.contacts.data() + first, scratch.live.data() + first, first,
          place_of(range.end) - first, 0};
}

/// Puts the contacts of chunks one behind the other, where they did not just fill their rooms.
template <int D>
static void move_together(std::size_t chunks, Workers& workers, StepScratch<D>& scratch) {
  const auto listed = [&](std::size_t end) {
    std::size_t count = 0;
    for (std::size_t c = 0; c < end; ++c) count += count_of(scratch.contact_chunks[c]);
    return count;
  };
  std::vector<Contact<D>>& contacts = scratch.merged_contacts;
  std::vector<LiveContact<D>>& live = scratch.live_before;
  contacts.resize(listed(chunks));
  live.resize(contacts.size());
  workers.parallel_for(static_cast<int>(chunks), 1, [&](Range range) {
    const ContactList<D>& chunk = scratch.contact_chunks[static_cast<std::size_t>(range.begin)];
    const auto begin = static_cast<std::ptrdiff_t>(listed(static_cast<std::size_t>(range.begin)));
    const ContactRoom<D>& room = chunk.room;
    const auto contact =
        std::copy(room.contacts, room.contacts + room.used, contacts.begin() + begin);
    std::copy(chunk.contacts.begin(), chunk.contacts.end(), contact);
    const auto place = std::copy(room.live, room.live + room.used, live.begin() + begin);
    const auto end = std::copy(chunk.live.begin(), chunk.live.end(), place);
    auto number = static_cast<std::uint32_t>(begin);
    for (auto one = live.begin() + begin; one != end; ++one) one->contact = number++;
  });
  scratch.contacts.swap(contacts);
  scratch.live.swap(live);
}

/// Appends the lists of all chunks to the step's. Which contacts those are, by number, depends on
/// how many the chunks before hold.
template <int D>
static void join_lists(std::size_t chunks, Workers& workers, StepScratch<D>& scratch) {
  std::uint32_t contacts = 0;
  bool all_fit = true;
  for (std::size_t c = 0; c < chunks; ++c) {
    const ContactList<D>& chunk = scratch.contact_chunks[c];
    for (const std::uint32_t began : chunk.began) scratch.began.push_back(contacts + began);
    for (const ApartContact& one : chunk.apart)
      scratch.apart.push_back({contacts + one.contact, one.touched});
    scratch.ended.insert(scratch.ended.end(), chunk.ended.begin(), chunk.ended.end());
    append(chunk.held_pairs, scratch.held_pairs);
    contacts += count_of(chunk);
    all_fit = all_fit && count_of(chunk) == chunk.room.size;
  }
  if (!all_fit) move_together(chunks, workers, scratch);
}

/// As collide_range of all pairs, by several threads. As many contacts of a chunk as there were in
/// the tick before are written to where they were among all: at rest that is where they belong.
template <int D>
static void collide_chunks(const Collider<D>& collider, const StepContext<D>& context,
                           const WorldState<D>& state, Workers& workers, StepScratch<D>& scratch) {
  const int count = static_cast<int>(scratch.pairs.size());
  const auto chunks = static_cast<std::size_t>((count + kChunk - 1) / kChunk);
  const OldContacts<D> old(state, scratch.kept->active_contacts);
  scratch.contacts.resize(old.size());
  scratch.live.resize(old.size());
  if (scratch.contact_chunks.size() < chunks) scratch.contact_chunks.resize(chunks);
  workers.parallel_for(count, kChunk, [&](Range range) {
    ContactList<D>& list = scratch.contact_chunks[static_cast<std::size_t>(range.begin / kChunk)];
    clear(list);
    list.room = room_of(old, range, scratch);
    collide_range(collider, context, state, scratch, range, list);
  });
  join_lists(chunks, workers, scratch);
}

/// The contact points of every pair, with last tick's impulses where the same features met, and
/// which contacts began and ended, but for those that this tick's impulses decide about.
///
/// Reads pairs, shapes, materials, poses, velocities, who is active, the old contacts and the held
/// pairs; writes which contacts rest, all others, which of them are live with their manifolds,
/// began, ended and apart, and the held pairs of the next tick. Contacts are listed in the order of
/// the pairs, which is that of the shapes' slots, beside the old ones in the same order. One thread
/// lists them at once; of several each takes chunks of the pairs, whose lists are joined.
template <int D>
void collide_pairs(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                   StepScratch<D>& scratch) {
  const Collider<D> collider{state.shapes.data(), state.polyhedra, widest_lanes(context.lanes)};
  const int count = static_cast<int>(scratch.pairs.size());
  list_active_contacts(state, workers, scratch);
  scratch.contacts_are_all = scratch.kept->active_contacts.are_all;
  if (workers.count() > 1 && count > kChunk) {
    clear_lists<D>(scratch);
    collide_chunks(collider, context, state, workers, scratch);
  } else {
    clear<D>(scratch);
    collide_range<D>(collider, context, state, scratch, {0, count}, scratch);
  }
  scratch.kept->held_pairs = scratch.held_pairs;
}

template void collide_pairs(const StepContext<2>&, const WorldState<2>&, Workers&, StepScratch<2>&);
template void collide_pairs(const StepContext<3>&, const WorldState<3>&, Workers&, StepScratch<3>&);

}  // namespace cycloid::solver
