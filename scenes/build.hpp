#pragma once

#include <memory>
#include <vector>

#include "scenes/catalogue.hpp"
#include "scenes/scene.hpp"
#include "solver/character/mover.hpp"

namespace cycloid::scenes {

/// A control with its names resolved.
struct BoundControl {
  Control control;
  solver::BodyId body;    ///< force, torque, impulse
  solver::JointId joint;  ///< motor_speed, steering
  float motor_max = 0.0f;
  std::size_t prefab = 0;     ///< spawn
  std::size_t character = 0;  ///< walk, jump
  std::uint32_t first_register =
      0;  ///< spawn: next place, then `limit` pairs (index + 1, generation).
};

struct BoundSeat {
  std::vector<BoundControl> controls;
};

/// What a prefab makes.
template <int D>
struct Prefab {
  solver::BodyDef<D> body;
  std::vector<solver::ShapeDef<D>> shapes;
};

/// A character of the scene; its state lies in the registers from `first_register` on.
template <int D>
struct Character {
  solver::MoverDef<D> mover;
  solver::Vec<D> start = solver::Vec<D>::zero();  ///< Position at tick 0, m.
  float gravity_scale = 1.0f;
  float speed = 0.0f;             ///< m/s
  float acceleration = 0.0f;      ///< m/s^2, on the ground.
  float air_acceleration = 0.0f;  ///< m/s^2
  float jump_speed = 0.0f;        ///< m/s
  std::uint32_t first_register = 0;
};

/// A world with everything of its scene in it, and the seats bound to it. Registers: the buttons of
/// each seat in the tick before, then the spawn lists, then the characters (characters.hpp).
template <int D>
struct Built {
  solver::World<D> world;
  std::vector<BoundSeat> seats;
  std::vector<Prefab<D>> prefabs;
  std::vector<Character<D>> characters;
  std::uint32_t register_count = 0;  ///< A snapshot with another number is of another scene.
};

/// Builds the scene and appends every mistake that is in the way; null if there was any.
/// @pre scene.dimension == D.
template <int D>
std::unique_ptr<Built<D>> build(const Scene& scene, std::vector<Mistake>& mistakes);

}  // namespace cycloid::scenes
