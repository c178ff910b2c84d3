#include "solver/collision/collide.hpp"
#include "solver/stages/stages.hpp"

namespace cycloid::solver {

/// The root of a body's island; halves the path on the way, which changes no result.
static std::uint32_t root_of(std::vector<std::uint32_t>& parent, std::uint32_t body) {
  while (parent[body] != body) {
    parent[body] = parent[parent[body]];
    body = parent[body];
  }
  return body;
}

/// The lower slot becomes the root, so that an island is named by its lowest body.
static void join(std::vector<std::uint32_t>& parent, std::uint32_t a, std::uint32_t b) {
  a = root_of(parent, a);
  b = root_of(parent, b);
  if (a < b)
    parent[b] = a;
  else
    parent[a] = b;
}

template <int D>
static bool drives(const Joint<D>& joint) {
  const bool runs = joint.motor == MotorKind::kSpeed && joint.motor_speed != 0.0f;
  return runs || (joint.motor == MotorKind::kPosition && joint.drive_amplitude != 0.0f);
}

/// Joins the moving bodies of every contact and joint. What a driven joint or a moving kinematic
/// body holds on to stays awake.
template <int D>
static void find_islands(const WorldState<D>& state, StepScratch<D>& scratch) {
  std::vector<std::uint32_t>& parent = scratch.islands;
  parent.resize(state.bodies.size());
  scratch.kept_awake.assign(state.bodies.size(), 0);
  for (std::uint32_t i = 0; i < parent.size(); ++i) parent[i] = i;
  const auto link = [&](std::uint32_t a, std::uint32_t b, bool keep) {
    const bool a_moves = state.bodies[a].inverse_mass > 0.0f;
    const bool b_moves = state.bodies[b].inverse_mass > 0.0f;
    if (a_moves && b_moves) join(parent, a, b);
    const bool pushed =
        (!a_moves && is_active(state.bodies[a])) || (!b_moves && is_active(state.bodies[b]));
    if (keep || pushed) scratch.kept_awake[a_moves ? a : b] = 1;
  };
  for (const Contact<D>& contact : scratch.contacts)
    link(state.shapes[contact.shape_a].body, state.shapes[contact.shape_b].body, false);
  for (const Joint<D>& joint : state.joints)
    if (joint.kind != JointKind::kFree) link(joint.body_a, joint.body_b, drives(joint));
}

/// The contacts of bodies that woke have no manifold yet: their pairs were not looked for.
template <int D>
static void collide_woken(const StepContext<D>& context, const WorldState<D>& state,
                          StepScratch<D>& scratch) {
  for (std::size_t i = 0; i < scratch.contacts.size(); ++i) {
    if (scratch.manifolds[i].point_count > 0) continue;
    Contact<D>& contact = scratch.contacts[i];
    const Shape<D>& a = state.shapes[contact.shape_a];
    const Shape<D>& b = state.shapes[contact.shape_b];
    if (scratch.awake[a.body] == 0 && scratch.awake[b.body] == 0) continue;
    const Pose<D> pose_a{state.bodies[a.body].position, state.bodies[a.body].rotation};
    const Pose<D> pose_b{state.bodies[b.body].position, state.bodies[b.body].rotation};
    const Manifold<D> manifold =
        collide(a, pose_a, b, pose_b, context.tuning.speculative_distance, state.polyhedra);
    // Neither body has moved since the contact was kept, so its points and impulses still belong to
    // each other; a contact that is gone all the same is solved as one without points.
    if (manifold.point_count == contact.point_count) scratch.manifolds[i] = manifold;
  }
}

/// Islands of bodies that contacts and joints hold together, and which bodies are awake in this
/// tick: a sleeping island wakes as a whole when one that moves touches it.
///
/// Reads contacts, joints and bodies; writes islands, awake, kept_awake and the manifolds of
/// contacts that woke. Serial; a function of ids alone.
template <int D>
void wake_islands(const StepContext<D>& context, const WorldState<D>& state,
                  StepScratch<D>& scratch) {
  find_islands(state, scratch);
  const std::size_t count = state.bodies.size();
  scratch.awake.assign(count + 1, 0);
  scratch.island_flags.assign(count, 0);
  for (std::uint32_t i = 0; i < count; ++i)
    if (is_active(state.bodies[i]) || scratch.kept_awake[i] != 0)
      scratch.island_flags[root_of(scratch.islands, i)] = 1;
  bool woke = false;
  for (std::uint32_t i = 0; i < count; ++i) {
    const Body<D>& body = state.bodies[i];
    const bool moves = body.inverse_mass > 0.0f;
    const bool awake =
        moves ? scratch.island_flags[root_of(scratch.islands, i)] != 0 : is_active(body);
    scratch.awake[i] = awake ? 1 : 0;
    woke = woke || (moves && awake && !is_active(body));
  }
  if (woke) collide_woken(context, state, scratch);
}

/// An island whose bodies have all been slower than sleep_speed for sleep_s falls asleep: its
/// velocities become zero, and until it wakes none of its state changes.
///
/// Reads motions and islands; writes rest_ticks, asleep and, of bodies that fall asleep,
/// velocities. Serial, in slot order.
template <int D>
void rest_islands(const StepContext<D>& context, const StepScratch<D>& scratch,
                  WorldState<D>& state) {
  const Tuning& tuning = context.tuning;
  const float wanted = tuning.sleep_s / context.tick_s;
  std::vector<std::uint8_t> restless(state.bodies.size(), tuning.sleep_s > 0.0f ? 0 : 1);
  const auto root = [&](std::uint32_t i) {
    while (scratch.islands[i] != i) i = scratch.islands[i];
    return i;
  };
  for (std::uint32_t i = 0; i < state.bodies.size(); ++i) {
    Body<D>& body = state.bodies[i];
    if (scratch.awake[i] == 0 || body.inverse_mass == 0.0f) continue;
    const float speed = length(body.velocity) + body.extent * length(body.spin);
    const bool rested = body.asleep == 0 && speed < tuning.sleep_speed;
    body.rest_ticks = rested ? body.rest_ticks + 1 : 0;  // Who has just woken starts anew.
    body.asleep = 0;
    const bool rests = static_cast<float>(body.rest_ticks) >= wanted;
    if (!rests || scratch.kept_awake[i] != 0) restless[root(i)] = 1;
  }
  for (std::uint32_t i = 0; i < state.bodies.size(); ++i) {
    Body<D>& body = state.bodies[i];
    if (scratch.awake[i] == 0 || body.inverse_mass == 0.0f || restless[root(i)] != 0) continue;
    body.asleep = 1;
    body.velocity = Vec<D>::zero();
    body.spin = Spin<D>::zero();
  }
}

template void wake_islands(const StepContext<2>&, const WorldState<2>&, StepScratch<2>&);
template void wake_islands(const StepContext<3>&, const WorldState<3>&, StepScratch<3>&);
template void rest_islands(const StepContext<2>&, const StepScratch<2>&, WorldState<2>&);
template void rest_islands(const StepContext<3>&, const StepScratch<3>&, WorldState<3>&);

}  // namespace cycloid::solver
