#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace cycloid::protocol {

/// What differs between two canonical encodings (World::encode, Simulation::encode) of one scene:
/// record by record, contacts by the shapes that touch; every changed number as its distance from a
/// guess, which for poses is where the velocities would have taken the body. docs/protocol.md,
/// "Snapshots", has the format. Equal encodings are equal deltas on every target.
///
/// @param baseline  the encoding that the reader holds; empty: none.
/// @param into  replaced by the delta. About 10 bytes where nothing but the tick has changed.
/// @returns false, and leaves `into` empty, where one of the two is no canonical encoding, or they
///     are not of the same dimension.
bool encode_exact_delta(std::span<const std::byte> baseline, std::span<const std::byte> current,
                        std::vector<std::byte>& into);

/// The encoding that the delta was made of, to the bit.
///
/// Whatever the bytes, allocates at most `bytes_max` (twice, for a moment) and works no longer than
/// for a state of that size. A delta that is damaged so that it says another state, or was made
/// against another baseline, is refused but for one in 2^32, which StateDelta::digest refuses.
/// @returns nothing where the delta or the baseline is refused, or the state would be larger than
///     bytes_max.
std::optional<std::vector<std::byte>> decode_exact_delta(std::span<const std::byte> baseline,
                                                         std::span<const std::byte> delta,
                                                         std::size_t bytes_max);

}  // namespace cycloid::protocol
