#pragma once

#include "solver/world.hpp"

namespace cycloid::solver {

/// Who the two shapes of a contact are, for a user.
template <int D>
ContactEvent contact_event(const WorldState<D>& state, const Contact<D>& contact, bool began);

}  // namespace cycloid::solver
