#include <cstring>
#include <span>

#include "solver/collision/collide.hpp"
#include "solver/stages/active_contacts.hpp"
#include "solver/stages/set_live.hpp"
#include "solver/stages/stages.hpp"
#include "solver/trace.hpp"
#include "solver/union_find.hpp"

namespace cycloid::solver {

static bool cone_states_rate(const ConeRow<2>&) {
  return false;
}
static bool cone_states_rate(const ConeRow<3>& rows) {
  return rows.has_cone_axis && rows.cone_axis.rate != 0.0f;
}

/// Whether time alone moves a user's joint as its function has it now. @pre it is registered.
template <int D>
static bool states_rate(const WorldState<D>& state, const StepScratch<D>& scratch,
                        const Joint<D>& joint) {
  const auto tick = static_cast<std::int64_t>(state.header.tick);
  const JointRows<D> rows = rows_between_ticks(
      state, joint, find_rows_function<D>(scratch.kept->user_rows, joint.user_kind),
      static_cast<float>(tick) * state.header.tick_s);
  for (int i = 0; i < rows.count; ++i)
    if (rows.rows[static_cast<std::size_t>(i)].rate != 0.0f) return true;
  return (rows.has_axis && rows.axis.rate != 0.0f) ||
         (rows.has_motor_axis && rows.motor_axis.rate != 0.0f) || cone_states_rate(rows);
}

/// Whether a joint moves what it holds on to by itself.
template <int D>
static bool drives(const WorldState<D>& state, const StepScratch<D>& scratch,
                   const Joint<D>& joint) {
  if (joint.kind == JointKind::kUser && states_rate(state, scratch, joint)) return true;
  const bool runs = joint.motor == MotorKind::kSpeed && joint.motor_speed != 0.0f;
  return runs || (joint.motor == MotorKind::kPosition && joint.drive_amplitude != 0.0f);
}

/// Joins the moving bodies of the tick's contacts and of every joint. What a driven joint or a
/// moving kinematic body holds on to stays awake. Without the contacts that rest, islands of
/// sleepers are not whole.
template <int D>
static void find_islands(const WorldState<D>& state, StepScratch<D>& scratch) {
  const std::vector<std::uint8_t>& active = scratch.kept->active_bodies.active;
  std::vector<std::uint32_t>& parent = scratch.islands;
  parent.resize(state.bodies.size());
  scratch.kept_awake.assign(state.bodies.size(), 0);
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = i;
  const auto link = [&](std::uint32_t a, std::uint32_t b, bool keep) {
    const bool a_moves = state.bodies[a].inverse_mass > 0.0f;
    const bool b_moves = state.bodies[b].inverse_mass > 0.0f;
    if (a_moves && b_moves) unite(parent, a, b);
    const bool pushed = (!a_moves && active[a] != 0) || (!b_moves && active[b] != 0);
    if (keep || pushed) scratch.kept_awake[a_moves ? a : b] = 1;
  };
  for (const Contact<D>& contact : scratch.contacts)
    link(state.shapes[contact.shape_a].body, state.shapes[contact.shape_b].body, false);
  for (const Joint<D>& joint : state.joints)
    if (joint.kind != JointKind::kFree)
      link(joint.body_a, joint.body_b, drives(state, scratch, joint));
}

/// Whether something that is active, or drives, holds on to a body that is asleep.
template <int D>
static bool wakes_somebody(const WorldState<D>& state, const StepScratch<D>& scratch) {
  if (scratch.bodies_asleep == 0) return false;
  const std::vector<std::uint8_t>& active = scratch.kept->active_bodies.active;
  const auto sleeps = [&](std::uint32_t body) {
    return active[body] == 0 && state.bodies[body].inverse_mass > 0.0f;
  };
  for (const LiveContact<D>& live : scratch.live) {  // Of all others both bodies do nothing.
    const std::uint32_t a = live.body_a;
    const std::uint32_t b = live.body_b;
    if (active[a] == active[b]) continue;
    if (sleeps(a) || sleeps(b)) return true;
  }
  for (const Joint<D>& joint : state.joints) {
    if (joint.kind == JointKind::kFree) continue;
    if (!sleeps(joint.body_a) && !sleeps(joint.body_b)) continue;
    if (active[joint.body_a] != active[joint.body_b] || drives(state, scratch, joint)) return true;
  }
  return false;
}

/// The contacts of bodies that woke have no manifold yet: their pairs were not looked for.
template <int D>
static void collide_woken(const StepContext<D>& context, const WorldState<D>& state,
                          StepScratch<D>& scratch) {
  const std::vector<LiveContact<D>>& before = scratch.live_before;
  scratch.live_before.assign(scratch.live.begin(), scratch.live.end());
  auto next = before.begin();
  MaterialPair materials(state.materials);
  scratch.live.clear();
  for (std::uint32_t i = 0; i < scratch.contacts.size(); ++i) {
    if (next != before.end() && next->contact == i) {
      scratch.live.push_back(*next++);
      continue;
    }
    const Contact<D>& contact = scratch.contacts[i];
    const Shape<D>& a = state.shapes[contact.shape_a];
    const Shape<D>& b = state.shapes[contact.shape_b];
    if (scratch.awake[a.body] == 0 && scratch.awake[b.body] == 0) continue;
    const Body<D>& body_a = state.bodies[a.body];
    const Body<D>& body_b = state.bodies[b.body];
    const PlacedPair<D> pair{{body_a.position, body_a.rotation},
                             {body_b.position, body_b.rotation},
                             contact.shape_a,
                             contact.shape_b,
                             context.tuning.speculative_distance};
    const Manifold<D> manifold = collide_held(state, pair);
    // Neither body has moved since the contact was kept, so its points and impulses still belong to
    // each other; a contact that is gone all the same is solved as one without points.
    if (manifold.point_count == 0 || manifold.point_count != contact.point_count) continue;
    set_live(state, pair, manifold, i, materials, scratch.live.emplace_back());
  }
}

/// Lists who is awake. A world may be full of bodies that are not, so eight are passed at a time.
template <int D>
static void list_awake(StepScratch<D>& scratch) {
  const std::vector<std::uint8_t>& awake = scratch.awake;
  const auto count = static_cast<std::uint32_t>(awake.size());
  scratch.awake_bodies.clear();
  for (std::uint32_t begin = 0; begin < count; begin += 8) {
    const std::uint32_t end = begin + 8 < count ? begin + 8 : count;
    std::uint64_t flags = 0;
    std::memcpy(&flags, awake.data() + begin, end - begin);
    if (flags == 0) continue;
    for (std::uint32_t i = begin; i < end; ++i)
      if (awake[i] != 0) scratch.awake_bodies.push_back(i);
  }
}

/// Wakes the islands that somebody active, or who drives, belongs to. Whether any body woke.
template <int D>
static bool wake_by_islands(const WorldState<D>& state, StepScratch<D>& scratch) {
  const std::size_t count = state.bodies.size();
  const std::vector<std::uint8_t>& active = scratch.kept->active_bodies.active;
  take_in_resting(state, scratch);
  find_islands(state, scratch);
  scratch.island_flags.assign(count, 0);
  for (std::uint32_t i = 0; i < count; ++i)
    if (active[i] != 0 || scratch.kept_awake[i] != 0)
      scratch.island_flags[root_of(scratch.islands, i)] = 1;
  bool woke = false;
  for (std::uint32_t i = 0; i < count; ++i) {
    if (!(state.bodies[i].inverse_mass > 0.0f)) continue;
    scratch.awake[i] = scratch.island_flags[root_of(scratch.islands, i)];
    if (scratch.awake[i] == 0 || active[i] != 0) continue;
    woke = true;
    --scratch.bodies_asleep;
  }
  return woke;
}

/// Islands of bodies that contacts and joints hold together, and which bodies are awake in this
/// tick: a sleeping island wakes as a whole when one that moves touches it. Where none does, who is
/// awake is who is active, and islands are not looked for; unless somebody writes the step down.
///
/// Reads contacts, joints, bodies and who is active; writes islands, awake, kept_awake, and, where
/// some woke, the contacts with those that rested, and which are live. Serial; a function of ids
/// alone.
template <int D>
void wake_islands(const StepContext<D>& context, const WorldState<D>& state,
                  StepScratch<D>& scratch) {
  const ActiveBodies& active = scratch.kept->active_bodies;
  scratch.awake.assign(active.active.begin(), active.active.end());
  scratch.awake.push_back(0);
  scratch.awake_bodies.assign(active.slots.begin(), active.slots.end());
  if (!is_written(scratch.kept->trace) && !wakes_somebody(state, scratch)) return;
  if (!wake_by_islands(state, scratch)) return;
  collide_woken(context, state, scratch);
  list_awake(scratch);
}

/// Counts the ticks at rest, slower than `least`, m/s. @returns how many there are.
template <int D>
static std::uint32_t count_rest(float least, float extent, BodyMotion<D>& body) {
  // What flies is far above it, and needs no root to be seen.
  const bool flies = dot(body.velocity, body.velocity) > 2.0f * (least * least);
  const bool rested =
      !flies && body.asleep == 0 && length(body.velocity) + extent * length(body.spin) < least;
  body.rest_ticks = rested ? body.rest_ticks + 1 : 0;  // Who has just woken starts anew.
  body.asleep = 0;
  return body.rest_ticks;
}

/// Counts the ticks at rest of bodies that are awake, and says of each with mass whether it is
/// restless. @returns whether any has rested for long.
template <int D>
static bool any_rests(const StepContext<D>& context, std::span<const std::uint32_t> slots,
                      MovedArray<Body<D>>& bodies, std::uint8_t* restless) {
  const float least = context.tuning.sleep_speed;
  const float long_ticks = context.tuning.sleep_s / context.tick_s;
  bool any = false;
  for (const std::uint32_t slot : slots) {
    if (bodies[slot].inverse_mass == 0.0f) continue;
    const std::uint32_t ticks = count_rest(least, bodies[slot].extent, bodies.moved(slot));
    const bool rests = static_cast<float>(ticks) >= long_ticks;
    restless[slot] = rests ? 0 : 1;
    any = any || rests;
  }
  return any;
}

/// Joins what contacts and joints hold together of those that have rested for long, and marks as
/// restless who is held by somebody that has not, or is kept awake: their islands stay awake,
/// whatever else belongs to them. So of a heap that players stir only what rests is joined.
/// @pre of who is awake and has mass it is known who is restless.
template <int D>
static void join_resting(const WorldState<D>& state, StepScratch<D>& scratch) {
  const ActiveBodies& bodies = scratch.kept->active_bodies;
  std::vector<std::uint8_t>& restless = scratch.island_flags;
  std::vector<std::uint32_t>& parent = scratch.islands;
  parent.resize(state.bodies.size());
  for (const std::uint32_t i : scratch.awake_bodies) parent[i] = i;
  const auto rests = [&](std::uint32_t i) {
    return bodies.has_mass[i] != 0 && scratch.awake[i] != 0 && restless[i] == 0;
  };
  const auto link = [&](std::uint32_t a, std::uint32_t b, bool keep) {
    const bool a_rests = rests(a);
    const bool b_rests = rests(b);
    if (a_rests && b_rests && !keep) return unite(parent, a, b);
    const auto is_free = [&](std::uint32_t other) {
      return !keep && bodies.has_mass[other] == 0 && bodies.active[other] == 0;
    };
    if (a_rests && !is_free(b)) restless[a] = 1;
    if (b_rests && !is_free(a)) restless[b] = 1;
  };
  for (const Contact<D>& contact : scratch.contacts)
    link(state.shapes[contact.shape_a].body, state.shapes[contact.shape_b].body, false);
  for (const Joint<D>& joint : state.joints)
    if (joint.kind != JointKind::kFree)
      link(joint.body_a, joint.body_b, drives(state, scratch, joint));
}

/// An island whose bodies have all been slower than sleep_speed for sleep_s falls asleep: its
/// velocities become zero, and until it wakes none of its state changes.
///
/// Reads motions, contacts, joints and awake; writes rest_ticks, asleep, islands where somebody has
/// rested for long, of bodies that fall asleep velocities, and who is asked in the next tick
/// whether it takes part: nobody else can have changed. Each body by itself; islands serially, in
/// slot order.
template <int D>
void rest_islands(const StepContext<D>& context, Workers& workers, StepScratch<D>& scratch,
                  WorldState<D>& state) {
  const auto takes_part = [&](std::uint32_t i) { return state.bodies[i].inverse_mass != 0.0f; };
  std::vector<std::uint8_t>& restless = scratch.island_flags;
  restless.resize(state.bodies.size());
  Tally resting;
  scratch.kept->active_bodies.ask_next(scratch.awake_bodies);
  workers.parallel_for(static_cast<int>(scratch.awake_bodies.size()), kBodyGrain, [&](Range range) {
    const std::span<const std::uint32_t> slots(scratch.awake_bodies.data() + range.begin,
                                               scratch.awake_bodies.data() + range.end);
    if (any_rests(context, slots, state.bodies, restless.data())) resting.add(1);
  });
  if (resting.sum() == 0 || !(context.tuning.sleep_s > 0.0f)) return;
  join_resting(state, scratch);
  for (const std::uint32_t i : scratch.awake_bodies)
    if (takes_part(i) && restless[i] != 0) restless[root_of(scratch.islands, i)] = 1;
  for (const std::uint32_t i : scratch.awake_bodies) {
    if (!takes_part(i) || restless[root_of(scratch.islands, i)] != 0) continue;
    BodyMotion<D>& body = state.bodies.moved(i);
    body.asleep = 1;
    body.velocity = Vec<D>::zero();
    body.spin = Spin<D>::zero();
    ++scratch.bodies_asleep;
  }
}

template void wake_islands(const StepContext<2>&, const WorldState<2>&, StepScratch<2>&);
template void wake_islands(const StepContext<3>&, const WorldState<3>&, StepScratch<3>&);
template void rest_islands(const StepContext<2>&, Workers&, StepScratch<2>&, WorldState<2>&);
template void rest_islands(const StepContext<3>&, Workers&, StepScratch<3>&, WorldState<3>&);

}  // namespace cycloid::solver
