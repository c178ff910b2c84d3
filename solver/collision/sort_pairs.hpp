#pragma once

#include "solver/collision/pair_cache.hpp"

namespace cycloid::solver {

/// Sorts pairs by their keys. Total order: the key is the whole pair, so what is equal is the same
/// bytes.
/// @param shapes  More than any slot.
/// @param room  Of any size and contents; left with others.
void sort_pairs(std::uint32_t shapes, std::vector<ShapePair>& room, std::vector<ShapePair>& pairs);

}  // namespace cycloid::solver
