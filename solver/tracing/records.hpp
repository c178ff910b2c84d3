#pragma once

#include "solver/visit.hpp"

namespace cycloid::solver {

/// What a step works on, one body, contact or joint in a record, free of lanes, blocks and colours:
/// what a trace digests and names. Fields of the same name are those of the working data.

template <int D>
struct BodyWork {
  Vec<D> velocity;
  Spin<D> spin;
  Vec<D> delta_position;
  Rotation<D> delta_rotation;
  Inertia<D> inverse_inertia;
};
template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const BodyWork<D>*) {
  f("velocity", r.velocity);
  f("spin", r.spin);
  f("delta_position", r.delta_position);
  f("delta_rotation", r.delta_rotation);
  f("inverse_inertia", r.inverse_inertia);
}

/// Of wake_islands.
struct BodyIsland {
  std::uint32_t island = 0;
  std::uint32_t awake = 0;
  std::uint32_t kept_awake = 0;
};
template <class R, class F>
constexpr void visit_fields(R& r, F&& f, const BodyIsland*) {
  f("island", r.island);
  f("awake", r.awake);
  f("kept_awake", r.kept_awake);
}

struct PairFound {
  std::uint32_t shape_a = kNone;
  std::uint32_t shape_b = kNone;
};
template <class R, class F>
constexpr void visit_fields(R& r, F&& f, const PairFound*) {
  f("shape_a", r.shape_a);
  f("shape_b", r.shape_b);
}

/// Where a constraint stands in the order of solving.
struct ColorPlace {
  std::uint32_t color = kNone;
  std::uint32_t place = kNone;
};
template <class R, class F>
constexpr void visit_fields(R& r, F&& f, const ColorPlace*) {
  f("color", r.color);
  f("place", r.place);
}

template <int D>
struct FoundPoint {
  std::uint32_t feature = 0;
  Vec<D> anchor_a = Vec<D>::zero();
  Vec<D> anchor_b = Vec<D>::zero();
  float separation = 0.0f;
};
template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const FoundPoint<D>*) {
  f("feature", r.feature);
  f("anchor_a", r.anchor_a);
  f("anchor_b", r.anchor_b);
  f("separation", r.separation);
}

/// A contact with its manifold, which is empty where the contact sleeps.
template <int D>
struct ContactFound {
  Contact<D> contact;
  Vec<D> normal = Vec<D>::zero();
  std::array<FoundPoint<D>, Dim<D>::kManifoldPoints> manifold{};
};
template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const ContactFound<D>*) {
  visit(r.contact, f);
  f("normal", r.normal);
  f("manifold", r.manifold);
}

template <int D>
struct PointWork {
  Vec<D> r_a = Vec<D>::zero();
  Vec<D> r_b = Vec<D>::zero();
  float separation = 0.0f;
  float normal_mass = 0.0f;
  Vec<Dim<D>::kTangents> tangent_mass = Vec<Dim<D>::kTangents>::zero();
  float normal_impulse = 0.0f;
  Vec<Dim<D>::kTangents> tangent_impulse = Vec<Dim<D>::kTangents>::zero();
  float bounce_impulse = 0.0f;
  float position_impulse = 0.0f;
};
template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const PointWork<D>*) {
  f("r_a", r.r_a);
  f("r_b", r.r_b);
  f("separation", r.separation);
  f("normal_mass", r.normal_mass);
  f("tangent_mass", r.tangent_mass);
  f("normal_impulse", r.normal_impulse);
  f("tangent_impulse", r.tangent_impulse);
  f("bounce_impulse", r.bounce_impulse);
  f("position_impulse", r.position_impulse);
}

template <int D>
struct ContactWork {
  std::uint32_t body_a = kNone;  ///< kNone: the contact is not solved in this tick.
  std::uint32_t body_b = kNone;
  Vec<D> normal;
  std::array<Vec<D>, Dim<D>::kTangents> tangent;
  float friction;
  float restitution;
  float rolling;
  float twist;
  float pull;
  std::array<PointWork<D>, Dim<D>::kManifoldPoints> points;
  Spin<D> rolling_impulse;
};
template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const ContactWork<D>*) {
  f("body_a", r.body_a);
  f("body_b", r.body_b);
  f("normal", r.normal);
  f("tangent", r.tangent);
  f("friction", r.friction);
  f("restitution", r.restitution);
  f("rolling", r.rolling);
  f("twist", r.twist);
  f("pull", r.pull);
  f("points", r.points);
  f("rolling_impulse", r.rolling_impulse);
}

template <int D>
struct RowWork {
  Vec<D> linear_a = Vec<D>::zero();
  Spin<D> angular_a = Spin<D>::zero();
  Vec<D> linear_b = Vec<D>::zero();
  Spin<D> angular_b = Spin<D>::zero();
  float error = 0.0f;
  float rate = 0.0f;
};
template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const RowWork<D>*) {
  f("linear_a", r.linear_a);
  f("angular_a", r.angular_a);
  f("linear_b", r.linear_b);
  f("angular_b", r.angular_b);
  f("error", r.error);
  f("rate", r.rate);
}

template <int D>
struct JointWork {
  std::uint32_t body_a = kNone;
  std::uint32_t body_b = kNone;
  std::array<RowWork<D>, Dim<D>::kFreedoms> rows{};
  std::array<float, Dim<D>::kFreedoms> inverse_pivot{};
  std::array<RowWork<D>, 1> axis{};
  float axis_mass = 0.0f;
  float motor_mass = 0.0f;
  std::array<float, Dim<D>::kFreedoms> impulse{};
  float spring_impulse = 0.0f;
  float motor_impulse = 0.0f;
  float lower_impulse = 0.0f;
  float upper_impulse = 0.0f;
  float cone_impulse = 0.0f;
};
template <class R, class F, int D>
constexpr void visit_fields(R& r, F&& f, const JointWork<D>*) {
  f("body_a", r.body_a);
  f("body_b", r.body_b);
  f("rows", r.rows);
  f("inverse_pivot", r.inverse_pivot);
  f("axis", r.axis);
  f("axis_mass", r.axis_mass);
  f("motor_mass", r.motor_mass);
  f("impulse", r.impulse);
  f("spring_impulse", r.spring_impulse);
  f("motor_impulse", r.motor_impulse);
  f("lower_impulse", r.lower_impulse);
  f("upper_impulse", r.upper_impulse);
  f("cone_impulse", r.cone_impulse);
}

}  // namespace cycloid::solver
