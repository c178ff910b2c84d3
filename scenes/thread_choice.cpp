#include "scenes/thread_choice.hpp"

#include <algorithm>
#include <cstddef>

namespace cycloid::scenes {

/// The middle one: a step in which the system has done something else says nothing.
template <std::size_t N>
static std::uint64_t median(std::array<std::uint64_t, N> times_ns) {
  // Total order: equal integers are one and the same.
  std::sort(times_ns.begin(), times_ns.end());
  return times_ns[N / 2];
}

bool ThreadChoice::is_alone() const {
  if (step_ < kTried) return false;
  return step_ < 2 * kTried || alone_is_faster_;
}

void ThreadChoice::choose() {
  const bool alone_is_faster = median(alone_ns_) < median(together_ns_);
  const bool as_before = alone_is_faster == alone_is_faster_;
  round_ = as_before ? std::min(2 * round_, kRoundMax) : kRoundMin;
  alone_is_faster_ = alone_is_faster;
}

void ThreadChoice::took(std::uint64_t step_ns) {
  const int of_try = step_ % kTried - kSettling;
  if (step_ < 2 * kTried && of_try >= 0) {
    Times& times = step_ < kTried ? together_ns_ : alone_ns_;
    times[static_cast<std::size_t>(of_try)] = step_ns;
  }
  ++step_;
  if (step_ == 2 * kTried) choose();
  if (step_ == round_) step_ = 0;
}

}  // namespace cycloid::scenes
