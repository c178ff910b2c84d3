#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/scene.hpp"

namespace cycloid::worlds {

enum class Group {
  kSmall,   ///< What a server runs: a hundred rooms in rotation, so that caches are cold.
  kPlane,   ///< One large world of the plane.
  kSpace,   ///< One world of space.
  kGrowth,  ///< The same at many sizes.
};

/// A scene that is measured, and how. Every engine reads the same description; what `make` returns
/// is a pure function of `size`.
struct BenchWorld {
  std::string name;  ///< "movers-60"
  Group group = Group::kSmall;
  scenes::Scene (*make)(int size) = nullptr;
  int size = 0;
  int warm_ticks = 0;  ///< Before the clock: contacts have formed, and buffers have their size.
  int ticks = 0;       ///< Timed, of each world.
  int worlds = 1;      ///< Stepped in turn.
  int runs_max = 64;   ///< Repetitions at most; large worlds repeat well and take long.
};

/// Every scene of the benchmarks, group by group, the sizes of growth ascending.
const std::vector<BenchWorld>& bench_worlds();

/// A scene of `bench_worlds`, or one of the catalogue in one world, with 60 ticks to warm up and
/// 300 to time; nothing where neither knows the name.
std::optional<BenchWorld> find_bench_world(std::string_view name);

/// The scene of it, under its name. Nothing sleeps but in `sleeping_field`. @pre `find_bench_world`
/// or `bench_worlds` gave it.
scenes::Scene make_scene(const BenchWorld& world);

// The generators. Lengths in m; every scene has gravity of 10 m/s^2 downwards unless it says none.

/// A box on the ground.
scenes::Scene one_box(int);
/// Seen from above, no gravity: `movers` balls and boxes that never lose speed between four walls.
scenes::Scene moving_room(int movers);
/// A settled pile of balls, boxes and capsules in a bin.
scenes::Scene heap(int bodies);
/// Unit boxes in a pyramid: base (base + 1) / 2 of them.
scenes::Scene box_pyramid(int base);
/// side x side pyramids of ten boxes' base, each row on a floor of its own.
scenes::Scene many_pyramids(int side);
/// As many pyramids of 55 boxes side by side as hold so many boxes, rounded up.
scenes::Scene pyramid_field(int bodies);
/// `pyramid_field` of which all but the first pyramid lie still and sleep.
scenes::Scene sleeping_field(int bodies);
/// Balls that fall into a bin.
scenes::Scene falling_balls(int balls);
/// A heavy box flies into a block of columns x 2/3 columns small ones; no gravity.
scenes::Scene smash(int columns);
/// Bodies of two triangles each, which together are no convex shape, dropped into a bin.
scenes::Scene compounds(int bodies);
/// side x side balls in a net of pins that hangs from the middle of its top; nothing collides.
scenes::Scene joint_grid(int side);
/// side x side small boxes in a box that a motor turns.
scenes::Scene tumbler(int side);
/// Mixed shapes in a ring of 360 segments, stirred by a bar on a motor.
scenes::Scene spinner(int bodies);
/// Ragdolls of eleven capsules that rain onto a floor with steps.
scenes::Scene ragdoll_rain(int people);
/// Hulls of 12 to 20 corners dropped into a walled box. Space.
scenes::Scene convex_pile(int hulls);

}  // namespace cycloid::worlds
