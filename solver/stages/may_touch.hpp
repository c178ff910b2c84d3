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

/// Whether a joint of these bodies keeps them from colliding. Most bodies have few joints.
template <int D>
bool are_jointed(const PairCache<D>& cache, std::uint32_t a, std::uint32_t b) {
  const std::size_t lower = std::min(a, b);
  if (lower + 1 >= cache.first_jointed.size()) return false;
  const auto jointed = cache.jointed_bodies.begin();
  return std::binary_search(jointed + cache.first_jointed[lower],
                            jointed + cache.first_jointed[lower + 1], body_pair_key(a, b));
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
  return !are_jointed(scratch.kept->pair_cache, a.body, b.body);
}

}  // namespace cycloid::solver
