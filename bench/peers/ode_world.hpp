#pragma once

#include "bench/peers/engine.hpp"

namespace cycloid::peers {

/// A scene of space in ODE 0.16, as the distribution packages it (in double precision), with ODE's
/// defaults: one quick step of 20 iterations per tick, at most eight contact points a pair,
/// friction as a pyramid. Its broad phase is the sweep, which is the fastest of its spaces on these
/// scenes.
///
/// What differs: a cone-twist joint is a ball joint without its limits and friction. Null where the
/// scene has meshes, cloths, characters, or joints other than balls, hinges, cones and welds.
std::unique_ptr<Engine<3>> make_ode_world(const EngineInput<3>& input, std::string& why);

}  // namespace cycloid::peers
