#include "solver/stages/active_contacts.hpp"

#include <algorithm>

#include "solver/stages/in_chunks.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

template <int D>
std::uint32_t OldContacts<D>::lower_bound(std::uint64_t wanted) const {
  std::uint32_t begin = 0;
  for (std::uint32_t left = size(); left > 0;) {
    const std::uint32_t half = left / 2;
    if (key(begin + half) < wanted) {
      begin += half + 1;
      left -= half + 1;
    } else {
      left = half;
    }
  }
  return begin;
}

template <int D>
void list_active_contacts(const WorldState<D>& state, Workers& workers, StepScratch<D>& scratch) {
  ActiveContacts& known = scratch.kept->active_contacts;
  if (known.is_known) return;
  const std::vector<std::uint8_t>& active = scratch.kept->pair_cache.active;
  known.places.clear();
  const auto list = [&](Range range, std::vector<std::uint32_t>& places) {
    for (int i = range.begin; i < range.end; ++i) {
      const Contact<D>& contact = state.contacts[static_cast<std::size_t>(i)];
      if ((active[contact.shape_a] | active[contact.shape_b]) != 0)
        places.push_back(static_cast<std::uint32_t>(i));
    }
  };
  list_in_chunks(workers, static_cast<int>(state.contacts.size()), kLookGrain, scratch.slot_chunks,
                 known.places, list);
  known.are_all = known.places.size() == state.contacts.size();
  if (known.are_all) known.places.clear();
  known.is_known = true;
}

template <int D>
std::size_t contact_count(const WorldState<D>& state, const StepScratch<D>& scratch) {
  if (scratch.contacts_are_all) return scratch.contacts.size();
  return scratch.contacts.size() + state.contacts.size() -
         scratch.kept->active_contacts.places.size();
}

/// Appends the resting contacts from `old` on whose key is below, as many as possible at once.
/// @param next  The first active one from `old` on.
template <int D>
static void append_resting(const WorldState<D>& state, const std::vector<std::uint32_t>& places,
                           std::uint64_t key, std::uint32_t& old, std::size_t& next,
                           std::vector<Contact<D>>& merged) {
  const auto count = static_cast<std::uint32_t>(state.contacts.size());
  while (old < count) {
    if (next < places.size() && places[next] == old) {
      ++next;
      ++old;
      continue;
    }
    const std::uint32_t run_end = next < places.size() ? places[next] : count;
    const auto begin = state.contacts.begin() + old;
    const auto run = state.contacts.begin() + run_end;
    const auto end = key_of(*(run - 1)) < key
                         ? run
                         : std::lower_bound(begin, run, key,
                                            [](const Contact<D>& contact, std::uint64_t wanted) {
                                              return key_of(contact) < wanted;
                                            });
    merged.insert(merged.end(), begin, end);
    old += static_cast<std::uint32_t>(end - begin);
    if (end != run) return;
  }
}

/// Lists those that rest and do not touch, from the given place on.
template <int D>
static void list_apart(const std::vector<Contact<D>>& contacts, std::size_t from,
                       std::vector<ApartContact>& apart) {
  for (std::size_t i = from; i < contacts.size(); ++i)
    if (contacts[i].touching == 0) apart.push_back({static_cast<std::uint32_t>(i), kNone});
}

template <int D>
void take_in_resting(const WorldState<D>& state, StepScratch<D>& scratch) {
  if (scratch.contacts_are_all) return;
  std::vector<Contact<D>>& merged = scratch.merged_contacts;
  std::vector<std::uint32_t>& places = scratch.contact_places;
  std::vector<ApartContact>& apart = scratch.apart;
  const std::size_t listed = apart.size();
  merged.clear();
  places.clear();
  std::uint32_t old = 0;
  std::size_t next = 0;
  const auto append_below = [&](std::uint64_t key) {
    const std::size_t from = merged.size();
    append_resting(state, scratch.kept->active_contacts.places, key, old, next, merged);
    list_apart(merged, from, apart);
  };
  for (const Contact<D>& contact : scratch.contacts) {
    append_below(key_of(contact));
    places.push_back(static_cast<std::uint32_t>(merged.size()));
    merged.push_back(contact);
  }
  append_below(~std::uint64_t{0});
  scratch.contacts.swap(merged);
  for (LiveContact<D>& live : scratch.live) live.contact = places[live.contact];
  for (std::uint32_t& began : scratch.began) began = places[began];
  for (std::size_t i = 0; i < listed; ++i) apart[i].contact = places[apart[i].contact];
  scratch.contacts_are_all = true;
}

/// Whether the contacts of the tick are those of the state that do not rest, of the same shapes.
template <int D>
static bool are_the_same(const WorldState<D>& state, const StepScratch<D>& scratch) {
  const OldContacts<D> old(state, scratch.kept->active_contacts);
  if (scratch.contacts.size() != old.size()) return false;
  for (std::uint32_t i = 0; i < old.size(); ++i)
    if (key_of(scratch.contacts[i]) != old.key(i)) return false;
  return true;
}

/// A copy, because the scratch is not the world's own. Grows as a list that is appended to, so that
/// contacts which come and go do not allocate in each tick.
template <int D>
static void take_all(const std::vector<Contact<D>>& from, Workers& workers,
                     std::vector<Contact<D>>& to) {
  if (from.size() > to.capacity()) to.reserve(std::max(from.size(), 2 * to.capacity()));
  to.resize(from.size());
  workers.parallel_for(static_cast<int>(from.size()), kLookGrain, [&](Range range) {
    std::copy(from.begin() + range.begin, from.begin() + range.end, to.begin() + range.begin);
  });
}

template <int D>
static void take_stepped(Workers& workers, StepScratch<D>& scratch, WorldState<D>& state) {
  ActiveContacts& active = scratch.kept->active_contacts;
  if (active.are_all) return take_all(scratch.contacts, workers, state.contacts);
  if (scratch.contacts_are_all) {  // Some woke: which ones rest is to be found out anew.
    active.is_known = false;
    return take_all(scratch.contacts, workers, state.contacts);
  }
  if (are_the_same(state, scratch)) {
    for (std::size_t i = 0; i < active.places.size(); ++i)
      state.contacts[active.places[i]] = scratch.contacts[i];
    return;
  }
  take_in_resting(state, scratch);
  active.places.assign(scratch.contact_places.begin(), scratch.contact_places.end());
  take_all(scratch.contacts, workers, state.contacts);
}

/// Contacts and merged ones change places, in ticks that are not the same when a world goes back:
/// what one has had room for, the other may need.
template <int D>
static void make_equal_room(StepScratch<D>& scratch) {
  std::vector<Contact<D>>& merged = scratch.merged_contacts;
  if (merged.capacity() == 0 || merged.capacity() == scratch.contacts.capacity()) return;
  scratch.contacts.reserve(merged.capacity());
  merged.clear();
  merged.reserve(scratch.contacts.capacity());
}

template <int D>
void take_contacts(Workers& workers, StepScratch<D>& scratch, WorldState<D>& state) {
  take_stepped(workers, scratch, state);
  make_equal_room(scratch);
}

template class OldContacts<2>;
template class OldContacts<3>;
template void list_active_contacts(const WorldState<2>&, Workers&, StepScratch<2>&);
template void list_active_contacts(const WorldState<3>&, Workers&, StepScratch<3>&);
template std::size_t contact_count(const WorldState<2>&, const StepScratch<2>&);
template std::size_t contact_count(const WorldState<3>&, const StepScratch<3>&);
template void take_in_resting(const WorldState<2>&, StepScratch<2>&);
template void take_in_resting(const WorldState<3>&, StepScratch<3>&);
template void take_contacts(Workers&, StepScratch<2>&, WorldState<2>&);
template void take_contacts(Workers&, StepScratch<3>&, WorldState<3>&);

}  // namespace cycloid::solver
