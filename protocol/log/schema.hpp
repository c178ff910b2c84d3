#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "protocol/crc32c.hpp"
#include "solver/version.hpp"
#include "solver/world.hpp"

namespace cycloid::protocol {

/// The outer form: header, blocks and chunks. docs/protocol.md has it byte by byte.
inline constexpr std::uint32_t kLogFormat = 2;

/// What the records hold. A change of any record changes this text with it, and so the number that
/// each header carries.
inline constexpr std::string_view kLogSchemaText =
    "tick: digest u64, [parts u8: bits 1 count of seats, 2 events, 4 changes, seats << 3]; "
    "count v; [seats v]; seats x (fields u8: 4 axes, buttons, origin, skip << 6; [skip v], "
    "axes zigzag v, buttons xor v, origin u8); "
    "events: n v, (kind u8, seat v); changes: n v, (kind u8, value v). "
    "keyframe: tick u64, digest u64, seats u16 x (origin u8, axes 4 x u16, buttons u16), state. "
    "footer: tick u64, digest u64, n u32 x (tick u64, at u64, before u32).";

constexpr std::uint32_t checksum_of(std::string_view text) {
  std::array<std::byte, 1024> bytes{};
  std::transform(text.begin(), text.end(), bytes.begin(),
                 [](char c) { return static_cast<std::byte>(c); });
  return crc32c(std::span<const std::byte>(bytes).first(text.size()));
}

inline constexpr std::uint32_t kLogSchema = checksum_of(kLogSchemaText);

/// Solver versions whose arithmetic gives the bits of this one, so that their logs verify here.
/// A version goes in when every log of the corpus (tests/determinism/logs) that it wrote verifies.
/// All others are refused with both values. The version itself stands last.
inline constexpr std::array kBitCompatibleSolverVersions = {solver::kSolverVersion};

}  // namespace cycloid::protocol
