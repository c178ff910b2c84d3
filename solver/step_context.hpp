#pragma once

#include "solver/constraints/softness.hpp"
#include "solver/definitions.hpp"

namespace cycloid::solver {

/// Constants of one tick that every stage reads.
template <int D>
struct StepContext {
  float tick_s;
  float h;  ///< s, of one substep.
  float inverse_h;
  Vec<D> gravity;
  Tuning tuning;
  Softness contact;         ///< Between two movable bodies.
  Softness contact_static;  ///< Against a body without mass: twice as stiff.
  Softness joint;
  Softness pseudo;                 ///< Of pseudo-velocity sweeps, which are rigid and biased.
  Softness motor;                  ///< Of position motors without a frequency of their own.
  float guess_spin_max;            ///< rad/s that the guess of a joint may turn a body by.
  float slop;                      ///< m of overlap that velocity sweeps leave alone.
  float stiff_overlap;             ///< m beyond it that count twice: normal_row.
  std::uint32_t lot_contacts = 0;  ///< Of a lot that is asked for; 0: what suits. Changes no bit.
  int lanes = 0;                   ///< Width that is asked for; 0: what suits. Changes no bit.
  bool odd = false;      ///< Of the number of the tick and the substep in sum: see point_in_turn.
  bool is_first = true;  ///< Of the substeps of the tick.
};

/// The most that the impulses of the substep before may turn a body as a guess, rad in a substep.
/// They act along rows that have turned since. A force f that goes with its body's arm r is a
/// spring of stiffness r f to how the body turns, and as a guess an explicit one: with the impulse
/// lambda = h f it stays bounded while h lambda r / I = h^2 r f / I is below 4, and beyond that it
/// throws out what is light within a few substeps. With 2 and 1 a net of 10,000 balls sags by more.
/// Methods whose substeps are long carry chains by such guesses, and close them by positions.
inline constexpr float kGuessTurns_rad = 3.0f;

/// Stiffness above a fraction of the substep rate turns into noise: contacts are held to an eighth
/// of it and joints to a quarter (Catto, Solver2D).
/// What rests on a spring needs no slop to stay in touch, its load overlaps it; a slop would come
/// on top of that in every contact. An island at once is rigid, and needs it.
/// The default's springs are twice as stiff until they have given way by the slop, so that what
/// lies in a heap overlaps half as far. Beyond it they are not: what is thick stands because its
/// heaviest contacts give way. And three times as stiff would be more than one sweep can do: cards
/// slide (docs/stability.md).
template <int D>
StepContext<D> make_step_context(float tick_s, const Vec<D>& gravity, const Tuning& tuning) {
  StepContext<D> context;
  context.tick_s = tick_s;
  context.h = tick_s / static_cast<float>(tuning.substeps);
  context.inverse_h = static_cast<float>(tuning.substeps) / tick_s;
  context.gravity = gravity;
  context.tuning = tuning;
  const float contact_hertz = min(tuning.contact_hertz, 0.125f * context.inverse_h);
  const float joint_hertz = min(tuning.joint_hertz, 0.25f * context.inverse_h);
  context.pseudo = baumgarte_softness(tuning.baumgarte, context.h);
  context.motor = spring_softness(joint_hertz, tuning.joint_damping_ratio, context.h);
  const bool springs = tuning.stabilisation == Stabilisation::kSoft &&
                       tuning.contact_block != ContactBlockRows::kIsland;
  constexpr float kAnySpin = 1.0e18f;  // Its square is finite.
  context.guess_spin_max =
      tuning.stabilisation == Stabilisation::kSoft ? kGuessTurns_rad * context.inverse_h : kAnySpin;
  context.slop = springs ? 0.0f : tuning.slop;
  context.stiff_overlap = solves_loaded_islands(tuning) ? tuning.slop : 0.0f;
  if (tuning.stabilisation != Stabilisation::kSoft) {
    const bool biased = tuning.stabilisation == Stabilisation::kBaumgarte;
    context.contact = biased ? context.pseudo : kRigid;
    context.contact_static = context.contact;
    context.joint = context.contact;
    return context;
  }
  context.contact = spring_softness(contact_hertz, tuning.contact_damping_ratio, context.h);
  context.contact_static =
      spring_softness(2.0f * contact_hertz, tuning.contact_damping_ratio, context.h);
  context.joint = context.motor;
  return context;
}

/// Whether a sweep corrects positions (biased, soft), only velocities (relax), or pseudo-velocities
/// that start at zero and answer to overlap alone.
enum class Sweep { kBiased, kRelax, kPseudo };

/// Which of `count` points of a manifold a sweep visits as number i: from the first to the last and
/// from the last to the first in turn. Always in one order each sweep would favour the last point,
/// and everything lean: of twenty boxes on one another Soft Step let the highest sink by 0.6 m, and
/// the pyramids under heavy apexes were thrown over. The turns go on from tick to tick: each tick
/// beginning alike, thirty boxes on one another sway at 10 mm/s for ever. The relax sweep goes
/// against the biased one: if both turn together, cards that lean on one another slide.
template <int D>
[[gnu::always_inline]] inline std::uint32_t point_in_turn(const StepContext<D>& context,
                                                          Sweep sweep, std::uint32_t i,
                                                          std::uint32_t count) {
  const bool backwards = context.odd != (sweep == Sweep::kRelax);
  return backwards ? count - 1 - i : i;
}

}  // namespace cycloid::solver
