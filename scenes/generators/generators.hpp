#pragma once

#include "scenes/scene.hpp"

namespace cycloid::scenes {

/// Scenes made by rule. The files in catalogue/ are their exports; a test holds the two equal.
/// Only + - * / and solver::sin_cos, so that a generated scene is the same on every machine.

Scene half_pipe();
/// @param base  boxes in the lowest row, 1 to 400: base (base + 1) / 2 in all.
Scene pyramid(int base);
Scene stack(int count);
Scene card_house(int storeys);
Scene newtons_cradle();
Scene bridge(int planks);
Scene ball_pit(int balls);
Scene room(int bodies);
Scene ragdolls(int count);
Scene ragdoll_motors();
Scene vehicle();
Scene machines();
Scene beads();
Scene rolling();
Scene bouncing(int discs);
/// @param links  capsules of 5.98 kg each, 1 to 400, with a ball of 4021 kg at the end.
Scene chain_and_ball(int links);
Scene heavy_on_light();
Scene within_a_millimetre();
Scene overlap(int base);
/// The same small scene under each method that is not the default: "method-pgs" and so on.
std::vector<Scene> method_scenes();

/// A cloth of columns x columns particles that falls over a ball, and a rope; in the plane a net.
Scene cloth(int columns);
Scene cloth_3d(int columns);

// In space.

Scene stack_3d(int count);
/// @param layers  of cubes, the lowest layers x layers, 1 to 40.
Scene pyramid_3d(int layers);
/// @param courses  of ten bricks, 1 to 100.
Scene wall(int courses);
Scene arch_3d(int stones);
/// @param side  small cubes along either side of the field, 1 to 100.
Scene cubes(int side);
Scene dzhanibekov();
Scene top();
Scene vehicle_3d();
Scene bridge_3d(int planks);
Scene ragdolls_3d(int count);

/// A character in the plane, walked by a seat past everything that it can and cannot do.
Scene character_course();
/// The same in space, with a wall to slide along and a narrow corner.
Scene character_course_3d();

// Parts that several of them use.

SceneShape box_shape(float half_x, float half_y);
SceneShape ball_shape(float radius);
SceneShape solid_box(const Triple& half);
SceneShape capsule_shape(const Triple& from, const Triple& to, float radius);
/// Solid to the right of its direction.
SceneShape chain_shape(std::vector<Triple> points, bool loop);
SceneBody ground();
/// A static body without shapes, to hang joints on.
SceneBody frame();
SceneBody body_at(const std::string& name, const Triple& position, const SceneShape& shape);
SceneJoint joint_between(solver::JointKind kind, const std::string& body_a, const Triple& anchor_a,
                         const std::string& body_b, const Triple& anchor_b);
/// A button that gives `target` an impulse, an axis that pushes it with a force.
Control impulse_control(std::uint32_t button, const std::string& target, const Triple& value);
Control force_control(std::uint32_t axis, const std::string& target, const Triple& value);
/// An axis of 1 is a motor speed of `value`, rad/s or m/s.
Control motor_control(std::uint32_t axis, const std::string& target, float value);
/// An axis that walks character `target` towards `value`; button 0 that makes it jump.
Control walk_control(std::uint32_t axis, const std::string& target, const Triple& value);
Control jump_control(const std::string& target);
/// A script that says `walk` on axis 0.
ScriptEntry walk_entry(std::uint32_t from, std::uint32_t until, float walk, std::uint32_t buttons);
/// Gravity of 10 m/s^2 downwards and one material.
Scene planar_scene(const char* name, const char* summary);
Scene spatial_scene(const std::string& name, const char* summary);
/// A seat whose button 0 throws a heavy ball from `position` with `velocity`, by script at ticks
/// 120, 360, ...; at most four at once.
void add_thrower(Scene& scene, const Triple& position, const Triple& velocity);

/// Uniform integers from a seed. Source: Steele, Lea and Flood, "Fast splittable pseudorandom
/// number generators" (OOPSLA 2014): splitmix64.
struct Random {
  std::uint64_t state;
  std::uint64_t next() {
    state += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// low + (high - low) k / 1000 for a k of 0 to 999.
  float between(float low, float high) {
    return low + (high - low) * (static_cast<float>(next() % 1000) / 1000.0f);
  }
};

}  // namespace cycloid::scenes
