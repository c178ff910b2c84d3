#pragma once

#include "solver/step_scratch.hpp"

namespace cycloid::solver {

template <int D>
bool is_centred_ball(const Shape<D>& shape) {
  return shape.kind == ShapeKind::kBall && length(shape.vertices[0]) <= 1.0e-6f * shape.radius;
}

/// Appends to `list` what is at hand of the contact in place `contact` among all.
template <int D>
void add_live(const WorldState<D>& state, const ShapePair& pair, const Manifold<D>& manifold,
              std::uint32_t contact, std::vector<LiveContact<D>>& list) {
  const Shape<D>& a = state.shapes[pair.shape_a];
  const Shape<D>& b = state.shapes[pair.shape_b];
  LiveContact<D>& live = list.emplace_back();
  live.contact = contact;
  live.body_a = a.body;
  live.body_b = b.body;
  live.material_a = a.material;
  live.material_b = b.material;
  live.a_is_ball = is_centred_ball(a);
  live.b_is_ball = is_centred_ball(b);
  live.between = state.bodies[b.body].position - state.bodies[a.body].position;
  live.manifold.normal = manifold.normal;
  live.manifold.point_count = manifold.point_count;
  for (std::uint32_t p = 0; p < manifold.point_count; ++p)
    live.manifold.points[p] = manifold.points[p];
}

}  // namespace cycloid::solver
