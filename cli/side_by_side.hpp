#pragma once

#include <cstddef>
#include <functional>

namespace cycloid::cli {

/// Calls work(0) to work(count - 1), up to `jobs` at a time, each once and in any order; one after
/// the other where the target has no threads. What a call throws is thrown here, when all that had
/// begun have ended: of several the one of the lowest number.
void side_by_side(std::size_t count, int jobs, const std::function<void(std::size_t)>& work);

}  // namespace cycloid::cli
