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

template ContactEvent contact_event(const WorldState<2>&, const Contact<2>&, bool);
template ContactEvent contact_event(const WorldState<3>&, const Contact<3>&, bool);

}  // namespace cycloid::solver
