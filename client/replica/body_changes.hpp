#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "scenes/simulation.hpp"

namespace cycloid::client {

struct BodyChange {
  bool created = false;  ///< Else destroyed.
  std::uint32_t index = 0;
  std::uint32_t generation = 0;
  friend bool operator==(const BodyChange&, const BodyChange&) = default;
};

/// Which bodies came and which went from one state to the next.
class BodyChanges {
 public:
  /// Destroyed ones first, each in order of index. To the first state everything is new.
  std::vector<BodyChange> compare(std::span<const scenes::Pose> poses);

 private:
  using Id = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<Id> ids_;  ///< Of the state before, sorted.
};

}  // namespace cycloid::client
