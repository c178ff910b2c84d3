#pragma once

#include <cmath>
#include <cstdint>

#include "tests/oracle/vector.hpp"

namespace cycloid::oracle {

/// The same numbers on every platform. Source: S. Vigna, splitmix64 (2015).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    state_ += 0x9e3779b97f4a7c15u;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// 0 to count - 1.
  int below(int count) { return static_cast<int>(bits() % static_cast<std::uint64_t>(count)); }
  double within(double low, double high) {
    return low + (high - low) * static_cast<double>(bits() >> 11) * 0x1p-53;
  }
  /// As likely between 0.1 and 0.2 as between 1 and 2.
  double log_within(double low, double high) {
    return low * std::exp(within(0.0, std::log(high / low)));
  }
  Vector direction() {
    while (true) {
      const Vector v = {within(-1, 1), within(-1, 1), within(-1, 1)};
      if (dot(v, v) > 0.01 && dot(v, v) <= 1.0) return normalized(v);
    }
  }
  /// Any rotation, evenly.
  Placement turn() {
    while (true) {
      const double w = within(-1, 1);
      const Vector v = {within(-1, 1), within(-1, 1), within(-1, 1)};
      const double square = dot(v, v) + w * w;
      if (square < 0.01 || square > 1.0) continue;
      const double scale = 1.0 / std::sqrt(square);
      return {{}, scale * v, scale * w};
    }
  }

 private:
  std::uint64_t state_;
};

}  // namespace cycloid::oracle
