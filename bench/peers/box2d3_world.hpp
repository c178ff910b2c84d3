#pragma once

#include "bench/peers/engine.hpp"

namespace cycloid::peers {

/// A scene of the plane in Box2D 3, with its defaults: four substeps a tick, contacts recycled,
/// continuous collision against what is static, one worker. No distribution packages it, so it is
/// there only where CMake finds an installed one (`box2dConfig.cmake`, version 3). Masses, filters,
/// friction and restitution are those of the built scene, and mix alike in both.
///
/// What differs: a half-plane is a segment of 4 km. Null where the scene has particles, characters,
/// or joints other than pins, slides, rods and welds.
std::unique_ptr<Engine<2>> make_box2d3_world(const EngineInput<2>& input, std::string& why);

}  // namespace cycloid::peers
