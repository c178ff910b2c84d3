#pragma once

#include "tests/properties/player.hpp"

namespace cycloid::properties {

/// How lively what was played was, so that a generator of dull cases is noticed.
struct Played {
  std::string failure;  ///< "" where both runs were equal; else where they parted, and in what.
  std::uint64_t cases = 0;
  std::uint64_t ticks = 0;
  std::uint64_t calls = 0;
  std::uint64_t refused = 0;
  std::uint64_t faulted = 0;   ///< Cases that ended in a fault, which both runs had to meet alike.
  std::uint64_t contacts = 0;  ///< Summed over ticks, as are those below.
  std::uint64_t joints = 0;
  std::uint64_t asleep = 0;
  std::uint64_t particles = 0;
  std::uint64_t links = 0;
  std::uint64_t crowded_ticks = 0;  ///< With more contacts than one worker takes at once.
  std::uint64_t resting_ticks = 0;  ///< With more bodies asleep than that.
  std::uint64_t paced_ticks = 0;    ///< In fewer substeps: islands solved at once had all.

  void add(const Played& other);
};

/// Plays a case in its two settings side by side and compares after every call and every tick: the
/// answers, the digests, the events; at the end the encodings, to the last bit.
Played play(const Case& example, Flaw flaw = Flaw::kNone);

}  // namespace cycloid::properties
