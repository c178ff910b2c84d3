#pragma once

#include <cstdint>

#include "protocol/lockstep.hpp"

namespace cycloid::server {

/// Which part of a tick lies before the ticks of the n-th room, as a fraction of 2^32: 0, 1/2, 1/4,
/// 3/4, 1/8, ... (van der Corput's sequence). However many rooms there are, they are spread evenly
/// to a factor of two, and none has to move when another comes.
constexpr std::uint32_t phase_of_slot(std::uint32_t slot) {
  std::uint32_t reversed = 0;
  for (int bit = 0; bit < 32; ++bit) {
    reversed = (reversed << 1) | ((slot >> bit) & 1u);
  }
  return reversed;
}

/// The first moment from `now_ns` on at which a room of this slot and rate may begin, so that its
/// ticks lie at its phase of a raster that begins at `epoch_ns`.
/// @pre 0 < rate_millihertz <= 10^7 and now_ns >= epoch_ns.
constexpr std::int64_t staggered_start_ns(std::int64_t epoch_ns, std::int64_t now_ns,
                                          std::uint32_t rate_millihertz, std::uint32_t slot) {
  constexpr std::uint64_t kIn1000s = 1'000'000'000'000;
  const protocol::Schedule zero(0, rate_millihertz);
  const auto tick_ns = static_cast<std::uint64_t>(zero.deadline_ns(1));
  const auto phase_ns = static_cast<std::int64_t>(tick_ns * phase_of_slot(slot) >> 32);
  const protocol::Schedule raster(epoch_ns + phase_ns, rate_millihertz);
  if (now_ns <= epoch_ns + phase_ns) return epoch_ns + phase_ns;
  const auto passed_ns = static_cast<std::uint64_t>(now_ns - epoch_ns - phase_ns);
  std::uint64_t n =
      passed_ns / kIn1000s * rate_millihertz + passed_ns % kIn1000s * rate_millihertz / kIn1000s;
  while (raster.deadline_ns(n) < now_ns) ++n;  // At most twice: both were rounded down.
  return raster.deadline_ns(n);
}

}  // namespace cycloid::server
