#pragma once

#include <span>

#include "scenes/build.hpp"

namespace cycloid::scenes {

/// Lets every seat act on the world for the coming tick, in seat order and each seat's controls in
/// theirs, and then moves the characters. Reads and writes the registers; what a control cannot do
/// (a full world) it leaves undone, the same everywhere.
template <int D>
void apply_controls(Built<D>& built, std::span<const SeatInput> inputs);

}  // namespace cycloid::scenes
