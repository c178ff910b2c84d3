#pragma once

#include "solver/constraints/contact.hpp"
#include "solver/constraints/single_lanes.hpp"

namespace cycloid::solver {

/// What follows from the single lanes of a contact block for all lanes at once.

/// (J M^-1 J^T)^-1 of a row along `direction`; 0 where nothing moves.
template <int D, int W>
Lanes<W> effective_mass(const ContactBlock<D, W>& block, const Vec<D, Lanes<W>>& r_a,
                        const Vec<D, Lanes<W>>& r_b, const Vec<D, Lanes<W>>& direction) {
  using L = Lanes<W>;
  L k = block.mass_a.inverse_mass + block.mass_b.inverse_mass;
  if (block.turns) {
    const Spin<D, L> turn_a = moment(r_a, direction);
    const Spin<D, L> turn_b = moment(r_b, direction);
    k = k + dot(turn_a, turned_by<D, W>(block.mass_a, turn_a)) +
        dot(turn_b, turned_by<D, W>(block.mass_b, turn_b));
  }
  const auto moves = k > L(0.0f);
  return select(moves, L(1.0f) / select(moves, k, L(1.0f)), L(0.0f));
}

/// Effective masses of every point in the lanes where `wanted` is above 0; 0 where a lane has no
/// such point. @pre normal_mass is above 0 where it has one.
/// @param arms  of a point, those of the tick's start or of now.
template <int D, int W, class ArmsOf>
void set_effective_masses(const Lanes<W>& wanted, const ArmsOf& arms_of_point,
                          ContactBlock<D, W>& block) {
  using L = Lanes<W>;
  for (std::uint32_t p = 0; p < block.point_count; ++p) {
    auto& point = block.points[p];
    const auto exists = point.normal_mass > L(0.0f);
    const Arms<D, L> arms = arms_of_point(point);
    const auto set = [&](const Vec<D, L>& direction, L& mass) {
      const L now = select(exists, effective_mass(block, arms.r_a, arms.r_b, direction), L(0.0f));
      mass = select(wanted > L(0.0f), now, mass);
    };
    for (int t = 0; t < Dim<D>::kTangents; ++t) set(tangent_of(block, t), point.tangent_mass[t]);
    set(block.normal, point.normal_mass);
  }
}

/// With the arms of the tick's start.
template <int D, int W>
void set_first_masses(const Lanes<W>& wanted, ContactBlock<D, W>& block) {
  set_effective_masses(
      wanted,
      [&](const auto& point) {
        return Arms<D, Lanes<W>>{point.r_a, arm_b_of(block, point)};
      },
      block);
}

/// Anew, where a point has slid farther from a centre than it was from it: the masses of the tick's
/// start are then many times too large for the arms of now, and each row would throw its bodies
/// harder than the one before; a body of 2 km/s blew up what it flew into. Apart from the sweeps,
/// which hardly ever ask for it.
template <int D, int W>
[[gnu::noinline]] void weigh_where_slid(ContactBlock<D, W>& block) {
  using L = Lanes<W>;
  if (!block.turns) return;
  const auto& point = block.points[0];
  const Vec<D, L> r_b = arm_b_of(block, point);
  const L far_a = dot(block.slide_a, block.slide_a) - dot(point.r_a, point.r_a);
  const L far_b = dot(block.slide_b, block.slide_b) - dot(r_b, r_b);
  const L far = max(far_a, far_b);
  if (!any_above_zero(far)) return;
  set_effective_masses(
      far, [&](const auto& at) { return arms_of(block, at); }, block);
}

}  // namespace cycloid::solver
