#include <algorithm>

#include "solver/constraints/joint_row.hpp"
#include "solver/least_first.hpp"
#include "solver/stages/counting_sort.hpp"
#include "solver/stages/fast_bodies.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Over the slop, how far what is jointed to a body that stops may part from it. With less, people
/// who are thrown together keep the gaps that their joints were about to close: of 32 with motors,
/// elastic, 162 of 200 runs stand with 2 instead of 182 with 3 and 192 without this. With 4 people
/// who fall part by a twentieth more.
static constexpr float kPartOfSlops = 3.0f;

/// Lists the joint rows of each body. @returns whether one of the stopped has any.
template <int D>
static bool list_rows_of_bodies(StepScratch<D>& scratch) {
  const std::vector<JointRow<D>>& rows = scratch.joint_rows;
  scratch.rows_of.resize(2 * rows.size());
  counting_sort(
      2 * rows.size(), scratch.motions.size(),
      [&](std::size_t i) { return i % 2 == 0 ? rows[i / 2].body_a : rows[i / 2].body_b; },
      scratch.rows_of_ends,
      [&](std::size_t i, std::size_t place) {
        scratch.rows_of[place] = static_cast<std::uint32_t>(i / 2);
      });
  return std::any_of(scratch.stops.begin(), scratch.stops.end(), [&](const Stop& stop) {
    const Range of_body = range_of_key(scratch.rows_of_ends, stop.slot);
    return of_body.begin != of_body.end;
  });
}

/// Where an anchor of a body is when it stops, from where the body's centre began the tick, m.
template <int D>
static Vec<D> anchor_after(const StepContext<D>& context, const WorldState<D>& state,
                           const StepScratch<D>& scratch, const Stop& stop, const Vec<D>& anchor) {
  const Motion<D>& motion = scratch.motions[stop.slot];
  const Vec<D> arm = rotate(state.bodies[stop.slot].rotation, anchor);
  if (stop.fraction == 1.0f) return motion.delta_position + rotate(motion.delta_rotation, arm);
  return stop.fraction * motion.delta_position +
         rotate(rotation_by(stop.fraction * turn_in(context, motion)), arm);
}

/// The fraction of the tick after which the other body of a joint stops with one that does: as far
/// back on its way, but not before that one, as brings it nearest. 1 where they do not part by more
/// than may be, or going back would not bring it nearer: its way may have been to close the joint.
template <int D>
static float stop_with(const StepContext<D>& context, const WorldState<D>& state,
                       const StepScratch<D>& scratch, const JointRow<D>& row, const Stop& stop) {
  const Joint<D>& joint = state.joints[row.joint];
  const bool is_a = row.body_a == stop.slot;
  const std::uint32_t other = is_a ? row.body_b : row.body_a;
  const Vec<D>& anchor = is_a ? joint.anchor_b : joint.anchor_a;
  const auto after = [&](float fraction) {
    return anchor_after<D>(context, state, scratch, {other, fraction}, anchor);
  };
  const Vec<D> offset = is_a ? row.centre_offset : -row.centre_offset;
  const Vec<D> held =
      anchor_after(context, state, scratch, stop, is_a ? joint.anchor_a : joint.anchor_b);
  const Vec<D> apart = offset + (after(1.0f) - held);
  const Vec<D> way = after(1.0f) - after(stop.fraction);
  const float gap = length(apart);
  const float may_be = kPartOfSlops * context.tuning.slop;
  const float along = dot(apart, way);
  if (!(gap > may_be) || !(along > 0.0f)) return 1.0f;
  const float back = min(along / dot(way, way), 1.0f) * (1.0f - may_be / gap);
  return 1.0f - back * (1.0f - stop.fraction);
}

/// Whether a joint makes the other body stop: it holds a point, rigidly, and that body can yield.
template <int D>
static bool carries_stop(const StepScratch<D>& scratch, const JointRow<D>& row,
                         std::uint32_t other) {
  return row.holds_point && !row.is_spring[0] && scratch.is_stopped[other] == 0 &&
         scratch.masses[other].inverse_mass > 0.0f;
}

/// Puts in line what joints hold to a body that stops.
template <int D>
static void ask_neighbours(const StepContext<D>& context, const WorldState<D>& state,
                           const Stop& stop, StepScratch<D>& scratch) {
  const Range of_body = range_of_key(scratch.rows_of_ends, stop.slot);
  for (int i = of_body.begin; i < of_body.end; ++i) {
    const std::uint32_t place = scratch.rows_of[static_cast<std::size_t>(i)];
    const JointRow<D>& row = scratch.joint_rows[place];
    const std::uint32_t other = row.body_a == stop.slot ? row.body_b : row.body_a;
    if (!carries_stop(scratch, row, other)) continue;
    const float fraction = stop_with(context, state, scratch, row, stop);
    if (fraction < 1.0f) put_in_line<Stop>({other, fraction}, scratch.coming_stops);
  }
}

/// What joints hold to a body that stops early stops with it, as far as the joint would part. Alone
/// it would be left behind by all the way that it loses, which is a decimetre where people fall.
///
/// Reads motions, masses, joints and the stops of fast bodies; writes all stops. From the earliest
/// on, and each body once, at the earliest that any neighbour asks of it: so the order of joints
/// does not show (Dijkstra 1959, with fractions for lengths). Serial.
template <int D>
void spread_stops(const StepContext<D>& context, const WorldState<D>& state,
                  StepScratch<D>& scratch) {
  std::vector<Stop>& stops = scratch.stops;
  stops.clear();
  for (const FastBody& fast : scratch.fast_bodies)
    if (fast.stop < 1.0f) stops.push_back({fast.slot, fast.stop});
  if (stops.empty() || scratch.joint_rows.empty() || !list_rows_of_bodies(scratch)) return;
  scratch.is_stopped.resize(scratch.motions.size(), 0);
  std::vector<Stop>& coming = scratch.coming_stops;
  coming.clear();
  for (const Stop& stop : stops) put_in_line(stop, coming);
  stops.clear();
  while (!coming.empty()) {
    const Stop stop = take_least(coming);
    if (scratch.is_stopped[stop.slot] != 0) continue;
    scratch.is_stopped[stop.slot] = 1;
    stops.push_back(stop);
    ask_neighbours(context, state, stop, scratch);
  }
  for (const Stop& stop : stops) scratch.is_stopped[stop.slot] = 0;
}

template void spread_stops(const StepContext<2>&, const WorldState<2>&, StepScratch<2>&);
template void spread_stops(const StepContext<3>&, const WorldState<3>&, StepScratch<3>&);

}  // namespace cycloid::solver
