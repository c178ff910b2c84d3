#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "solver/result.hpp"

namespace cycloid::solver {

/// One number that differs between two encoded states.
struct EncodedDifference {
  std::string kind;        ///< "body", "joint", "contact", "register", "particle", "world", ...
  std::uint32_t slot = 0;  ///< Of that kind; of a contact its place in the first state that has it.
  std::uint32_t generation = 0;
  std::string about;    ///< "bodies 2 and 5", or "".
  std::string field;    ///< "position[0]"; "" where only one state has the object.
  std::string value_a;  ///< Decimal, and the bits in hexadecimal; "absent".
  std::string value_b;
  std::uint64_t bits_a = 0;  ///< As integers; both 0 where only one state has the object.
  std::uint64_t bits_b = 0;

  std::string object() const { return kind + " " + std::to_string(slot); }
};

struct EncodingsCompared {
  std::vector<EncodedDifference> first;
  std::uint64_t count = 0;    ///< Of all numbers that differ; an absent object counts as one.
  std::uint64_t objects = 0;  ///< To which they belong.
};

/// Compares two encodings number by number, as the digest does: both zeros are one, and so is every
/// NaN. Neither has to be a state that a world could have: bytes of a peer may hold anything. What
/// causes comes before what it makes: registers, joints, contacts, then bodies. Contacts are the
/// same where they are of the same two shapes, wherever they stand in the list.
/// @param limit  How many differences to name at most.
/// @returns kCorrupt "bytes" where one of them, and kInvalid "dimension" where not both, are
/// states.
Result<EncodingsCompared> compare_encodings(std::span<const std::byte> a,
                                            std::span<const std::byte> b, std::size_t limit);

}  // namespace cycloid::solver
