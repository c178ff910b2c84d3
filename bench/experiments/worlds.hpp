#pragma once

#include <span>
#include <vector>

#include "bench/experiments/experiment.hpp"
#include "solver/world.hpp"

namespace cycloid::experiments {

// Worlds that several experiments need. Gravity is 10 m/s^2 downwards along y, a tick 1/60 s,
// nothing sleeps, and friction is 0 unless it says otherwise.

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kGravity = 10.0;
inline constexpr double kTick = 1.0 / 60.0;
/// What one tick of free fall adds, m/s.
inline constexpr double kTickSpeed = kGravity * kTick;

/// Throws std::logic_error with the field: an experiment that cannot be built is a mistake in it.
void require(const solver::Error& error);
template <class T>
T require(solver::Result<T> result) {
  require(result.ok() ? solver::Error{} : result.error());
  return std::move(result.value());
}

/// Velocities alone: projected Gauss-Seidel without any correction of positions, one substep.
solver::Tuning velocities_only(std::uint32_t sweeps, solver::Order order = solver::Order::kId);

solver::World<2> make_world(const solver::Tuning& tuning, const solver::Material& material = {0.0f},
                            double gravity = kGravity, double tick_s = kTick);
solver::ShapeDef<2> ball(double radius);
solver::ShapeDef<2> box(double half_x, double half_y);
/// A static half-space under the line through the origin that rises by `angle` (rad) towards +x.
solver::BodyId add_ground(solver::World<2>& world, double angle = 0.0);
/// Of mass `mass` (kg; 0: from density 1), at (x, y) m.
solver::BodyId add(solver::World<2>& world, const solver::ShapeDef<2>& shape, double x, double y,
                   double mass = 0.0, solver::BodyKind kind = solver::BodyKind::kDynamic);
/// A body without shape: static where mass is 0, else a particle (kg).
solver::BodyId add_point(solver::World<2>& world, double x, double y, double mass = 0.0);

void step(solver::World<2>& world, int ticks = 1);
solver::BodyView<2> view(const solver::World<2>& world, solver::BodyId id);

/// Ground and balls of radius 0.5 m in one vertical line that just touch, bottom first: contact i
/// is under ball i. Ids ascend, so that Order::kId is bottom-up.
solver::World<2> stack_of_balls(const std::vector<double>& masses, const solver::Tuning& tuning);
/// Of every contact point, in the order of state().contacts, N s.
std::vector<double> normal_impulses(const solver::World<2>& world);
/// What carries the balls of a stack, N s per tick.
std::vector<double> exact_impulses(const std::vector<double>& masses, double speed = kTickSpeed);

/// Contact impulses of the first tick after each number of sweeps from 1 to `most`: entry k is
/// after k + 1 sweeps. The world is left as it was, but for its tuning.
std::vector<std::vector<double>> impulses_by_sweep(solver::World<2>& world, int most);

/// max over contacts of |impulse - exact| / exact: the measure of accuracy of Catto 2014.
double slowest_error(const std::vector<double>& impulses, const std::vector<double>& exact);
/// Sweeps of one cold tick until slowest_error is at most `tolerance`; 0 where `most` are too few.
int sweeps_to(solver::World<2>& world, const std::vector<double>& exact, double tolerance,
              int most);

}  // namespace cycloid::experiments
