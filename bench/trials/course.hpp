#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "bench/trials/motions.hpp"
#include "scenes/trials.hpp"
#include "solver/definitions.hpp"

namespace cycloid::trials {

/// A body of either dimension; in the plane z is 0 and the turn is about z.
struct BodyAt {
  std::array<double, 3> position{};  ///< Of the body's frame, world, m.
  std::array<double, 3> velocity{};  ///< m/s
  std::array<double, 3> spin{};      ///< rad/s; in the plane the first number.
  double angle = 0.0;                ///< rad in (-pi, pi], in the plane.
  double mass = 0.0;                 ///< kg; 0 does not move.
};

// By sums, products and roots alone, and the solver's own angles: so that the table of outcomes is
// the same on every machine, which no libm would keep.

double distance(const std::array<double, 3>& a, const std::array<double, 3>& b);

/// What came of a trial under one method. Measured from poses, velocities and masses alone, with
/// one ruler for every method; overlaps and gaps every fifth tick.
struct Course {
  bool ended = true;           ///< False: the world faulted, or a number was not finite.
  std::vector<BodyAt> start;   ///< By slot, which is the order of the scene.
  std::vector<BodyAt> end;     ///< Of the same bodies, without what was taken away.
  double overlap_max_m = 0.0;  ///< The deepest of the whole run.
  double overlap_end_m = 0.0;  ///< The deepest of the last second.
  std::vector<double> gaps_m;  ///< The widest of a rigid joint, at each measure.
  double gap_end_m = 0.0;      ///< The widest of a rigid joint in the last second.
  double energy_start_j = 0.0;
  double energy_end_j = 0.0;
  double turn_max_rad = 0.0;      ///< The farthest the last body was turned, in the plane.
  bool turned_over = false;       ///< The last body came to spin the other way about the axis of
                                  ///< its own that it spun about most.
  double momentum_error = 0.0;    ///< Of the angular momentum at the end, over that at the start.
  double speed_max_m_s = 0.0;     ///< Of any body in the whole run.
  double speed_late_m_s = 0.0;    ///< In the second half.
  double highest_late_m = -1e30;  ///< y of any body that moves, in the second half.
};

/// Watches one run of a trial, tick after tick, of whatever engine makes its states.
template <int D>
class CourseWatch {
 public:
  /// @param start  the state at tick 0; a body moves or not.
  CourseWatch(const solver::WorldState<D>& start, std::uint32_t ticks);
  /// After every tick. @returns false where a number is not finite; nothing more is watched then.
  bool look(const solver::WorldState<D>& state, std::uint32_t tick);
  /// What was seen. @param ended  whether every tick came to pass.
  Course finish(const solver::WorldState<D>& end, bool ended);

 private:
  std::uint32_t ticks_;
  solver::Body<D> first_;  ///< The last body, as it was at the start.
  Motions before_;
  Motions now_;
  Course course_;
};

/// Something that happens in a trial besides what its scene says; may be null.
template <int D>
using Act = void (*)(solver::World<D>& world, std::uint32_t tick);

/// Runs it from the start. @pre the scene is good, as `scenes::trials()` makes them.
Course run_scene(scenes::Scene scene, std::uint32_t ticks, const solver::Tuning& method,
                 Act<2> act);
Course run_trial(const scenes::Trial& trial, const solver::Tuning& method, Act<2> act);

}  // namespace cycloid::trials
