#pragma once

#include <optional>
#include <span>
#include <vector>

#include "protocol/log/values.hpp"

namespace cycloid::protocol {

/// The payloads of records. A tick holds only what is not as in the tick before, so that an input
/// held costs nothing.

/// `seats` is that of the tick before on call, and of this tick on return.
void append_tick(const LogTick& tick, std::vector<SeatFrame>& seats, std::vector<std::byte>& into);
/// `tick.frame.seats` is that of the tick before on call. Sets all but `tick.frame.tick`; false,
/// and `tick` is of no use, where values are out of range or bytes are left over.
bool read_tick(std::span<const std::byte> payload, LogTick& tick);

void append_keyframe(const LogKeyframe& keyframe, std::vector<std::byte>& into);
std::optional<LogKeyframe> read_keyframe(std::span<const std::byte> payload);

void append_footer(const LogFooter& footer, std::vector<std::byte>& into);
std::optional<LogFooter> read_footer(std::span<const std::byte> payload);

}  // namespace cycloid::protocol
