#pragma once

#include <cstdint>
#include <random>

namespace cycloid::server {

/// The system's, for salts and ids of logs.
inline std::uint64_t random_number() {
  std::random_device random;
  const std::uint64_t high = random();
  return (high << 32) | random();
}

}  // namespace cycloid::server
