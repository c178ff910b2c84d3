#pragma once

#include <cstddef>

namespace cycloid::hostile {

/// What operator new has handed out in this program, which replaces it (allocations.cpp).
struct Allocations {
  std::size_t live_bytes = 0;
  std::size_t peak_bytes = 0;     ///< Most that lived at once.
  std::size_t total_bytes = 0;    ///< All, given back or not.
  std::size_t largest_bytes = 0;  ///< The largest single one.
};

/// Counts anew from here: what lives now is not counted.
void reset_allocations();
Allocations allocations();

}  // namespace cycloid::hostile
