#include "solver/character/mover.hpp"

#include <optional>

namespace cycloid::solver {

/// One call of `move`. Positions are relative to where the tick started, for precision.
template <int D>
struct Passage {
  const WorldState<D>& world;
  const MoverDef<D>& def;
  Vec<D> origin;  ///< World.
  Vec<D> target;  ///< Displacement wanted, m.
  float dt;
  std::vector<CollisionPlane<D>> planes;  ///< Of the last solve.
  std::vector<QueryHit<D>> hits;          ///< What the plane of the same index is of.
  struct Met {
    QueryHit<D> hit;
    Vec<D> at;
  };
  std::vector<Met> met;     ///< What casts ran into, and where.
  float separation = 0.0f;  ///< Least, at the last scan.
};

template <int D>
static Probe<D> probe_of(const MoverDef<D>& def, float radius) {
  Probe<D> probe{};
  probe.radius = radius;
  probe.points[0] = def.lower;
  probe.points[1] = def.upper;
  const Vec<D> axis = def.upper - def.lower;
  probe.count = dot(axis, axis) > 0.0f ? 2 : 1;
  return probe;
}

template <int D>
static Pose<D> pose_at(const Passage<D>& passage, const Vec<D>& at) {
  return {passage.origin + at, identity_rotation<D>()};
}

template <int D>
static Vec<D> horizontal(const MoverDef<D>& def, const Vec<D>& a) {
  return a - dot(a, def.up) * def.up;
}

template <int D>
static Vec<D> velocity_at(const WorldState<D>& world, BodyId id, const Vec<D>& point) {
  const Body<D>& body = world.bodies[id.index];
  return body.velocity + spin_cross(body.spin, point - body.position);
}

/// Adds the plane that keeps the mover at `at` its skin from what was hit, and where that is
/// steep, the vertical one at the same height.
template <int D>
static void add_planes(Passage<D>& passage, const QueryHit<D>& hit, const Vec<D>& at,
                       float separation) {
  const MoverDef<D>& def = passage.def;
  const Vec<D>& normal = hit.normal;
  const float away = dot(velocity_at(passage.world, hit.body, hit.point), normal);
  const float recovery = (def.recover_speed_max + max(0.0f, away)) * passage.dt;
  // What was moved along the normal already in this tick is part of the recovery.
  const float push = min(def.skin - separation, max(0.0f, recovery - dot(normal, at)));
  const float offset = dot(normal, at) + push;
  passage.planes.push_back({normal, offset, kRigidPlane, 0.0f});
  passage.hits.push_back(hit);
  const float rise = dot(normal, def.up);
  if (rise <= 0.0f || rise >= def.slope_cos_min) return;
  const Vec<D> outwards = horizontal(def, normal);
  const float across = length(outwards);
  if (across < 1.0e-3f) return;
  passage.planes.push_back(
      {(1.0f / across) * outwards, (offset - rise * dot(def.up, at)) / across, kRigidPlane, 0.0f});
  passage.hits.push_back(hit);
}

/// The planes near `at`, then those that casts of this tick ran into.
template <int D>
static void collect_planes(Passage<D>& passage, const Vec<D>& at) {
  const MoverDef<D>& def = passage.def;
  passage.planes.clear();
  passage.hits.clear();
  passage.separation = def.skin;
  for (const QueryHit<D>& hit : overlap(passage.world, probe_of(def, def.radius),
                                        pose_at(passage, at), 2.0f * def.skin, def.filter)) {
    passage.separation = min(passage.separation, hit.separation);
    add_planes(passage, hit, at, hit.separation);
  }
  for (const auto& met : passage.met) add_planes(passage, met.hit, met.at, 0.0f);
}

/// Where the mover gets from `at` by `translation`: `clearance` short of what it meets, along the
/// normal. @post `touch` is where it would touch, if it met anything.
template <int D>
static Vec<D> advance(const Passage<D>& passage, const Probe<D>& probe, const Vec<D>& at,
                      const Vec<D>& translation, float clearance, std::optional<QueryHit<D>>& hit,
                      Vec<D>& touch) {
  hit =
      shape_cast_first(passage.world, probe, pose_at(passage, at), translation, passage.def.filter);
  if (!hit) return at + translation;
  touch = at + hit->fraction * translation;
  const float approach = -dot(hit->normal, translation);
  const float back = approach > 1.0e-12f ? clearance / approach : 0.0f;
  return at + max(0.0f, hit->fraction - back) * translation;
}

/// The talk's loop. Returns the iterations made.
template <int D>
static int slide(Passage<D>& passage, Vec<D>& at) {
  const MoverDef<D>& def = passage.def;
  for (int iteration = 1; iteration <= def.iterations_max; ++iteration) {
    collect_planes(passage, at);
    // What is overlapped or touched cannot be cast against, so then a thinner mover is cast.
    const float thinner = max(0.0f, 0.25f * def.skin - passage.separation);
    float inside = passage.separation > 0.0f ? 0.0f : thinner;
    const bool deep = inside >= def.radius;
    const Vec<D> solved = solve_planes<D>(deep ? at : passage.target, passage.planes).position;
    const Vec<D> translation = solved - at;
    if (length(translation) < 0.01f * def.skin) return iteration;
    if (deep) {
      at = solved;
      return iteration;
    }
    std::optional<QueryHit<D>> hit;
    Vec<D> touch = at;
    const Vec<D> from = at;
    at = advance(passage, probe_of(def, def.radius - inside), from, translation, def.skin + inside,
                 hit, touch);
    if (hit && hit->fraction <= 0.0f && inside < thinner)
      at = advance(passage, probe_of(def, def.radius - thinner), from, translation,
                   def.skin + thinner, hit, touch);
    if (hit) passage.met.push_back({*hit, touch});
  }
  return def.iterations_max;
}

/// Whether the mover can stand on what it hit: a walkable normal, or the edge of a walkable top.
template <int D>
static bool supports(const Passage<D>& passage, const QueryHit<D>& hit) {
  const MoverDef<D>& def = passage.def;
  const float rise = dot(hit.normal, def.up);
  if (rise >= def.slope_cos_min) return true;
  if (rise <= 0.02f) return false;
  const Vec<D> inwards = -normalized_or(horizontal(def, hit.normal), Vec<D>::zero());
  Probe<D> foot{};
  foot.count = 1;
  foot.radius = 0.5f * def.skin;
  foot.points[0] = Vec<D>::zero();
  const Vec<D> above = hit.point + 2.0f * def.skin * inwards + 4.0f * def.skin * def.up;
  const std::optional<QueryHit<D>> below =
      shape_cast_first(passage.world, foot, Pose<D>{above, identity_rotation<D>()},
                       -8.0f * def.skin * def.up, def.filter);
  return below && below->fraction > 0.0f && dot(below->normal, def.up) >= def.slope_cos_min;
}

/// Distance to the nearest shape, at most the skin; negative in overlap.
template <int D>
static float separation_at(const Passage<D>& passage, const Vec<D>& at) {
  const MoverDef<D>& def = passage.def;
  float least = def.skin;
  for (const QueryHit<D>& hit : overlap(passage.world, probe_of(def, def.radius),
                                        pose_at(passage, at), def.skin, def.filter))
    least = min(least, hit.separation);
  return least;
}

/// Straight down until the mover stands `skin` above what it meets within `reach`. The cast is of
/// a narrower mover, or a wall that it slides along would count as what it met; no `hit` where the
/// mover itself is too wide for the place.
template <int D>
static Vec<D> set_down(const Passage<D>& passage, const Vec<D>& at, float reach,
                       std::optional<QueryHit<D>>& hit) {
  const MoverDef<D>& def = passage.def;
  const Probe<D> narrow = probe_of(def, def.radius - def.skin);
  Vec<D> touch = at;
  const Vec<D> lowered =
      advance(passage, narrow, at, -(reach + def.skin) * def.up, 2.0f * def.skin, hit, touch);
  const float least = min(0.0f, separation_at(passage, at)) - 1.0e-3f * def.skin;
  if (hit && separation_at(passage, lowered) < least) hit.reset();
  return lowered;
}

/// Up, forward by `ahead` and down; false, and nothing has changed, where that is no higher or
/// there is nothing to stand on within `step_height` above the feet.
template <int D>
static bool climb_by(const Passage<D>& passage, const Vec<D>& ahead, Vec<D>& at) {
  const MoverDef<D>& def = passage.def;
  const Probe<D> probe = probe_of(def, def.radius);
  std::optional<QueryHit<D>> hit;
  Vec<D> touch = at;
  const Vec<D> raised = advance(passage, probe, at, def.step_height * def.up, def.skin, hit, touch);
  const Vec<D> forward = advance(passage, probe, raised, ahead, def.skin, hit, touch);
  if (dot(forward - raised, ahead) < 0.1f * dot(ahead, ahead)) return false;
  const Vec<D> lowered = set_down(passage, forward, dot(raised - at, def.up), hit);
  if (!hit || !supports(passage, *hit)) return false;
  const float feet = min(dot(def.lower, def.up), dot(def.upper, def.up)) - def.radius - def.skin;
  const float top = dot(hit->point - passage.origin - at, def.up);
  if (top - feet > def.step_height + 1.0e-3f) return false;
  if (dot(lowered - at, def.up) < 0.01f * def.skin) return false;
  at = lowered;
  return true;
}

/// Onto the step that stopped the mover: by as much as it still wanted to go, and where that does
/// not reach beyond the gap of its skin, by a little more.
template <int D>
static bool climb(const Passage<D>& passage, Vec<D>& at) {
  const MoverDef<D>& def = passage.def;
  const Vec<D> left = horizontal(def, passage.target - at);
  const float distance = length(left);
  if (distance < 0.1f * def.skin) return false;
  if (climb_by(passage, left, at)) return true;
  const float least = 3.0f * def.skin;
  return distance < least && climb_by(passage, (least / distance) * left, at);
}

/// What the mover stands on, if anything. A mover that walked is set down onto it.
template <int D>
static std::optional<QueryHit<D>> find_ground(const Passage<D>& passage, const MoverState<D>& state,
                                              Vec<D>& at) {
  const MoverDef<D>& def = passage.def;
  const Probe<D> probe = probe_of(def, def.radius);
  // Ground that rises will have risen by this after the tick.
  const float lift = max(0.0f, dot(state.ground_velocity, def.up) * passage.dt);
  std::optional<QueryHit<D>> ground;
  for (const QueryHit<D>& hit :
       overlap(passage.world, probe, pose_at(passage, at), 1.5f * def.skin + lift, def.filter)) {
    const float rise = dot(hit.normal, def.up);
    if (rise >= def.slope_cos_min && (!ground || rise > dot(ground->normal, def.up))) ground = hit;
  }
  if (ground) return ground;
  const float reach = (state.grounded ? def.step_height : 0.5f * def.skin) + lift;
  const Vec<D> lowered = set_down(passage, at, reach, ground);
  if (!ground || !supports(passage, *ground)) return std::nullopt;
  if (state.grounded) at -= max(0.0f, dot(at - lowered, def.up) - lift) * def.up;
  return ground;
}

template <int D>
static void push_bodies(const Passage<D>& passage, const Vec<D>& velocity, bool walking,
                        std::vector<MoverImpulse<D>>& impulses) {
  const MoverDef<D>& def = passage.def;
  for (std::size_t i = 0; i < passage.planes.size(); ++i) {
    const QueryHit<D>& hit = passage.hits[i];
    const Vec<D>& normal = passage.planes[i].normal;
    const float inverse_mass = passage.world.bodies[hit.body.index].inverse_mass;
    if (!(passage.planes[i].push > 0.0f) || !(inverse_mass > 0.0f)) continue;
    if (walking && dot(normal, def.up) >= def.slope_cos_min) continue;
    const Vec<D> relative = velocity - velocity_at(passage.world, hit.body, hit.point);
    const float approach = -dot(relative, normal);
    if (!(approach > 0.0f)) continue;
    const float impulse =
        min(approach / (1.0f / def.push_mass + inverse_mass), def.push_force_max * passage.dt);
    impulses.push_back({hit.body, hit.point, -impulse * normal});
  }
}

template <int D>
MoverStep<D> move(const WorldState<D>& world, const MoverDef<D>& def, const MoverState<D>& state,
                  float dt) {
  const bool jumps = dot(state.velocity, def.up) > 1.0e-3f;
  const bool walks = state.grounded && !jumps;
  const Vec<D> own = walks ? horizontal(def, state.velocity) : state.velocity;
  const Vec<D> velocity = own + state.ground_velocity;
  Passage<D> passage{world, def, state.position, dt * velocity, dt, {}, {}, {}, 0.0f};
  MoverStep<D> step;
  Vec<D> at = Vec<D>::zero();
  step.iterations = slide(passage, at);
  push_bodies(passage, velocity, walks, step.impulses);
  // Ground alone, however it rises, is no step: there the wish is projected.
  bool blocked = false;
  for (const CollisionPlane<D>& plane : passage.planes)
    blocked = blocked || (plane.push > 0.0f && dot(plane.normal, def.up) < def.slope_cos_min);
  step.stepped = walks && blocked && passage.separation > 0.0f && climb(passage, at);
  std::optional<QueryHit<D>> ground;
  if (!jumps) ground = find_ground(passage, state, at);

  // A walker's speed is horizontal, whatever the slope it walks on: the ground alone, or a step
  // that was climbed, takes none of it.
  if (walks && (step.stepped || !blocked))
    for (CollisionPlane<D>& plane : passage.planes) plane.push = 0.0f;
  const Vec<D> clipped = clip_velocity<D>(velocity, passage.planes);
  step.state.position = state.position + at;
  step.state.velocity = clipped;
  if (!ground) return step;
  step.state.grounded = true;
  step.state.ground = ground->body;
  step.state.ground_velocity = velocity_at(world, ground->body, ground->point);
  step.state.velocity = horizontal(def, clipped - step.state.ground_velocity);
  return step;
}

template MoverStep<2> move(const WorldState<2>&, const MoverDef<2>&, const MoverState<2>&, float);
template MoverStep<3> move(const WorldState<3>&, const MoverDef<3>&, const MoverState<3>&, float);

}  // namespace cycloid::solver
