#pragma once

#include <array>
#include <cstdint>

namespace cycloid::scenes {

/// Whether steps take less time on all threads of a world or on one. That is no property of the
/// world alone: where a host lends two cores that are far from one another, or others use them too,
/// a step of a few thousand bodies takes half as long again on both. So both are tried, a few steps
/// each, at the start of every round, and the rest of it goes by what they took. A round is twice
/// as long as the one before, up to a bound, while the answer stays the same.
///
/// Knows no clock: the host tells it what a step took. What it chooses shows in time alone.
class ThreadChoice {
 public:
  /// Steps of the shortest and the longest round, and how many of them try each of the two.
  static constexpr int kRoundMin = 64;
  static constexpr int kRoundMax = 512;
  static constexpr int kTried = 8;

  /// Whether the coming step is to be taken by one thread.
  bool is_alone() const;
  /// That step is done. @param step_ns  what it took by the clock of the wall.
  void took(std::uint64_t step_ns);

 private:
  /// Of each try, the first steps: threads wake, and caches fill.
  static constexpr int kSettling = 2;
  using Times = std::array<std::uint64_t, kTried - kSettling>;

  void choose();

  int round_ = kRoundMin / 2;  ///< How many steps it has, once both were tried.
  int step_ = 0;               ///< Of the round: first the tries of all threads, then those of one.
  Times together_ns_{};
  Times alone_ns_{};
  bool alone_is_faster_ = false;
};

}  // namespace cycloid::scenes
