#pragma once

#include "solver/constraints/contact.hpp"
#include "solver/constraints/live_contact.hpp"

namespace cycloid::solver {

/// The blocks of a range and the motions that they gather: what every kernel works on. No two of
/// the blocks share a body that moves.
template <int D, int W>
struct BlockRange {
  ContactBlock<D, W>* begin;
  ContactBlock<D, W>* end;
  Motion<D>* motions;   ///< By body slot.
  std::uint32_t poses;  ///< Lot::poses.
  bool slides_far;      ///< StepScratch::slides_far.
};

/// What a row may miss before more than sweeps is done about it, m/s.
struct RestBounds {
  float misses;   ///< Velocities, of an island that was at rest.
  float stirs;    ///< Velocities, of one that was not, or that sways.
  float overlap;  ///< Of what overlaps, the speed that it is to be moved apart by.
};

/// Of what is solved at once because springs would give way.
struct LoadBounds {
  bool asked = false;         ///< Else no contact is looked at.
  float yield = 0.0f;         ///< yield_of the spring between two bodies that move, s.
  float yield_static = 0.0f;  ///< Of that against one that does not.
  float most = 0.0f;          ///< m.
};

/// What is done to contacts in lanes, compiled for each width: contact_kernels.cpp and
/// contact_kernels_avx2.cpp, from one text (contact_sweeps.hpp). Units of other files only call.
template <int D, int W>
struct ContactKernels {
  /// Contacts places[0, count) of `in.live` into a block that is all zeros, but for its extra.
  /// @pre 0 < count <= kLaneCount<W>.
  static void fill(const ContactInputs<D>& in, const int* places, int count,
                   ContactBlock<D, W>& block);
  /// Whether any of contacts [begin, end) of `in.live` carries more than springs hold within the
  /// bounds: of what complete() finds in blocks.
  static bool any_loaded(const LoadBounds& bounds, const ContactInputs<D>& in, int begin, int end);
  /// What follows from the numbers of each lane once they are there: tangents, effective masses,
  /// shares, the coefficient of friction, whose square stands in its place, and which lanes carry
  /// more than springs hold within the bounds (ContactBlock::loaded).
  static void complete(const LoadBounds& bounds, const BlockRange<D, W>& range);
  /// Normal, arms and separation of pairs of balls at the present poses (follow_round).
  static void follow(const BlockRange<D, W>& range);
  /// Effective masses once more in the lanes where `wanted` is not 0: of bodies whose inertia has
  /// turned.
  static void weigh(const float (&wanted)[kLaneCount<W>], ContactBlock<D, W>& block);
  /// No point has bounced in this substep yet.
  static void forget_bounces(const BlockRange<D, W>& range);
  /// One sweep of collisions; sets ContactBlock::bounced.
  static void bounce(const StepContext<D>& context, const BlockRange<D, W>& range);
  /// Adds to ContactBlock::pushed the lanes with a normal impulse. @pre it is of this tick.
  static void note_pushes(const BlockRange<D, W>& range);
  /// v += M^-1 J^T lambda.
  static void warm_start(const BlockRange<D, W>& range);
  /// What the warm start has left to do: ContactBlock::misses and stirs.
  static void look_for_rest(const StepContext<D>& context, const RestBounds& bounds,
                            const BlockRange<D, W>& range);
  /// One sweep of sequential impulses, two blocks at a time. @pre no two share a body that moves.
  static void sweep(const StepContext<D>& context, Sweep kind, const BlockRange<D, W>& range);
  /// One sweep on positions (correct_contact).
  static void correct(const StepContext<D>& context, const BlockRange<D, W>& range);
  /// XPBD's position pass, with the motions before the substep, and its velocity pass.
  static void project(const StepContext<D>& context, const Motion<D>* before,
                      const BlockRange<D, W>& range);
  static void rub(const StepContext<D>& context, const BlockRange<D, W>& range);
};

}  // namespace cycloid::solver
