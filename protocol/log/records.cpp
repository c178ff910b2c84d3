#include "protocol/log/records.hpp"

#include <algorithm>
#include <cstddef>

#include "protocol/little_endian.hpp"

namespace cycloid::protocol {
namespace {

// The first byte behind the digest: what is not as before, and how many seats are among it.
enum Part : std::uint8_t { kSeatCount = 1, kEvents = 2, kChanges = 4 };
constexpr unsigned kSeatsShift = 3;
constexpr unsigned kManySeats = 31;  ///< The number follows.

// The first byte of a seat: what has changed of it, the axes first, a bit each, and how many seats
// before it have not.
constexpr unsigned kButtonsBit = 1u << scenes::kAxes;
constexpr unsigned kOriginBit = kButtonsBit << 1;
constexpr unsigned kAllFields = (kOriginBit << 1) - 1;
constexpr unsigned kSkipShift = 6;
constexpr unsigned kManySkipped = 3;  ///< The number follows.
static_assert(kAllFields < 1u << kSkipShift);

constexpr std::size_t kPlaceBytes = 20;

/// Seven bits a byte, the lowest first; the top bit says that more come.
void append_varint(std::uint32_t value, std::vector<std::byte>& into) {
  for (; value >= 0x80; value >>= 7) into.push_back(static_cast<std::byte>(value | 0x80));
  into.push_back(static_cast<std::byte>(value));
}

std::uint32_t take_varint(LittleReader& reader) {
  std::uint32_t value = 0;
  for (unsigned shift = 0; shift < 35; shift += 7) {
    const auto byte = reader.take<std::uint8_t>();
    const std::uint32_t bits = byte & 0x7fu;
    reader.failed = reader.failed || (shift == 28 && bits > 0xf) || (shift != 0 && byte == 0);
    value |= bits << shift;
    if (byte < 0x80) return value;
  }
  reader.failed = true;
  return 0;
}

/// A difference modulo 2^16, small ones of either sign as small numbers.
std::uint32_t zigzag(std::int16_t from, std::int16_t to) {
  const auto difference =
      static_cast<std::int16_t>(static_cast<std::uint16_t>(to) - static_cast<std::uint16_t>(from));
  return static_cast<std::uint16_t>((static_cast<std::uint16_t>(difference) << 1) ^
                                    (difference < 0 ? 0xffffu : 0u));
}

std::int16_t unzigzag(std::int16_t from, std::uint32_t value) {
  const std::uint32_t difference = (value >> 1) ^ ((value & 1) != 0 ? 0xffffu : 0u);
  return static_cast<std::int16_t>(static_cast<std::uint16_t>(from) + difference);
}

unsigned changed_fields(const SeatFrame& before, const SeatFrame& now) {
  unsigned fields = 0;
  for (std::size_t axis = 0; axis < now.input.axes.size(); ++axis)
    if (before.input.axes[axis] != now.input.axes[axis]) fields |= 1u << axis;
  if (before.input.buttons != now.input.buttons) fields |= kButtonsBit;
  if (before.origin != now.origin) fields |= kOriginBit;
  return fields;
}

void append_fields(const SeatFrame& before, const SeatFrame& now, unsigned fields,
                   std::vector<std::byte>& into) {
  for (std::size_t axis = 0; axis < now.input.axes.size(); ++axis)
    if ((fields & 1u << axis) != 0)
      append_varint(zigzag(before.input.axes[axis], now.input.axes[axis]), into);
  if ((fields & kButtonsBit) != 0)
    append_varint(static_cast<std::uint32_t>(before.input.buttons ^ now.input.buttons), into);
  if ((fields & kOriginBit) != 0) append_little(static_cast<std::uint8_t>(now.origin), into);
}

std::uint32_t count_changed(const std::vector<SeatFrame>& before,
                            const std::vector<SeatFrame>& now) {
  std::uint32_t changed = 0;
  for (std::size_t seat = 0; seat < now.size(); ++seat) changed += before[seat] != now[seat];
  return changed;
}

void append_seats(const std::vector<SeatFrame>& before, const std::vector<SeatFrame>& now,
                  std::vector<std::byte>& into) {
  std::uint32_t skipped = 0;
  for (std::size_t seat = 0; seat < now.size(); ++seat) {
    const unsigned fields = changed_fields(before[seat], now[seat]);
    if (fields == 0) {
      ++skipped;
      continue;
    }
    const unsigned skip = std::min(skipped, kManySkipped);
    append_little(static_cast<std::uint8_t>(fields | skip << kSkipShift), into);
    if (skip == kManySkipped) append_varint(skipped, into);
    skipped = 0;
    append_fields(before[seat], now[seat], fields, into);
  }
}

bool is_origin(Origin origin) {
  return origin >= Origin::kGiven && origin <= Origin::kNeutral;
}

void take_fields(LittleReader& reader, unsigned fields, SeatFrame& seat) {
  reader.failed = reader.failed || fields == 0;
  for (std::size_t axis = 0; axis < seat.input.axes.size(); ++axis) {
    if ((fields & 1u << axis) == 0) continue;
    const std::uint32_t value = take_varint(reader);
    reader.failed = reader.failed || value == 0 || value > 0xffff;
    seat.input.axes[axis] = unzigzag(seat.input.axes[axis], value);
  }
  if ((fields & kButtonsBit) != 0) {
    const std::uint32_t value = take_varint(reader);
    reader.failed = reader.failed || value == 0 || value > 0xffff;
    seat.input.buttons = static_cast<std::uint16_t>(seat.input.buttons ^ value);
  }
  if ((fields & kOriginBit) == 0) return;
  const auto origin = static_cast<Origin>(reader.take<std::uint8_t>());
  reader.failed = reader.failed || !is_origin(origin) || origin == seat.origin;
  seat.origin = origin;
}

void take_seats(LittleReader& reader, std::uint32_t changed, std::vector<SeatFrame>& seats) {
  std::size_t seat = 0;
  reader.failed = reader.failed || changed > seats.size();
  for (std::uint32_t i = 0; i < changed && !reader.failed; ++i, ++seat) {
    const unsigned head = reader.take<std::uint8_t>();
    std::uint32_t skipped = head >> kSkipShift;
    if (skipped == kManySkipped) {
      skipped = take_varint(reader);
      reader.failed = reader.failed || skipped < kManySkipped;
    }
    if (skipped >= seats.size() - seat) {  // `seat` is at most the size.
      reader.failed = true;
      return;
    }
    seat += skipped;
    take_fields(reader, head & kAllFields, seats[seat]);
  }
}

void take_events(LittleReader& reader, InputFrame& frame) {
  const std::uint32_t count = take_varint(reader);
  reader.failed = reader.failed || count == 0 || count > kFrameEventsMax;
  for (std::uint32_t i = 0; i < count && !reader.failed; ++i) {
    FrameEvent event;
    event.kind = static_cast<EventKind>(reader.take<std::uint8_t>());
    const std::uint32_t seat = take_varint(reader);
    reader.failed = reader.failed || event.kind < EventKind::kJoin ||
                    event.kind > EventKind::kResume || seat >= frame.seats.size();
    event.seat = static_cast<std::uint16_t>(seat);
    frame.events.push_back(event);
  }
}

void take_changes(LittleReader& reader, InputFrame& frame) {
  const std::uint32_t count = take_varint(reader);
  reader.failed = reader.failed || count == 0 || count > kFrameChangesMax;
  for (std::uint32_t i = 0; i < count && !reader.failed; ++i) {
    FrameChange change;
    change.kind = static_cast<ChangeKind>(reader.take<std::uint8_t>());
    change.value = take_varint(reader);
    reader.failed = reader.failed || change.kind != ChangeKind::kInputDelay || change.value == 0;
    frame.changes.push_back(change);
  }
}

}  // namespace

void append_tick(const LogTick& tick, std::vector<SeatFrame>& seats, std::vector<std::byte>& into) {
  const InputFrame& frame = tick.frame;
  append_little(tick.digest, into);
  unsigned parts = 0;
  if (frame.seats.size() != seats.size()) parts |= kSeatCount;
  seats.resize(frame.seats.size());
  const std::uint32_t changed = count_changed(seats, frame.seats);
  parts |= std::min(changed, kManySeats) << kSeatsShift;
  if (!frame.events.empty()) parts |= kEvents;
  if (!frame.changes.empty()) parts |= kChanges;
  if (parts == 0) return;
  append_little(static_cast<std::uint8_t>(parts), into);
  if ((parts & kSeatCount) != 0) append_varint(static_cast<std::uint32_t>(seats.size()), into);
  if (changed >= kManySeats) append_varint(changed, into);
  append_seats(seats, frame.seats, into);
  seats = frame.seats;
  if ((parts & kEvents) != 0) append_varint(static_cast<std::uint32_t>(frame.events.size()), into);
  for (const FrameEvent& event : frame.events) {
    append_little(static_cast<std::uint8_t>(event.kind), into);
    append_varint(event.seat, into);
  }
  if ((parts & kChanges) == 0) return;
  append_varint(static_cast<std::uint32_t>(frame.changes.size()), into);
  for (const FrameChange& change : frame.changes) {
    append_little(static_cast<std::uint8_t>(change.kind), into);
    append_varint(change.value, into);
  }
}

bool read_tick(std::span<const std::byte> payload, LogTick& tick) {
  LittleReader reader{payload};
  InputFrame& frame = tick.frame;
  frame.events.clear();
  frame.changes.clear();
  tick.digest = reader.take<std::uint64_t>();
  if (reader.failed || reader.bytes.empty()) return !reader.failed;
  const unsigned parts = reader.take<std::uint8_t>();
  if (parts == 0) return false;
  if ((parts & kSeatCount) != 0) {
    const std::uint32_t seats = take_varint(reader);
    if (reader.failed || seats > scenes::kSeatsMax || seats == frame.seats.size()) return false;
    frame.seats.resize(seats);
  }
  std::uint32_t changed = parts >> kSeatsShift;
  if (changed == kManySeats) changed = take_varint(reader);
  if (parts >> kSeatsShift == kManySeats && changed < kManySeats) return false;
  take_seats(reader, changed, frame.seats);
  if ((parts & kEvents) != 0) take_events(reader, frame);
  if ((parts & kChanges) != 0) take_changes(reader, frame);
  return !reader.failed && reader.bytes.empty();
}

void append_keyframe(const LogKeyframe& keyframe, std::vector<std::byte>& into) {
  append_little(keyframe.tick, into);
  append_little(keyframe.digest, into);
  append_little(static_cast<std::uint16_t>(keyframe.seats.size()), into);
  for (const SeatFrame& seat : keyframe.seats) {
    append_little(static_cast<std::uint8_t>(seat.origin), into);
    for (const std::int16_t axis : seat.input.axes)
      append_little(static_cast<std::uint16_t>(axis), into);
    append_little(seat.input.buttons, into);
  }
  into.insert(into.end(), keyframe.state.begin(), keyframe.state.end());
}

std::optional<LogKeyframe> read_keyframe(std::span<const std::byte> payload) {
  LittleReader reader{payload};
  LogKeyframe keyframe;
  keyframe.tick = reader.take<std::uint64_t>();
  keyframe.digest = reader.take<std::uint64_t>();
  const auto seats = reader.take<std::uint16_t>();
  if (reader.failed || seats > scenes::kSeatsMax) return {};
  keyframe.seats.resize(seats);
  for (SeatFrame& seat : keyframe.seats) {
    seat.origin = static_cast<Origin>(reader.take<std::uint8_t>());
    for (std::int16_t& axis : seat.input.axes)
      axis = static_cast<std::int16_t>(reader.take<std::uint16_t>());
    seat.input.buttons = reader.take<std::uint16_t>();
    if (!is_origin(seat.origin)) return {};
  }
  if (reader.failed) return {};
  keyframe.state.assign(reader.bytes.begin(), reader.bytes.end());
  return keyframe;
}

void append_footer(const LogFooter& footer, std::vector<std::byte>& into) {
  append_little(footer.ticks, into);
  append_little(footer.digest, into);
  append_little(static_cast<std::uint32_t>(footer.keyframes.size()), into);
  for (const KeyframePlace& place : footer.keyframes) {
    append_little(place.tick, into);
    append_little(place.at, into);
    append_little(place.before, into);
  }
}

std::optional<LogFooter> read_footer(std::span<const std::byte> payload) {
  LittleReader reader{payload};
  LogFooter footer;
  footer.ticks = reader.take<std::uint64_t>();
  footer.digest = reader.take<std::uint64_t>();
  const std::size_t count = reader.take<std::uint32_t>();
  if (reader.failed || reader.bytes.size() / kPlaceBytes != count ||
      reader.bytes.size() % kPlaceBytes != 0)
    return {};
  footer.keyframes.resize(count);
  for (KeyframePlace& place : footer.keyframes) {
    place.tick = reader.take<std::uint64_t>();
    place.at = reader.take<std::uint64_t>();
    place.before = reader.take<std::uint32_t>();
  }
  return footer;
}

}  // namespace cycloid::protocol
