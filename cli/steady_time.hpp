#pragma once

#include <chrono>
#include <cstdint>

namespace cycloid::cli {

/// Nanoseconds of the clock of the process, which never goes back.
inline std::uint64_t steady_ns() {
  const auto now = std::chrono::steady_clock::now().time_since_epoch();
  return static_cast<std::uint64_t>(std::chrono::nanoseconds(now).count());
}

}  // namespace cycloid::cli
