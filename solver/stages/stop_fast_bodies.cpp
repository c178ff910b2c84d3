#include <algorithm>
#include <utility>

#include "solver/bodies/turn_freely.hpp"
#include "solver/collision/bounds.hpp"
#include "solver/queries/separation.hpp"
#include "solver/stages/fast_bodies.hpp"
#include "solver/stages/may_touch.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// One of two shapes that may meet, and its body's way.
template <int D>
struct Traveller {
  std::uint32_t shape;
  std::uint32_t body;
  const Body<D>& start;
  const Motion<D>& motion;
};

template <int D>
static Traveller<D> traveller(const WorldState<D>& state, const StepScratch<D>& scratch,
                              std::uint32_t shape) {
  const std::uint32_t body = state.shapes[shape].body;
  return {shape, body, state.bodies[body], scratch.motions[body]};
}

/// Whether two bodies stay farther apart than `reach` with their centres. Then no shape of one
/// meets any of the other; it decides most pairs that are near and do not meet.
template <int D>
static bool stays_clear(const Traveller<D>& a, const Traveller<D>& b, float reach) {
  const Vec<D> from = b.start.position - a.start.position;
  const Vec<D> way = b.motion.delta_position - a.motion.delta_position;
  const float square = dot(way, way);
  const float fraction = square > 0.0f ? clamp(-dot(from, way) / square, 0.0f, 1.0f) : 0.0f;
  const Vec<D> nearest = from + fraction * way;
  return dot(nearest, nearest) > reach * reach;
}

/// Whether a body stays farther than its reach above a half-space, which rests: at both ends of its
/// way and so between them.
template <int D>
static bool stays_above(const Traveller<D>& ground, const Shape<D>& half_space,
                        const Traveller<D>& body, float reach) {
  const Vec<D> normal = rotate(ground.start.rotation, half_space.normal);
  const Vec<D> from = body.start.position - ground.start.position;
  const float height = dot(normal, from) - half_space.offset;
  return height + min(dot(normal, body.motion.delta_position), 0.0f) > reach;
}

/// Whether the centre of a body stays farther than its reach beside the box of a long shape, as
/// seen from that shape's body, which turns; it leaves the chord of its way there by `bulge_of`.
/// Of those near a bar that turns fast most do. @pre neither is a half-space.
template <int D>
static bool stays_beside(const StepContext<D>& context, const Shape<D>& shape,
                         const Traveller<D>& bar, const Traveller<D>& other, float reach) {
  constexpr float kLong = 4.0f;
  if (bar.start.extent < kLong * bar.start.thickness || winds(context, bar.motion)) return false;
  const Vec<D> from = other.start.position - bar.start.position;
  const Vec<D> way = other.motion.delta_position - bar.motion.delta_position;
  const float bulge = bulge_of(turn_bound(bar.motion.delta_rotation), length(from), length(way));
  const Vec<D> begin = rotate_back(bar.start.rotation, from);
  const Vec<D> end =
      rotate_back(bar.start.rotation, rotate_back(bar.motion.delta_rotation, from + way));
  const Pose<D> own{Vec<D>::zero(), identity_rotation<D>()};
  // A hundredth more covers all rounding.
  const Bounds<D> box = bounds_of(shape, own, 1.01f * (reach + bulge));
  for (int i = 0; i < D; ++i) {
    if (max(begin[i], end[i]) < box.lower[i] || min(begin[i], end[i]) > box.upper[i]) return true;
  }
  return false;
}

template <int D>
static bool has_contact(const StepScratch<D>& scratch, std::uint32_t one, std::uint32_t other) {
  const std::pair<std::uint32_t, std::uint32_t> wanted = std::minmax(one, other);
  const auto found = std::lower_bound(
      scratch.contacts.begin(), scratch.contacts.end(), wanted,
      [](const Contact<D>& contact, const std::pair<std::uint32_t, std::uint32_t>& pair) {
        return std::pair(contact.shape_a, contact.shape_b) < pair;
      });
  return found != scratch.contacts.end() && found->shape_a == wanted.first &&
         found->shape_b == wanted.second;
}

/// Two shapes that may meet, and the ways of their bodies.
template <int D>
struct Meeting {
  const Shape<D>& a;
  const Shape<D>& b;
  BodySweep<D> sweep_a;
  BodySweep<D> sweep_b;
};

/// How far two shapes are apart at a fraction of their ways, m.
template <int D>
static float distance_at(const WorldState<D>& state, const Meeting<D>& meeting, float fraction) {
  const Pose<D> a = pose_at(meeting.sweep_a, fraction);
  const Pose<D> b = pose_at(meeting.sweep_b, fraction);
  return separation_of(core_of(meeting.a, a.rotation, Vec<D>::zero(), state.polyhedra),
                       core_of(meeting.b, b.rotation, b.position - a.position, state.polyhedra))
      .distance;
}

/// Whether the contacts of two shapes have kept them apart: they end the tick overlapping by less
/// than the tolerance, m, or by less than that more than at its start, after a way on which neither
/// could have passed through the other. What contacts have not seen, a corner that comes round
/// while another one touches, would show as overlap. Without this a pair that touches and turns
/// takes the most steps of all, and is stopped on a way that the contact solver has already found.
/// With four times the tolerance a card house loses two cards.
template <int D>
static bool contacts_hold(const WorldState<D>& state, const Meeting<D>& meeting, float tolerance) {
  const ShapeKind kind = meeting.a.kind;
  if (kind == ShapeKind::kSegment || kind == ShapeKind::kTriangle) return false;
  const Body<D>& a = state.bodies[meeting.a.body];
  const Body<D>& b = state.bodies[meeting.b.body];
  const float way = length(meeting.sweep_b.translation - meeting.sweep_a.translation) +
                    a.extent * length(meeting.sweep_a.turn) +
                    b.extent * length(meeting.sweep_b.turn);
  if (kind != ShapeKind::kHalfSpace && way > a.thickness + b.thickness) return false;
  const float end = distance_at(state, meeting, 1.0f);
  if (end > -tolerance) return true;
  return end > min(distance_at(state, meeting, 0.0f), 0.0f) - tolerance;
}

/// The fraction of the tick at which two shapes meet that did not touch at its start; 1 where they
/// do not. Those that touched belong to the contact solver. @pre the body of `b` may be stopped,
/// and that of `a` too if `a_stops`.
template <int D>
static float fraction_of(const StepContext<D>& context, const WorldState<D>& state,
                         const StepScratch<D>& scratch, std::uint32_t shape_a,
                         std::uint32_t shape_b, bool a_stops) {
  const Shape<D>& a = state.shapes[shape_a];
  const Shape<D>& b = state.shapes[shape_b];
  const Traveller<D> from = traveller(state, scratch, shape_a);
  const Traveller<D> to = traveller(state, scratch, shape_b);
  const float thin = to.start.thickness;
  const float target =
      stop_distance(context.tuning, a_stops ? min(from.start.thickness, thin) : thin);
  // A hundredth more than what counts as a touch covers all rounding.
  const float reach = 1.01f * (from.start.extent + to.start.extent + target) + target;
  if (a.kind == ShapeKind::kHalfSpace ? stays_above(from, a, to, reach)
                                      : stays_clear(from, to, reach))
    return 1.0f;
  if (a.kind != ShapeKind::kHalfSpace &&
      (stays_beside(context, a, from, to, to.start.extent + target) ||
       stays_beside(context, b, to, from, from.start.extent + target)))
    return 1.0f;
  const Meeting<D> meeting{a, b, sweep_of(context, state, scratch, a.body),
                           sweep_of(context, state, scratch, b.body)};
  const float tolerance = 0.25f * target;
  if (has_contact(scratch, shape_a, shape_b) && contacts_hold(state, meeting, tolerance))
    return 1.0f;
  const Impact impact =
      time_of_impact(a, meeting.sweep_a, b, meeting.sweep_b, target, tolerance, state.polyhedra);
  return impact.hit && impact.fraction > 0.0f ? impact.fraction : 1.0f;
}

/// The fast body of a shape where it may be stopped at the other, else null.
template <int D>
static FastBody* stopped_at(const WorldState<D>& state, StepScratch<D>& scratch,
                            std::uint32_t shape, std::uint32_t other) {
  const std::uint32_t place = place_if_stopped_at(state, scratch, shape, other);
  return place == 0 ? nullptr : &scratch.fast_bodies[place - 1];
}

static void keep_spin_in_body(const Body<2>&, const Rotation<2>&, Motion<2>&) {}
/// What tumbles keeps the spin that it has about its own axes, so that it keeps its energy: about
/// the axes of the world it would be that of another pose, and of a rod the spin about its length
/// would be one across it, a thousand times as strong.
/// @param whole  How far it would have turned.
static void keep_spin_in_body(const Body<3>& body, const Rotation<3>& whole, Motion<3>& motion) {
  if (keeps_its_spin(body)) return;
  const Rotation<3> end = compose(whole, body.rotation);
  const Rotation<3> stopped = compose(motion.delta_rotation, body.rotation);
  motion.spin = rotate(stopped, rotate_back(end, motion.spin));
}

/// Continuous collision: a fast body ends the tick where it first meets what it did not touch
/// before. Its velocity stays, and its spin in its own frame; the contact of the next tick answers
/// to them. The rest of its way is lost, and what is jointed to it ends with it (spread_stops). So
/// what is pushed on is stopped only at what does not yield: what pushes it would run over it, and
/// a crowd that is driven would end up in its driver.
///
/// Reads motions, shapes, joints and the meetings; writes the fraction of each meeting, from the
/// ways of all as the sweeps left them, then the least for each fast body, then those of what is
/// jointed to them, then the deltas. So neither the order of the meetings nor any split into ranges
/// shows in the bits.
template <int D>
void stop_fast_bodies(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                      StepScratch<D>& scratch) {
  if (context.tuning.continuous == 0) return;
  list_fast_bodies(context, state, workers, scratch);
  list_meetings(context, state, workers, scratch);
  const std::vector<ShapePair>& meetings = scratch.meetings;
  scratch.fractions.resize(meetings.size());
  workers.parallel_for(static_cast<int>(meetings.size()), kPairGrain, [&](Range range) {
    for (auto i = static_cast<std::size_t>(range.begin); i < static_cast<std::size_t>(range.end);
         ++i) {
      const auto [a, b] = meetings[i];
      const bool a_stops = stopped_at(state, scratch, a, b) != nullptr;
      const bool b_stops = stopped_at(state, scratch, b, a) != nullptr;
      scratch.fractions[i] = b_stops   ? fraction_of(context, state, scratch, a, b, a_stops)
                             : a_stops ? fraction_of(context, state, scratch, b, a, false)
                                       : 1.0f;
    }
  });
  for (std::size_t i = 0; i < meetings.size(); ++i) {
    if (scratch.fractions[i] == 1.0f) continue;
    const auto [a, b] = meetings[i];
    for (FastBody* fast : {stopped_at(state, scratch, a, b), stopped_at(state, scratch, b, a)})
      if (fast != nullptr) fast->stop = min(fast->stop, scratch.fractions[i]);
  }
  spread_stops(context, state, scratch);
  for (const Stop& stop : scratch.stops) {
    Motion<D>& motion = scratch.motions[stop.slot];
    const Rotation<D> whole = motion.delta_rotation;
    motion.delta_rotation = rotation_by(stop.fraction * turn_in(context, motion));
    keep_spin_in_body(state.bodies[stop.slot], whole, motion);
    motion.delta_position = stop.fraction * motion.delta_position;
  }
}

template void stop_fast_bodies(const StepContext<2>&, const WorldState<2>&, Workers&,
                               StepScratch<2>&);
template void stop_fast_bodies(const StepContext<3>&, const WorldState<3>&, Workers&,
                               StepScratch<3>&);

}  // namespace cycloid::solver
