#pragma once

#include <cstdint>
#include <optional>

namespace cycloid::accuracy {

/// Of many sizes >= 0; all 0 of none.
struct Spread {
  double max = 0.0;
  double rms = 0.0;  ///< Root of the mean square.
  double p95 = 0.0;  ///< The smallest size that 95 % of them do not exceed.
};

/// How wrong a world is. What a scene does not have, or nobody can say, is absent: it is never 0
/// for that. "Steady" is the last second of the run, or its second half where that is shorter, and
/// the one tick of a run of one; "transient" is what comes before. Each is absent where the run
/// ended before a tick of it was looked at. Taken after the ticks of `MeasureOptions::every`.
/// Sources: Facchinei and Pang 2003, 1.5; Le Lidec et al. 2023, arXiv 2304.06372 (residuals); Erez,
/// Tassa, Todorov 2015, "Simulation Tools for Model-Based Robotics" (energy, momentum,
/// consistency); Boeing and Braunl 2007, "Evaluation of real-time physics simulation systems"
/// (penetration, joints).
struct Metrics {
  /// Of the contact problem of the last substep of each measured tick (contact_problem.hpp): the
  /// natural map over the size of impulses, no unit, and the work against the bounds, J; the worst
  /// of the steady time. Absent where the method keeps no impulses (xpbd), or the scene has no row.
  std::optional<double> natural_map;
  std::optional<double> complementarity_j;
  /// At the end, against the direct solution in float64 of that problem, no unit: per impulse, only
  /// where the impulses are unique; what they do to the bodies; the same in the norm of kinetic
  /// energy. Absent beyond `direct_rows_max` rows, where the reference finds no solution, and where
  /// a contact of space slips, since the reference has no round cone.
  std::optional<double> impulse_error;
  std::optional<double> wrench_error;
  std::optional<double> velocity_error;
  /// Depth of every pair of shapes that may collide and do overlap, m, from poses alone.
  std::optional<Spread> penetration_transient_m;
  std::optional<Spread> penetration_steady_m;
  /// How far every rigid joint is from where it belongs, m, from poses alone: peers::gaps_of, which
  /// says of which joints. Absent without such joints.
  std::optional<Spread> gap_transient_m;
  std::optional<Spread> gap_steady_m;
  /// Kinetic energy and that of gravity: the most of any tick over that at the start, J, not below
  /// 0. Springs, motors and seats may bring some in.
  std::optional<double> energy_gained_j;
  /// The same over the largest kinetic energy of the run and what lifts all bodies by 0.1 m; no
  /// unit. Absent where something besides gravity may bring energy in: the script of a seat, a
  /// character, a spring, a motor, a user's joint, a body that moves regardless.
  std::optional<double> energy_gained_share;
  /// The furthest that the sum of momenta strays from where gravity takes it, over the largest sum
  /// of their sizes in the run; no unit. Absent where something holds the bodies from outside: a
  /// body that does not move by itself, damping, the script of a seat, a character, a pulley, a
  /// rack (a gear with an axis of the world) or a user's joint. Angular: about the common centre of
  /// mass; also absent where gravity acts on some more than on others, where a body does not turn,
  /// and with gears, whose axles the world bears.
  std::optional<double> momentum_drift;
  std::optional<double> angular_momentum_drift;
  /// The most by which friction exceeds its cone, over the largest normal impulse; no unit. Absent
  /// where the method keeps no impulses.
  std::optional<double> cone_excess;
  /// How far contacts creep that stick in all of the steady time: the size of the sum of their
  /// tangential motion, the largest, mm per minute. Absent where nothing sticks so long.
  std::optional<double> stick_drift_mm_min;
  /// Root mean square of the bodies' speeds in the steady time, m/s; of a scene that comes to rest
  /// it is jitter. Absent without bodies that forces move.
  std::optional<double> jitter_m_s;
  /// The farthest that a body is from where it was at the start, m, at the last tick that was
  /// looked at: of a scene that should stand, how far it has not. Overlap is no sign of that: what
  /// has fallen overlaps nothing. Absent without bodies that forces move.
  std::optional<double> moved_m;
  /// Distance between where the bodies are and where the same method takes them in steps 16 times
  /// smaller: root mean square over bodies and ticks of the first second, m. Absent unless asked.
  std::optional<double> consistency_m;
};

/// What a tick costs.
struct Price {
  double rows_per_tick = 0.0;     ///< Constraint rows that all sweeps of a tick solve, on average.
  std::uint64_t state_bytes = 0;  ///< Of the exact state at the end, encoded.
  double ns_per_tick = 0.0;       ///< Processor time; the median of the repeats; 0: not timed.
};

}  // namespace cycloid::accuracy
