#pragma once

#include <cstddef>

#include "solver/constraints/contact_block.hpp"
#include "solver/constraints/live_contact.hpp"

namespace cycloid::solver {

/// Of the contacts that fill a block, which record is in which lane. Behind the last one stands the
/// last one again.
template <int W>
struct LanePlaces {
  LaneIndices<W> live;
  LaneIndices<W> contact;
};

/// Who is in each lane of a block.
template <int D, int W>
[[gnu::always_inline]] inline LanePlaces<W> name_lanes(const ContactInputs<D>& in,
                                                       const int* places, int count,
                                                       ContactBlock<D, W>& block) {
  LanePlaces<W> lanes;
  for (int lane = 0; lane < count; ++lane) {
    lanes.live[lane] = static_cast<std::uint32_t>(places[lane]);
    const LiveContact<D>& live = in.live[lanes.live[lane]];
    lanes.contact[lane] = live.contact;
    block.body_a[lane] = live.body_a;
    block.body_b[lane] = live.body_b;
    block.contact[lane] = live.contact;
  }
  for (int lane = count; lane < kLaneCount<W>; ++lane) {
    lanes.live[lane] = lanes.live[count - 1];
    lanes.contact[lane] = lanes.contact[count - 1];
    block.body_a[lane] = in.resting_body;
    block.body_b[lane] = in.resting_body;
    block.contact[lane] = kNone;
  }
  return lanes;
}

/// Which lanes have points, from how many the manifold of each has: an integer in place of a float.
template <int D, int W>
[[gnu::always_inline]] inline void count_points(const Lanes<W>& point_count, LaneBits used,
                                                ContactBlock<D, W>& block) {
  typename Lanes<W>::Mask counts;
  static_assert(sizeof counts == sizeof point_count.raw);
  std::memcpy(&counts, &point_count.raw, sizeof counts);
  for (int p = 0; p < Dim<D>::kManifoldPoints; ++p) {
    block.has_point[p] = bits_of<W>(counts > p) & used;
    if (block.has_point[p] != 0) block.point_count = static_cast<std::uint32_t>(p + 1);
  }
}

/// Masses of the bodies in all lanes; which of them have any.
template <int D, int W>
[[gnu::always_inline]] inline LaneBits gather_masses(const BodyMass<D>* masses,
                                                     const LaneIndices<W>& bodies,
                                                     LaneMass<D, W>& lanes) {
  constexpr int kFloats = 1 + Dim<D>::kSpin * Dim<D>::kSpin;
  for (int quad = 0; 4 * quad < kFloats; ++quad) {
    Lanes<W> columns[4];
    gather_columns<W>(masses, bodies, quad, columns);
    for (int i = 0; i < 4 && 4 * quad + i < kFloats; ++i) {
      const int at = 4 * quad + i;
      (at == 0 ? lanes.inverse_mass : lanes.inverse_inertia[at - 1]) = columns[i];
    }
  }
  return lanes_above_zero(lanes.inverse_mass);
}

template <int D, int W>
[[gnu::always_inline]] inline bool any_turns(const LaneMass<D, W>& mass) {
  Lanes<W> most(0.0f);
  for (const Lanes<W>& inertia : mass.inverse_inertia) most = max(most, max(inertia, -inertia));
  return any_above_zero(most);
}

/// Where the points of number `p` are, and last tick's impulses there. Without friction tangents
/// begin at 0: a material may have lost it since.
template <int D, int W>
[[gnu::always_inline]] inline void fill_point(const ContactInputs<D>& in,
                                              const LanePlaces<W>& lanes, int p,
                                              ContactBlock<D, W>& block) {
  using L = Lanes<W>;
  constexpr int kPoint = sizeof(ManifoldPoint<D>) / sizeof(float);
  constexpr int kImpulses = sizeof(ContactPoint<D>) / sizeof(float);
  static_assert(offsetof(ManifoldPoint<D>, separation) == D * sizeof(float));
  static_assert(offsetof(ContactPoint<D>, normal_impulse) == sizeof(float));
  auto& point = block.points[p];
  const auto exists = mask_of<W>(block.has_point[p]);
  const L zero(0.0f);
  L place[4];
  gather_floats<W>(in.live, lanes.live,
                   float_at(in.live[0], in.live[0].manifold.points) + p * kPoint, place);
  for (int i = 0; i < D; ++i) point.r_a[i] = select(exists, place[i], zero);
  point.separation = select(exists, place[D], zero);
  point.normal_mass = select(exists, L(1.0f), zero);
  L impulses[4];
  gather_floats<W>(in.contacts, lanes.contact,
                   float_at(in.contacts[0], in.contacts[0].points) + p * kImpulses, impulses);
  const L share(in.warm_starting);
  point.normal_impulse = select(exists, share * impulses[1], zero);
  const L rubs = select(exists, block.friction, zero);
  for (int t = 0; t < Dim<D>::kTangents; ++t)
    point.tangent_impulse[t] = select(rubs > zero, share * impulses[2 + t], zero);
}

/// Fills a block that is all zeros with contacts places[0, count): everything of a
/// ContactBlock that no `extra` asks for and ContactKernels::complete does not work out.
template <int D, int W>
[[gnu::always_inline]] inline void fill_block(const ContactInputs<D>& in, const int* places,
                                              int count, ContactBlock<D, W>& block) {
  using L = Lanes<W>;
  const L zero(0.0f);
  const LanePlaces<W> lanes = name_lanes(in, places, count, block);
  block.moves_a = gather_masses<D, W>(in.masses, block.body_a, block.mass_a);
  block.moves_b = gather_masses<D, W>(in.masses, block.body_b, block.mass_b);
  block.turns = any_turns(block.mass_a) || any_turns(block.mass_b);
  const LaneBits used_bits = kAllLanes<W> >> (kLaneCount<W> - count);
  const auto used = mask_of<W>(used_bits);
  static_assert(offsetof(Manifold<D>, point_count) == D * sizeof(float));
  L columns[4];
  gather_floats<W>(in.live, lanes.live, float_at(in.live[0], in.live[0].manifold), columns);
  for (int i = 0; i < D; ++i) block.normal[i] = select(used, columns[i], zero);
  count_points(columns[D], used_bits, block);
  static_assert(offsetof(LiveContact<D>, square_friction) ==
                offsetof(LiveContact<D>, between) + D * sizeof(float));
  gather_floats<W>(in.live, lanes.live, float_at(in.live[0], in.live[0].between), columns);
  for (int i = 0; i < D; ++i) block.between[i] = select(used, columns[i], zero);
  block.friction = select(used, columns[D], zero);
  block.rubs = any_above_zero(block.friction);
  for (int p = 0; p < static_cast<int>(block.point_count); ++p) fill_point(in, lanes, p, block);
}

}  // namespace cycloid::solver
