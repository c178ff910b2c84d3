#pragma once

#include <vector>

#include "solver/character/planes.hpp"
#include "solver/queries/query.hpp"
#include "solver/state.hpp"

namespace cycloid::solver {

/// The unit vector along axis 1.
template <int D>
constexpr Vec<D> axis_up() {
  Vec<D> up = Vec<D>::zero();
  up[1] = 1.0f;
  return up;
}

/// The shape and the rules of a character, which moves but does not turn and is no body.
template <int D>
struct MoverDef {
  Vec<D> lower = Vec<D>::zero();      ///< End of the capsule's segment, from the position, m.
  Vec<D> upper = Vec<D>::zero();      ///< The other; equal to `lower` for a ball.
  float radius = 0.3f;                ///< m, > 0.
  float skin = 0.01f;                 ///< m of distance kept from everything, > 0.
  Vec<D> up = axis_up<D>();           ///< Unit.
  float slope_cos_min = 0.70710678f;  ///< Walkable where dot(normal, up) is at least this.
  float step_height = 0.35f;          ///< m, climbed and followed downwards at most.
  float recover_speed_max = 3.0f;     ///< m/s at which overlap is left, besides a wall's own.
  float push_mass = 80.0f;            ///< kg with which dynamic bodies are pushed, > 0.
  float push_force_max = 1000.0f;     ///< N, per contact.
  int iterations_max = 8;
  QueryFilter filter;
};

/// What a mover carries from tick to tick; the host keeps it in the world's registers or its own.
template <int D>
struct MoverState {
  Vec<D> position = Vec<D>::zero();  ///< m, world.
  Vec<D> velocity = Vec<D>::zero();  ///< Own, m/s: relative to the ground while grounded.
  bool grounded = false;
  BodyId ground;                            ///< The body stood on, while grounded.
  Vec<D> ground_velocity = Vec<D>::zero();  ///< m/s, of that body where it is stood on.
};

/// For the caller to apply to a dynamic body that was pushed.
template <int D>
struct MoverImpulse {
  BodyId body;
  Vec<D> point;    ///< m, world.
  Vec<D> impulse;  ///< N s.
};

template <int D>
struct MoverStep {
  MoverState<D> state;
  std::vector<MoverImpulse<D>> impulses;  ///< In the order of the planes.
  int iterations = 0;
  bool stepped = false;  ///< Climbed a step.
};

/// Moves a character by (velocity + ground_velocity) dt [s] through a world, which stays as it is.
///
/// A position solver: the planes near the mover are collected, the target is projected onto them
/// by `solve_planes`, and a shape cast from the present to the solved position clips the motion at
/// whatever it meets, whose plane is then added; again until it stays within a hundredth of the
/// skin, at most `iterations_max` times. No speed passes a wall, because every motion is cast.
///
/// Steep planes count as vertical too, so they are not climbed; gravity is the caller's. While
/// grounded the downward part of the velocity is dropped and the ground is followed up and down
/// within `step_height`; an upward velocity jumps. Overlap is left at `recover_speed_max`; a mover
/// that overlaps by its radius or more does nothing else. Dynamic bodies stop the mover like walls
/// and receive min(reduced mass * approach, push_force_max * dt) along the normal.
/// @pre finite, dt > 0; start where the overlap is less than the radius for the no-pass promise.
/// Source: Catto, "Understanding Constraints" (GDC 2014), character solvers.
template <int D>
MoverStep<D> move(const WorldState<D>& world, const MoverDef<D>& def, const MoverState<D>& state,
                  float dt);

}  // namespace cycloid::solver
