#pragma once

#include <cstdint>

namespace cycloid::solver {

/// Names, for a digest and a handshake, the arithmetic of this solver: equal versions give equal
/// bits. Raised by every commit that re-mints goldens.
inline constexpr std::uint32_t kSolverVersion = 44;

}  // namespace cycloid::solver
