#pragma once

#include <vector>

#include "solver/world.hpp"

namespace cycloid::solver {

/// Who the two shapes of a contact are, for a user.
template <int D>
ContactEvent contact_event(const WorldState<D>& state, const Contact<D>& contact, bool began);

/// What ceased to touch and then what began to, from the contacts of the last tick (`state`) to
/// those of this one; both are sorted by shape slots, and so are the two lists of events.
template <int D>
void append_contact_events(const WorldState<D>& state, const std::vector<Contact<D>>& now,
                           std::vector<ContactEvent>& events);

}  // namespace cycloid::solver
