#pragma once

#include "bench/peers/engine.hpp"

namespace cycloid::peers {

/// Our own solver. Worlds that are there at the same time share the memory of their steps, as the
/// rooms of a server do. Null, with the mistake or the field in `why`, where the scene is not good.
template <int D>
std::unique_ptr<Engine<D>> make_our_world(const EngineInput<D>& input, std::string& why);

}  // namespace cycloid::peers
