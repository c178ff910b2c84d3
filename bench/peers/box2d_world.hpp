#pragma once

#include "bench/peers/engine.hpp"

namespace cycloid::peers {

/// A scene of the plane in Box2D 2.4.1, as the distribution packages it, with its defaults: one
/// step of eight velocity and three position iterations per tick. Masses, filters, friction and
/// restitution are those of the built scene, and mix alike in both.
///
/// What differs: a capsule is a box between two circles, three fixtures; a half-plane is an edge of
/// 4 km; corners are rounded by Box2D's own skin of 10 mm. Null where the scene has particles,
/// characters, or joints other than pins, slides, rods and welds.
std::unique_ptr<Engine<2>> make_box2d_world(const EngineInput<2>& input, std::string& why);

}  // namespace cycloid::peers
