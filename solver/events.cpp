#include "solver/events.hpp"

namespace cycloid::solver {

template <int D>
ContactEvent contact_event(const WorldState<D>& state, const Contact<D>& contact, bool began) {
  const Shape<D>& a = state.shapes[contact.shape_a];
  const Shape<D>& b = state.shapes[contact.shape_b];
  return {{a.body, state.bodies[a.body].generation},
          {b.body, state.bodies[b.body].generation},
          a.ordinal,
          b.ordinal,
          began};
}

template <int D>
static bool comes_before(const Contact<D>& a, const Contact<D>& b) {
  return a.shape_a != b.shape_a ? a.shape_a < b.shape_a : a.shape_b < b.shape_b;
}

/// Calls found(contact) for each contact that touches in `here` and does not in `there`.
template <int D, class Found>
static void for_each_only_in(const std::vector<Contact<D>>& here,
                             const std::vector<Contact<D>>& there, Found&& found) {
  auto other = there.begin();
  for (const Contact<D>& contact : here) {
    if (contact.touching == 0) continue;
    while (other != there.end() && comes_before(*other, contact)) ++other;
    const bool same_pair = other != there.end() && !comes_before(contact, *other);
    if (!same_pair || other->touching == 0) found(contact);
  }
}

template <int D>
void append_contact_events(const WorldState<D>& state, const std::vector<Contact<D>>& now,
                           std::vector<ContactEvent>& events) {
  for_each_only_in(state.contacts, now, [&](const Contact<D>& contact) {
    events.push_back(contact_event(state, contact, false));
  });
  for_each_only_in(now, state.contacts, [&](const Contact<D>& contact) {
    events.push_back(contact_event(state, contact, true));
  });
}

template ContactEvent contact_event(const WorldState<2>&, const Contact<2>&, bool);
template ContactEvent contact_event(const WorldState<3>&, const Contact<3>&, bool);
template void append_contact_events(const WorldState<2>&, const std::vector<Contact<2>>&,
                                    std::vector<ContactEvent>&);
template void append_contact_events(const WorldState<3>&, const std::vector<Contact<3>>&,
                                    std::vector<ContactEvent>&);

}  // namespace cycloid::solver
