#pragma once

#include "solver/character/mover.hpp"
#include "tests/solver/world_fixture.hpp"

namespace cycloid::solver {

inline constexpr float kMoveTick = 1.0f / 60.0f;
inline constexpr float kSkin = 0.01f;

inline float radians(float angle_deg) {
  return angle_deg * 3.14159265f / 180.0f;
}

template <int D>
MoverDef<D> ball_mover(float radius) {
  MoverDef<D> def;
  def.radius = radius;
  return def;
}

/// 1.8 m tall; the position is that of the feet.
inline MoverDef<2> walker() {
  MoverDef<2> def;
  def.lower = {{0.0f, 0.3f}};
  def.upper = {{0.0f, 1.5f}};
  return def;
}

inline BodyId add_static_box(World<2>& world, Vec<2> centre, float half_x, float half_y) {
  BodyDef<2> def;
  def.kind = BodyKind::kStatic;
  def.position = centre;
  return add(world, def, box(half_x, half_y));
}

/// How far the mover is from the nearest shape, at most 1 m.
template <int D>
float clearance(const World<D>& world, const MoverDef<D>& def, const Vec<D>& position) {
  Probe<D> probe{};
  probe.count = 1;
  probe.radius = def.radius;
  probe.points[0] = def.lower;
  float least = 1.0f;
  for (const QueryHit<D>& hit :
       overlap(world.state(), probe, Pose<D>{position, identity_rotation<D>()}, 1.0f, def.filter))
    least = std::min(least, hit.separation);
  return least;
}

/// One tick of a walker that wants this horizontal speed and falls where it stands on nothing.
inline MoverState<2> walk(const World<2>& world, const MoverDef<2>& def, MoverState<2> state,
                          float speed) {
  state.velocity[0] = speed;
  if (!state.grounded) state.velocity[1] -= 10.0f * kMoveTick;
  return move(world.state(), def, state, kMoveTick).state;
}

}  // namespace cycloid::solver
