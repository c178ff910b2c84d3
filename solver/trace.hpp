#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solver/state.hpp"

namespace cycloid::solver {

/// What a step does, in its order; step.cpp has the loops.
enum class Phase : std::uint32_t {
  kForces,      ///< The state with the forces and commands of the tick; nothing is computed yet.
  kPairs,       ///< Pairs of shapes whose boxes overlap.
  kCollide,     ///< Contacts with their manifolds.
  kIslands,     ///< Who is awake.
  kColors,      ///< The order in which contacts and joints are solved.
  kPrepare,     ///< Motions, masses, contact and joint rows at the start of the tick.
  kEvaluate,    ///< Rows at the present poses.
  kVelocities,  ///< Gravity, forces and damping of a substep.
  kBounce,
  kWarmStart,
  kSweep,      ///< One sweep of impulses.
  kPseudo,     ///< All sweeps of pseudo-velocities.
  kPositions,  ///< Positions by velocities.
  kCorrect,    ///< One sweep of position corrections.
  kRelax,      ///< One sweep of impulses without a bias.
  kProject,    ///< A whole substep of XPBD.
  kStore,      ///< Impulses into the contacts.
  kStop,       ///< Fast bodies stopped where they meet something.
  kFinalize,   ///< The state of the next tick, ...
  kRest,       ///< ... with who falls asleep, ...
  kParticles,  ///< ... and with particles moved.
  kState,      ///< A state between two ticks: World::trace_state.
};
inline constexpr std::uint32_t kPhases = 22;

/// "sweep"; what a trace prints and a command line takes.
const char* phase_name(Phase phase);

/// When in a tick; kNone where a phase is in no substep or in no loop of sweeps.
struct TracePoint {
  Phase phase = Phase::kState;
  std::uint32_t substep = kNone;
  std::uint32_t sweep = kNone;
  friend bool operator==(const TracePoint&, const TracePoint&) = default;
};

/// A body, contact, joint or other record as a phase has left it.
struct TracedObject {
  std::string name;  ///< "contact 7": by slot, or by place in the tick's list of contacts.
  std::uint64_t digest = 0;
  friend bool operator==(const TracedObject&, const TracedObject&) = default;
};

struct TracedField {
  std::string object;
  std::string name;   ///< "points[0].tangent_impulse[1]"
  std::string value;  ///< Decimal, and the bits in hexadecimal.
  friend bool operator==(const TracedField&, const TracedField&) = default;
};

struct TracedPhase {
  TracePoint at;
  std::uint64_t digest = 0;  ///< Over all objects, with -0 and every NaN made one.
  std::vector<TracedObject> objects;
  std::vector<TracedField> fields;
  friend bool operator==(const TracedPhase&, const TracedPhase&) = default;
};

/// What every phase of a step has left, in the order of the step. Like the state it depends neither
/// on lanes nor on workers: contacts and joints are listed by slot, not by block and colour.
struct StepTrace {
  /// Where it is set, it is called with `listener_user` after each phase, and nothing is written
  /// down: a host reads its clock there. The solver itself knows none.
  void (*listener)(void* user, const TracePoint& at) = nullptr;
  void* listener_user = nullptr;

  bool wants_objects = false;  ///< Fill in `objects` of each phase.
  std::string wants_fields;    ///< Fill in `fields` of the object of this name.
  std::vector<TracedPhase> phases;
};

/// Whether somebody writes the step down, and so has to see what a step may otherwise pass by.
inline bool is_written(const StepTrace* trace) {
  return trace != nullptr && trace->listener == nullptr;
}

}  // namespace cycloid::solver
