#include <bit>

#include "solver/bodies/body_kernels.hpp"
#include "solver/lane_widths.hpp"
#include "solver/stages/fast_bodies.hpp"
#include "solver/stages/in_chunks.hpp"
#include "solver/stages/may_touch.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// Whether it moves so little in a tick that `is_fast` is false. Most do, and to be sure of it is
/// cheaper than its way.
static bool is_slow(const StepContext<3>& context, const Body<3>& body, const Motion<3>& motion) {
  const Spin<3> spun = context.tick_s * motion.spin;
  if (dot(spun, spun) > 9.0f) return false;
  const float way = length(motion.delta_position) + body.extent * turn_bound(motion.delta_rotation);
  return 1.001f * way < 0.5f * body.thickness;
}

/// Whether it moves so far in a tick that it could pass through something, or over its corner. What
/// flies that far is asked for no turn.
template <int D>
static bool is_fast(const StepContext<D>& context, const Body<D>& body, const Motion<D>& motion) {
  if (!responds(body.kind) || body.extent == 0.0f) return false;
  const float flown = length(motion.delta_position);
  const float enough = 0.5f * body.thickness;
  return flown > enough || flown + body.extent * length(turn_in(context, motion)) > enough;
}

/// A bit for each of these bodies of which is_slow is not certain. @pre there are 64 at most.
static std::uint64_t moved_far(const StepContext<3>& context, const WorldState<3>& state,
                               std::span<const std::uint32_t> slots,
                               const StepScratch<3>& scratch) {
  std::uint64_t far = 0;
  for (std::size_t i = 0; i < slots.size(); ++i)
    if (!is_slow(context, state.bodies[slots[i]], scratch.motions[slots[i]]))
      far |= std::uint64_t{1} << i;
  return far;
}
static std::uint64_t moved_far(const StepContext<2>& context, const WorldState<2>& state,
                               std::span<const std::uint32_t> slots,
                               const StepScratch<2>& scratch) {
  return at_width(widest_lanes(context.lanes), [&]<int W>() {
    return BodyKernels<W>::moved_far(context.tick_s, state.bodies.data(), slots.data(),
                                     static_cast<int>(slots.size()), scratch.motions.data());
  });
}

template <int D>
static void list_fast(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                      StepScratch<D>& scratch) {
  const std::vector<std::uint32_t>& awake = scratch.awake_bodies;
  scratch.fast_bodies.clear();
  const auto list = [&](Range range, std::vector<FastBody>& fast) {
    for (int begin = range.begin; begin < range.end; begin += kPairGrain) {
      const auto slots = std::span(awake).subspan(
          static_cast<std::size_t>(begin),
          static_cast<std::size_t>(std::min(kPairGrain, range.end - begin)));
      std::uint64_t far = moved_far(context, state, slots, scratch);
      for (; far != 0; far &= far - 1) {
        const std::uint32_t slot = slots[static_cast<std::size_t>(std::countr_zero(far))];
        if (is_fast(context, state.bodies[slot], scratch.motions[slot])) fast.push_back({slot});
      }
    }
  };
  list_in_chunks(workers, static_cast<int>(awake.size()), kPairGrain, scratch.fast_chunks,
                 scratch.fast_bodies, list);
}

/// Of the speed of what is pushed, how much at the least its contact shares.
static constexpr float kPushShare = 0.25f;

/// Lists which fast bodies are pushed along in these places of the live contacts: through a contact
/// that carries an impulse and itself moves on, along its normal, at a good part of the body's
/// speed; and farther than contacts are made, so that to lose that way matters. Cards, of which the
/// slowest is fast, would otherwise pass through one another.
template <int D>
static void list_pushed(const StepContext<D>& context, const StepScratch<D>& scratch, Range places,
                        std::vector<std::uint32_t>& pushed) {
  const float near = context.tuning.speculative_distance;
  const auto list = [&](std::uint32_t shape, float along, const Vec<D>& velocity) {
    if (scratch.fast_of_shape[shape] == 0) return;
    if (context.tick_s * along > near && along > kPushShare * length(velocity))
      pushed.push_back(scratch.fast_of_shape[shape] - 1);
  };
  for (int place = places.begin; place < places.end; ++place) {
    const LiveContact<D>& live = scratch.live[static_cast<std::size_t>(place)];
    const Contact<D>& contact = scratch.contacts[live.contact];
    const std::uint32_t a = contact.shape_a;
    const std::uint32_t b = contact.shape_b;
    if ((scratch.fast_of_shape[a] | scratch.fast_of_shape[b]) == 0) continue;
    float impulse = 0.0f;
    for (std::uint32_t p = 0; p < contact.point_count; ++p)
      impulse += contact.points[p].normal_impulse;
    if (!(impulse > 0.0f)) continue;
    const Manifold<D>& manifold = live.manifold;
    const auto velocity_of = [&](std::uint32_t body, const Vec<D>& arm) {
      const Motion<D>& motion = scratch.motions[body];
      return motion.velocity + spin_cross(motion.spin, arm);
    };
    const Vec<D> velocity_a = velocity_of(live.body_a, manifold.points[0].anchor_a);
    const Vec<D> velocity_b =
        velocity_of(live.body_b, anchor_b_of(manifold.points[0], live.between));
    const float along_a = dot(manifold.normal, velocity_a);
    const float along_b = dot(manifold.normal, velocity_b);
    list(b, min(along_a, along_b), velocity_b);
    list(a, min(-along_a, -along_b), velocity_a);
  }
}

/// Marks the fast bodies that another one pushes along.
template <int D>
static void mark_pushed(const StepContext<D>& context, Workers& workers, StepScratch<D>& scratch) {
  std::vector<std::uint32_t>& pushed = scratch.looking;
  pushed.clear();
  list_in_chunks(workers, static_cast<int>(scratch.live.size()), kLookGrain, scratch.slot_chunks,
                 pushed, [&](Range places, std::vector<std::uint32_t>& list) {
                   list_pushed(context, scratch, places, list);
                 });
  for (const std::uint32_t place : pushed) scratch.fast_bodies[place].is_pushed = true;
}

template <int D>
static void list_shapes_of_fast(const WorldState<D>& state, Workers& workers,
                                StepScratch<D>& scratch) {
  scratch.fast_of_shape.assign(state.shapes.size(), 0);
  workers.parallel_for(static_cast<int>(scratch.fast_bodies.size()), kBodyGrain, [&](Range range) {
    for (int place = range.begin; place < range.end; ++place) {
      const std::uint32_t slot = scratch.fast_bodies[static_cast<std::size_t>(place)].slot;
      for (std::uint32_t s = state.bodies[slot].first_shape; s != kNone; s = state.shapes[s].next)
        scratch.fast_of_shape[s] = static_cast<std::uint32_t>(place) + 1;
    }
  });
}

/// The bodies that move so far in the tick that they could pass through something, or over its
/// corner; which of them something pushes on; and their shapes.
///
/// Reads motions, bodies, who is awake, contacts and their impulses; writes the fast bodies, by
/// slot, and whose shapes are theirs, where there are any. Each body by itself.
template <int D>
void list_fast_bodies(const StepContext<D>& context, const WorldState<D>& state, Workers& workers,
                      StepScratch<D>& scratch) {
  list_fast(context, state, workers, scratch);
  if (scratch.fast_bodies.empty()) return;
  list_shapes_of_fast(state, workers, scratch);
  mark_pushed(context, workers, scratch);
}

template void list_fast_bodies(const StepContext<2>&, const WorldState<2>&, Workers&,
                               StepScratch<2>&);
template void list_fast_bodies(const StepContext<3>&, const WorldState<3>&, Workers&,
                               StepScratch<3>&);

}  // namespace cycloid::solver
