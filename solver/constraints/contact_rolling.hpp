#pragma once

#include "solver/constraints/contact.hpp"

namespace cycloid::solver {

/// Of a pair of materials, no unit. The plane has no spin about a normal.
template <int D>
float twist_resistance(const Material& a, const Material& b) {
  return Dim<D>::kSpin > 1 ? max(a.twist_resistance, b.twist_resistance) : 0.0f;
}

/// The rolling moment in the plane: an interval. `spin` is that of b over a, rad/s.
template <class Block, class Extra, class L>
Vec<1, L> rolling_moment(const Block& block, const Extra& extra, const L& normal_impulse,
                         const Vec<1, L>& spin) {
  const L k = block.mass_a.inverse_inertia[0] + block.mass_b.inverse_inertia[0];
  const L mass = select(k > L(0.0f), L(1.0f) / select(k > L(0.0f), k, L(1.0f)), L(0.0f));
  L wanted[1] = {extra.rolling_impulse[0] - mass * spin[0]};
  hold_to_cone<1>(extra.rolling * normal_impulse, wanted);
  return {{wanted[0]}};
}

/// In space: the part across the normal is held to a disc, the part about it to an interval of its
/// own. Across, the moment that stops the rolling is taken where the disc has it. Where it has not,
/// a step of 1 / (largest eigenvalue) against the spin, held to the disc, finds the moment against
/// the spin also for bodies that turn more easily about one direction than about the other.
template <int W, class Block, class Extra>
Vec<3, Lanes<W>> rolling_moment(const Block& block, const Extra& extra,
                                const Lanes<W>& normal_impulse, const Vec<3, Lanes<W>>& spin) {
  using L = Lanes<W>;
  constexpr int kSpace = 3;
  const L zero(0.0f);
  const L one(1.0f);
  const auto turned = [&](const Vec<kSpace, L>& moment_of) {
    return turned_by<kSpace, W>(block.mass_a, moment_of) +
           turned_by<kSpace, W>(block.mass_b, moment_of);
  };
  const auto inverse = [&](const L& k) { return one / select(k > zero, k, one); };
  const Vec<kSpace, L>& normal = block.normal;
  const L k_twist = dot(normal, turned(normal));
  const L twisted = dot(extra.rolling_impulse, normal);
  const L most_twist = extra.twist * normal_impulse;
  const L stop = twisted - inverse(k_twist) * dot(normal, spin);
  const L twist = select(k_twist > zero, max(-most_twist, min(stop, most_twist)), zero);
  const Vec<kSpace, L> left = spin + turned((twist - twisted) * normal);

  const Vec<kSpace, L>(&across)[2] = block.tangent;
  const Vec<kSpace, L> turned_0 = turned(across[0]);
  const L k00 = dot(across[0], turned_0);
  const L k01 = dot(across[1], turned_0);
  const L k11 = dot(across[1], turned(across[1]));
  const L w0 = dot(across[0], left);
  const L w1 = dot(across[1], left);
  const L old0 = dot(extra.rolling_impulse, across[0]);
  const L old1 = dot(extra.rolling_impulse, across[1]);
  const L determinant = k00 * k11 - k01 * k01;
  const L over = inverse(determinant);
  const L stop0 = old0 - over * (k11 * w0 - k01 * w1);
  const L stop1 = old1 - over * (k00 * w1 - k01 * w0);
  const L most = extra.rolling * normal_impulse;
  const L sum = k00 + k11;
  const L inside = select(most * most < stop0 * stop0 + stop1 * stop1, zero, one);
  const L stops = select(determinant > L(1.0e-6f) * sum * sum, inside, zero);
  const L apart = k00 - k11;
  const L largest = L(0.5f) * (sum + sqrt(apart * apart + L(4.0f) * k01 * k01));
  const L step = select(largest > zero, inverse(largest), zero);
  L wanted[2] = {select(stops > zero, stop0, old0 - step * w0),
                 select(stops > zero, stop1, old1 - step * w1)};
  hold_to_cone<2>(most, wanted);
  return wanted[0] * across[0] + wanted[1] * across[1] + twist * normal;
}

/// Rolling and twist resistance: Cdot = w_b - w_a; the moment across the normal is at most rolling,
/// the one about it twist times the sum of the normal impulses, N m s.
/// Source: Coulomb's law of rolling; the coefficient times the radius is the lever of the normal
/// force.
template <int D, int W>
void solve_rolling(ContactBlock<D, W>& block, MotionLanes<D, W>& a, MotionLanes<D, W>& b) {
  using L = Lanes<W>;
  L normal_impulse = L(0.0f);
  for (std::uint32_t i = 0; i < block.point_count; ++i)
    normal_impulse += block.points[i].normal_impulse;
  ContactExtra<D, W>& extra = *block.extra;
  const Spin<D, L> wanted = rolling_moment(block, extra, normal_impulse, b.spin - a.spin);
  const Spin<D, L> change = wanted - extra.rolling_impulse;
  extra.rolling_impulse = wanted;
  turn_pair(change, block, a, b);
}

}  // namespace cycloid::solver
