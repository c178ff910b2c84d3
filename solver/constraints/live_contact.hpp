#pragma once

#include "solver/collision/manifold.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// A contact that is solved in this tick, with what is at hand where its shapes are collided and
/// lies far apart later. What lanes gather of it lies in quads: `between` and what follows.
template <int D>
struct LiveContact {
  Manifold<D> manifold;
  Vec<D> between;         ///< Centre of b from that of a, m.
  float square_friction;  ///< Product of the two coefficients of friction.
  std::uint32_t contact;  ///< Its place among all contacts.
  std::uint32_t body_a;
  std::uint32_t body_b;
  std::uint32_t material_a;
  std::uint32_t material_b;
  bool a_is_ball;  ///< About its centre of mass.
  bool b_is_ball;
  bool has_round;  ///< One shape has a radius.
  bool has_extra;  ///< That, or materials, ask for a ContactExtra.
};

/// What blocks of contacts are filled from.
template <int D>
struct ContactInputs {
  const LiveContact<D>* live;
  const Contact<D>* contacts;  ///< By LiveContact::contact, with the impulses to start from.
  const BodyMass<D>* masses;   ///< By body slot; the one at `resting_body` has none.
  std::uint32_t resting_body;
  float warm_starting;  ///< Share of those impulses.
};

}  // namespace cycloid::solver
