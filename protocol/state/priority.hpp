#pragma once

#include <vector>

#include "protocol/state/quantised_delta.hpp"

namespace cycloid::protocol {

/// Something that `now` shows otherwise than what the client holds.
struct PendingChange {
  WaitingChange what;   ///< With the ticks that it has waited by now.
  std::uint64_t error;  ///< In steps; appearing and vanishing count as very far.
};

/// Every change between the two, the most urgent first. Two bodies in the same slot are one change.
std::vector<PendingChange> changes_by_urgency(const HeldState& baseline, const QuantisedState& now);

/// The baseline after the first `count` changes, with the tick of `now`; the others wait.
HeldState with_changes(const HeldState& baseline, const QuantisedState& now,
                       const std::vector<PendingChange>& changes, std::size_t count);

}  // namespace cycloid::protocol
