#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

namespace cycloid::sim {

/// Spreads every bit of the value over all 64. Source: Vigna, splitmix64.c, public domain.
constexpr std::uint64_t scramble(std::uint64_t value) {
  value += 0x9e3779b97f4a7c15;
  value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9;
  value = (value ^ (value >> 27)) * 0x94d049bb133111eb;
  return value ^ (value >> 31);
}

inline constexpr std::uint32_t kMillion = 1'000'000;

/// Chance that is the same on every platform: integers only. Two draws never stand in one argument
/// list, whose order is the compiler's.
///
/// Source: Blackman and Vigna, "Scrambled linear pseudorandom number generators" (2021),
/// xoshiro256**.
class Random {
 public:
  explicit Random(std::uint64_t seed) : seed_(seed) {
    std::uint64_t word = seed;
    for (std::uint64_t& part : state_) part = word = scramble(word);
  }

  std::uint64_t next() {
    const std::uint64_t result = std::rotl(state_[1] * 5, 7) * 9;
    const std::uint64_t shifted = state_[1] << 17;
    state_[2] ^= state_[0];
    state_[3] ^= state_[1];
    state_[1] ^= state_[2];
    state_[0] ^= state_[3];
    state_[2] ^= shifted;
    state_[3] = std::rotl(state_[3], 45);
    return result;
  }

  /// 0 to bound - 1. @pre bound > 0.
  std::uint64_t below(std::uint64_t bound) { return next() % bound; }
  /// Both ends included. @pre low <= high.
  std::int64_t between(std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(below(static_cast<std::uint64_t>(high - low) + 1));
  }
  bool chance(std::uint32_t per_million) { return below(kMillion) < per_million; }
  bool one_in(std::uint64_t count) { return below(count) == 0; }
  void fill(std::span<std::byte> bytes) {
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(next() >> 56);
  }

  /// A stream of its own, which depends on the seed and the name alone: what one part of a run
  /// draws shifts nothing of another part.
  Random fork(std::uint64_t name) const { return Random(scramble(seed_ ^ scramble(name))); }

 private:
  std::uint64_t seed_;
  std::array<std::uint64_t, 4> state_{};
};

}  // namespace cycloid::sim
