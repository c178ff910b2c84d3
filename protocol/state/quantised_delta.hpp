#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "protocol/state/quantised.hpp"

namespace cycloid::protocol {

/// A change of the world that a budget has kept from a client so far.
struct WaitingChange {
  std::uint8_t list = 0;  ///< 0 characters, 1 bodies, 2 particles.
  std::uint32_t index = 0;
  std::uint32_t ticks = 0;  ///< That it has waited.
  friend bool operator==(const WaitingChange&, const WaitingChange&) = default;
};

/// What a client holds once it has taken a delta in, as its server knows it: the baseline of later
/// ones. Without a budget that binds, `state` is the world and nothing waits.
struct HeldState {
  QuantisedState state;
  std::vector<WaitingChange> waiting;  ///< By list and index.
};

/// A change that has waited for so long goes before all that have waited for less, however small
/// it is.
inline constexpr std::uint32_t kWaitTicksMax = 30;
/// The least budget: with it every delta brings at least one change. Less counts as this.
inline constexpr std::size_t kBudgetBytesMin = 96;

struct QuantisedDelta {
  std::vector<std::byte> bytes;  ///< Empty: nothing is shown otherwise than in the baseline.
  HeldState held;
};

/// What differs between a baseline and now, in at most `bytes_max`: what has waited too long first,
/// the longest first; then what is most wrong on the screen for longest. A pure function of its
/// arguments, so clients with equal baselines share its result.
///
/// No change waits for ever: with n changes at once, of which m fit in bytes_max (at least 1 from
/// kBudgetBytesMin on), and a client whose every delta is d ticks behind its baseline, each is sent
/// within kWaitTicksMax + d (ceil(n / m) + 1) ticks.
///
/// @param baseline  what the client holds; null: nothing.
/// @pre the lists of `now` are sorted, as `capture` leaves them.
QuantisedDelta encode_quantised(const HeldState* baseline, const QuantisedState& now,
                                std::size_t bytes_max);

/// The state that the client holds after the delta: QuantisedDelta::held.state.
///
/// Whatever the bytes, allocates for at most `bodies_max` bodies in each list beside the baseline,
/// and works no longer than for so many. Damage that is not refused here shows in digest_of, which
/// the caller compares with StateDelta::digest.
/// @param baseline  null: none.
/// @param tick  StateDelta::tick.
/// @returns nothing where the bytes are refused.
std::optional<QuantisedState> decode_quantised(const QuantisedState* baseline, std::uint64_t tick,
                                               std::span<const std::byte> bytes,
                                               std::size_t bodies_max);

}  // namespace cycloid::protocol
