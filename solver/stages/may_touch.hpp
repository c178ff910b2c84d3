#pragma once

#include <algorithm>

#include "solver/step_scratch.hpp"

namespace cycloid::solver {

/// Only a body that forces move answers to a contact.
inline bool responds(BodyKind kind) {
  return kind == BodyKind::kDynamic || kind == BodyKind::kParticle;
}

inline std::uint64_t body_pair_key(std::uint32_t a, std::uint32_t b) {
  return a < b ? (std::uint64_t{a} << 32) | b : (std::uint64_t{b} << 32) | a;
}

/// Whether two shapes may have a contact at all: bodies, filters, joints.
template <int D>
bool may_touch(const WorldState<D>& state, const StepScratch<D>& scratch, std::uint32_t shape_a,
               std::uint32_t shape_b) {
  const Shape<D>& a = state.shapes[shape_a];
  const Shape<D>& b = state.shapes[shape_b];
  if (a.body == b.body) return false;
  if (!responds(state.bodies[a.body].kind) && !responds(state.bodies[b.body].kind)) return false;
  if (!filters_meet(a.filter, b.filter)) return false;
  const std::vector<std::uint64_t>& jointed = scratch.pair_cache.jointed_bodies;
  return jointed.empty() ||
         !std::binary_search(jointed.begin(), jointed.end(), body_pair_key(a.body, b.body));
}

}  // namespace cycloid::solver
