#pragma once

#include <chrono>
#include <cstdint>

namespace cycloid::server {

/// The clock of the process, which never goes back.
inline std::int64_t process_now_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

inline std::chrono::steady_clock::time_point process_time_point(std::int64_t now_ns) {
  return std::chrono::steady_clock::time_point(
      std::chrono::duration_cast<std::chrono::steady_clock::duration>(
          std::chrono::nanoseconds(now_ns)));
}

}  // namespace cycloid::server
