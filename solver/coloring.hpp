#pragma once

#include <cstdint>
#include <vector>

#include "solver/workers.hpp"

namespace cycloid::solver {

/// The bodies of a joint or contact that move: slots, or kNone.
struct MovingPair {
  std::uint32_t a;
  std::uint32_t b;

  bool operator==(const MovingPair&) const = default;
};

/// A joint of which a body is awake, and all that decides what it holds.
struct LiveJoint {
  int slot;
  MovingPair bodies;
  bool a_is_awake;
  bool b_is_awake;
  bool is_rigid;  ///< Its equalities do not yield.

  bool operator==(const LiveJoint&) const = default;
};

/// Constraints by colour: no two of one colour share a body that moves. `order` lists colour after
/// colour; the last range holds what fitted none, to be solved one after the other.
struct Coloring {
  std::vector<int> order;
  std::vector<Range> colors;  ///< Of divided contacts, those of lot after lot.
  Range overflow;
};

/// More colours than this would leave each with too little to share among lanes and threads.
inline constexpr int kColorsMax = 28;

/// The colour of each constraint.
struct Colors {
  std::vector<std::uint8_t> of;    ///< kColorsMax: it fitted none.
  int sizes[kColorsMax + 1] = {};  ///< By colour.
};

/// What the live contacts of a tick join, and their colours, which are a function of that alone;
/// none where they stand in one line instead.
struct ContactColors : Colors {
  std::vector<MovingPair> pairs;
};

/// Whole islands that are solved from the first substep to the last, before or beside those of
/// other lots: no two lots share a body that moves. A tick that is not divided is one lot.
struct Lot {
  Range bodies;           ///< Places in moving_bodies.
  Range colors;           ///< Of its contacts, among those of all.
  Range overflow;         ///< Blocks in no colour; none where the tick is divided.
  int blocks_before = 0;  ///< Blocks of all lots that do not stand before its own in memory.
  bool follows = false;   ///< Some block of its contacts does.
  bool bounces = false;
  std::uint32_t poses = 0;  ///< Grows whenever its bodies have moved in this tick.
};

/// How a tick is divided into lots, and what divide_into_lots works in.
struct Lots {
  std::vector<Lot> all;                ///< None where the tick is not divided.
  std::vector<std::uint32_t> of_body;  ///< By slot, from whatever tick; none where none are known.
  std::uint32_t count = 0;             ///< Of those.
  std::vector<std::uint32_t> of_contact;
  std::vector<std::uint32_t> parent;    ///< By slot: another body of its island, or itself.
  std::vector<std::uint32_t> contacts;  ///< Of an island, by its lowest slot.
  std::vector<int> ends;                ///< Of counting_sort.
};

}  // namespace cycloid::solver
