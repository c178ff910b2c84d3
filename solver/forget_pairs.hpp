#pragma once

#include <initializer_list>

#include "solver/collision/pair_cache.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// What a call between ticks has to tell the pair cache. The steps themselves need not: they move
/// bodies no farther than their boxes say.

/// A body was put elsewhere, or may stand otherwise than in the last tick.
template <int D>
void note_move(const Body<D>& body, PairCache<D>& cache) {
  if (body.kind == BodyKind::kStatic) return cache.forget_all();
  if (body.first_shape < cache.is_still.size()) cache.is_still[body.first_shape] = 0;
}

/// A body came, or is about to go, or what its shapes may touch is another.
template <int D>
void note_change(const WorldState<D>& state, const Body<D>& body, PairCache<D>& cache) {
  if (body.kind == BodyKind::kStatic) return cache.forget_all();
  for (std::uint32_t s = body.first_shape; s != kNone; s = state.shapes[s].next) cache.forget(s);
}

/// A joint between two bodies came, or is about to go. What cannot move looks for nobody.
template <int D>
void note_joint(const WorldState<D>& state, const Joint<D>& joint, PairCache<D>& cache) {
  for (const std::uint32_t index : {joint.body_a, joint.body_b})
    if (const Body<D>& body = state.bodies[index]; body.kind != BodyKind::kStatic)
      note_change(state, body, cache);
}

}  // namespace cycloid::solver
