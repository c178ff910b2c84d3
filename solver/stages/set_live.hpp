#pragma once

#include "solver/step_scratch.hpp"

namespace cycloid::solver {

template <int D>
bool is_centred_ball(const Shape<D>& shape) {
  return shape.kind == ShapeKind::kBall && length(shape.vertices[0]) <= 1.0e-6f * shape.radius;
}

/// Whether a material bounces or resists rolling.
inline bool does_more_than_rub(const Material& material) {
  return material.restitution > 0.0f || material.rolling_resistance > 0.0f ||
         material.twist_resistance > 0.0f;
}

/// What two materials make of a contact, looked up anew where it is not of the same two as before:
/// nearly all contacts of a world are.
class MaterialPair {
 public:
  explicit MaterialPair(const std::vector<Material>& materials) : materials_(materials) {}

  void look_up(std::uint32_t a, std::uint32_t b) {
    if (a == a_ && b == b_) return;
    a_ = a;
    b_ = b;
    square_friction_ = materials_[a].friction * materials_[b].friction;
    has_extra_ = does_more_than_rub(materials_[a]) || does_more_than_rub(materials_[b]);
  }
  float square_friction() const { return square_friction_; }
  bool has_extra() const { return has_extra_; }

 private:
  const std::vector<Material>& materials_;
  std::uint32_t a_ = kNone;
  std::uint32_t b_ = kNone;
  float square_friction_ = 0.0f;
  bool has_extra_ = false;
};

/// What is at hand of the contact in place `contact` among all.
/// Inlined, as a call for each contact is a tenth of the stage.
/// @param pair  With the poses that the manifold is of.
template <int D>
[[gnu::always_inline]] inline void set_live(const WorldState<D>& state, const PlacedPair<D>& pair,
                                            const Manifold<D>& manifold, std::uint32_t contact,
                                            MaterialPair& materials, LiveContact<D>& live) {
  const Shape<D>& a = state.shapes[pair.shape_a];
  const Shape<D>& b = state.shapes[pair.shape_b];
  materials.look_up(a.material, b.material);
  live.manifold = manifold;
  live.between = pair.pose_b.position - pair.pose_a.position;
  live.square_friction = materials.square_friction();
  live.contact = contact;
  live.body_a = a.body;
  live.body_b = b.body;
  live.material_a = a.material;
  live.material_b = b.material;
  live.a_is_ball = is_centred_ball(a);
  live.b_is_ball = is_centred_ball(b);
  live.has_round = a.radius > 0.0f || b.radius > 0.0f;
  live.has_extra = live.has_round || materials.has_extra();
}

}  // namespace cycloid::solver
