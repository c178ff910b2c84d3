#pragma once

#include "bench/peers/engine.hpp"

namespace cycloid::peers {

/// A scene of space in Bullet 3.24, as the distribution packages it, with Bullet's own defaults:
/// one step of ten iterations per tick. Bodies, shapes, joints and controls are those of the built
/// scene at tick 0. Friction mixes alike in both (Bullet multiplies, so it is given the roots).
///
/// Approximations: a wheel joint is Bullet's Hinge2; the friction of a cone-twist joint is left
/// out. Null where the scene has cloths, characters, or joints of other kinds.
std::unique_ptr<Engine<3>> make_bullet_world(const EngineInput<3>& input, std::string& why);

}  // namespace cycloid::peers
