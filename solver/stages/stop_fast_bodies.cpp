#include <algorithm>
#include <utility>

#include "solver/queries/separation.hpp"
#include "solver/queries/time_of_impact.hpp"
#include "solver/stages/may_touch.hpp"
#include "solver/stages/stages.hpp"
#include "solver/trig.hpp"

namespace cycloid::solver {

/// A body's way in this tick. Above half a turn the final rotation no longer says how far it
/// turned; the spin does.
template <int D>
static BodySweep<D> sweep_of(const StepContext<D>& context, const WorldState<D>& state,
                             const StepScratch<D>& scratch, std::uint32_t body) {
  const Motion<D>& motion = scratch.motions[body];
  const Spin<D> spun = context.tick_s * motion.spin;
  const bool winds = dot(spun, spun) > kPi * kPi;
  return {{state.bodies[body].position, state.bodies[body].rotation},
          motion.delta_position,
          winds ? spun : turn_of(motion.delta_rotation)};
}

/// The most that a rotation may turn, rad, or more: without a function of trigonometry.
static float turn_bound(const Rotation<2>& q) {
  return q[0] >= 0.0f ? 1.6f * abs(q[1]) + 1.0e-5f : 2.0f * kPi;
}
static float turn_bound(const Rotation<3>& q) {
  return q[3] >= 0.0f ? 3.2f * length(Vec<3>{{q[0], q[1], q[2]}}) + 1.0e-5f : 2.0f * kPi;
}

/// Whether it moves so little in a tick that `is_fast` is false. Most do, and to be sure of it is
/// cheaper than its way.
template <int D>
static bool is_slow(const StepContext<D>& context, const Body<D>& body, const Motion<D>& motion) {
  const Spin<D> spun = context.tick_s * motion.spin;
  if (dot(spun, spun) > 9.0f) return false;
  const float way = length(motion.delta_position) + body.extent * turn_bound(motion.delta_rotation);
  return 1.001f * way < 0.5f * body.thickness;
}

/// Whether it moves so far in a tick that it could pass through something, or over its corner.
template <int D>
static bool is_fast(const Body<D>& body, const BodySweep<D>& sweep) {
  if (!responds(body.kind) || body.extent == 0.0f) return false;
  const float way = length(sweep.translation) + body.extent * length(sweep.turn);
  return way > 0.5f * body.thickness;
}

/// Whether a body stays farther than `reach` from another, whose way is not known but for where it
/// leads: it decides most pairs that are near and do not meet. Then no shape of one meets any of
/// the other.
template <int D>
static bool stays_clear(const Vec<D>& start_a, const Vec<D>& translation_a, const BodySweep<D>& b,
                        float reach) {
  const Vec<D> from = b.start.position - start_a;
  const Vec<D> way = b.translation - translation_a;
  const float square = dot(way, way);
  const float fraction = square > 0.0f ? clamp(-dot(from, way) / square, 0.0f, 1.0f) : 0.0f;
  const Vec<D> nearest = from + fraction * way;
  return dot(nearest, nearest) > reach * reach;
}

/// Whether a body stays farther than its reach above a half-space that rests, at both ends of its
/// way and so between them.
template <int D>
static bool stays_above(const BodySweep<D>& ground, const Shape<D>& half_space,
                        const BodySweep<D>& sweep, float reach) {
  if (!(dot(ground.translation, ground.translation) == 0.0f) ||
      !(dot(ground.turn, ground.turn) == 0.0f))
    return false;
  const Vec<D> normal = rotate(ground.start.rotation, half_space.normal);
  const Vec<D> from = sweep.start.position - ground.start.position;
  const float height = dot(normal, from) - half_space.offset;
  return height + min(dot(normal, sweep.translation), 0.0f) > reach;
}

/// How far from what it meets a body stops, m: near enough that the next tick finds the contact,
/// far enough that this one did not touch, and little beside its thickness. A card that stops as
/// far from the next one as it is thick is held up by nothing, and its house falls.
static float target_of(const Tuning& tuning, float thickness) {
  const float far = min(0.5f * tuning.slop, 0.5f * thickness);
  return min(max(far, 1.0e-4f), max(tuning.speculative_distance, 1.0e-4f));
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

/// Whether the contacts of two shapes have kept them apart: they end the tick overlapping by less
/// than the tolerance, m, after a way on which neither could have passed through the other. What
/// contacts have not seen, a corner that comes round while another one touches, would show as
/// overlap. Without this a pair that touches and turns takes the most steps of all, and is stopped
/// on a way that the contact solver has already found. With four times the tolerance a card house
/// loses two cards.
template <int D>
static bool contacts_hold(const WorldState<D>& state, const Shape<D>& a,
                          const BodySweep<D>& sweep_a, const Shape<D>& b,
                          const BodySweep<D>& sweep_b, float tolerance) {
  if (a.kind == ShapeKind::kSegment || a.kind == ShapeKind::kTriangle) return false;
  const Body<D>& body_a = state.bodies[a.body];
  const Body<D>& body_b = state.bodies[b.body];
  const float way = length(sweep_b.translation - sweep_a.translation) +
                    body_a.extent * length(sweep_a.turn) + body_b.extent * length(sweep_b.turn);
  if (a.kind != ShapeKind::kHalfSpace && way > body_a.thickness + body_b.thickness) return false;
  const Vec<D> from_a =
      sweep_b.start.position + sweep_b.translation - (sweep_a.start.position + sweep_a.translation);
  const Separation<D> end =
      separation_of(core_of(a, pose_at(sweep_a, 1.0f).rotation, Vec<D>::zero(), state.polyhedra),
                    core_of(b, pose_at(sweep_b, 1.0f).rotation, from_a, state.polyhedra));
  return end.distance > -tolerance;
}

/// The fraction of the tick at which one shape meets another that it did not touch at the start.
/// Those that touched belong to the contact solver.
template <int D>
static float fraction_of(const StepContext<D>& context, const WorldState<D>& state,
                         const StepScratch<D>& scratch, std::uint32_t shape, std::uint32_t other,
                         const BodySweep<D>& sweep) {
  const Shape<D>& a = state.shapes[other];
  const Shape<D>& b = state.shapes[shape];
  const float target = target_of(context.tuning, state.bodies[b.body].thickness);
  // A hundredth more than what counts as a touch covers all rounding.
  const float reach =
      1.01f * (state.bodies[a.body].extent + state.bodies[b.body].extent + target) + target;
  if (a.vertex_count > 0 && stays_clear(state.bodies[a.body].position,
                                        scratch.motions[a.body].delta_position, sweep, reach))
    return 1.0f;
  const BodySweep<D> other_sweep = sweep_of(context, state, scratch, a.body);
  if (a.kind == ShapeKind::kHalfSpace && stays_above(other_sweep, a, sweep, reach)) return 1.0f;
  const float tolerance = 0.25f * target;
  if (has_contact(scratch, shape, other) &&
      contacts_hold(state, a, other_sweep, b, sweep, tolerance))
    return 1.0f;
  const Impact impact =
      time_of_impact(a, other_sweep, b, sweep, target, tolerance, state.polyhedra);
  return impact.hit && impact.fraction > 0.0f ? impact.fraction : 1.0f;
}

template <int D>
static float earliest_impact(const StepContext<D>& context, const WorldState<D>& state,
                             const StepScratch<D>& scratch, std::uint32_t body,
                             const BodySweep<D>& sweep) {
  float first = 1.0f;
  Vec<D> reach;
  for (float& value : reach.v) value = state.bodies[body].extent;
  Bounds<D> bounds{sweep.start.position - reach, sweep.start.position + reach};
  bounds = merged(bounds, {bounds.lower + sweep.translation, bounds.upper + sweep.translation});
  for (std::uint32_t s = state.bodies[body].first_shape; s != kNone; s = state.shapes[s].next) {
    const auto meet = [&](std::uint32_t other) {
      if (!may_touch(state, scratch, s, other)) return;
      first = min(first, fraction_of(context, state, scratch, s, other, sweep));
    };
    for (const std::uint32_t half_space : scratch.unbounded) meet(half_space);
    scratch.static_tree.query(bounds, [&](int rank) { meet(scratch.static_tree.leaf(rank).id); });
    scratch.pair_cache.fat.query(bounds, [&](std::uint32_t other) {
      if (overlaps(scratch.pair_cache.boxes[other], bounds)) meet(other);
    });
  }
  return first;
}

/// Continuous collision: a fast body ends the tick where it first meets what it did not touch
/// before. Its velocity stays; the contact of the next tick answers to it. The rest of its way is
/// lost.
///
/// Reads motions, shapes, the tree and the boxes of find_pairs; writes first the stop of each body
/// that is awake, from the ways of all as the sweeps left them, then the deltas. So any split into
/// ranges gives the same bits.
template <int D>
void stop_fast_bodies(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                      StepScratch<D>& scratch) {
  if (context.tuning.continuous == 0) return;
  const std::vector<std::uint32_t>& bodies = scratch.awake_bodies;
  scratch.stops.assign(bodies.size(), 1.0f);
  workers.parallel_for(static_cast<int>(bodies.size()), kPairGrain, [&](Range range) {
    for (auto i = static_cast<std::size_t>(range.begin); i < static_cast<std::size_t>(range.end);
         ++i) {
      const Body<D>& body = state.bodies[bodies[i]];
      if (is_slow(context, body, scratch.motions[bodies[i]])) continue;
      const BodySweep<D> sweep = sweep_of(context, state, scratch, bodies[i]);
      if (is_fast(body, sweep))
        scratch.stops[i] = earliest_impact(context, state, scratch, bodies[i], sweep);
    }
  });
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (scratch.stops[i] == 1.0f) continue;
    const BodySweep<D> sweep = sweep_of(context, state, scratch, bodies[i]);
    Motion<D>& motion = scratch.motions[bodies[i]];
    motion.delta_position = scratch.stops[i] * sweep.translation;
    motion.delta_rotation = rotation_by(scratch.stops[i] * sweep.turn);
  }
}

template void stop_fast_bodies(const StepContext<2>&, const WorldState<2>&, Workers&,
                               StepScratch<2>&);
template void stop_fast_bodies(const StepContext<3>&, const WorldState<3>&, Workers&,
                               StepScratch<3>&);

}  // namespace cycloid::solver
