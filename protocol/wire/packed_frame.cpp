#include "protocol/wire/packed_frame.hpp"

#include <limits>
#include <utility>

#include "protocol/little_endian.hpp"

namespace cycloid::protocol {
namespace {

constexpr unsigned kOriginBits = 2;
constexpr unsigned kSeatButtonsBit = kOriginBits + scenes::kAxes;
constexpr std::uint8_t kOriginMask = (1u << kOriginBits) - 1;
static_assert(kSeatButtonsBit < 7, "what a seat has fits a byte, and one bit is left");

void append_number(std::uint64_t value, std::vector<std::byte>& into) {
  for (; value >= 0x80; value >>= 7) into.push_back(static_cast<std::byte>(value | 0x80));
  into.push_back(static_cast<std::byte>(value));
}

void append_seat(const SeatFrame& seat, std::vector<std::byte>& into) {
  unsigned has = static_cast<unsigned>(seat.origin) - 1;
  for (unsigned axis = 0; axis < scenes::kAxes; ++axis) {
    if (seat.input.axes[axis] != 0) has |= 1u << (kOriginBits + axis);
  }
  if (seat.input.buttons != 0) has |= 1u << kSeatButtonsBit;
  into.push_back(static_cast<std::byte>(has));
  for (const std::int16_t axis : seat.input.axes) {
    if (axis != 0) append_little(static_cast<std::uint16_t>(axis), into);
  }
  if (seat.input.buttons != 0) append_number(seat.input.buttons, into);
}

/// Takes a frame off its bytes. After the first mistake, all numbers are 0 and `failed`.
class FrameReader {
 public:
  explicit FrameReader(std::span<const std::byte> bytes) : from_{bytes, false} {}

  bool failed() const { return from_.failed; }
  bool at_end() const { return from_.bytes.empty(); }
  std::size_t bytes_left() const { return from_.bytes.size(); }

  std::uint64_t number(std::uint64_t most) {
    std::uint64_t value = 0;
    for (unsigned shift = 0; !from_.failed; shift += 7) {
      const std::uint64_t byte = from_.take<std::uint8_t>();
      // Of 64 bits, the tenth byte holds one. A last byte of nothing would be a second form.
      from_.failed =
          from_.failed || shift > 63 || (shift == 63 && byte > 1) || (shift > 0 && byte == 0);
      if (from_.failed) break;
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) break;
    }
    from_.failed = from_.failed || value > most;
    return from_.failed ? 0 : value;
  }

  SeatFrame seat() {
    SeatFrame seat;
    const auto has = from_.take<std::uint8_t>();
    from_.failed = from_.failed || (has >> (kSeatButtonsBit + 1)) != 0;
    seat.origin = static_cast<Origin>((has & kOriginMask) + 1);
    for (unsigned axis = 0; axis < scenes::kAxes; ++axis) {
      if ((has >> (kOriginBits + axis) & 1) == 0) continue;
      seat.input.axes[axis] = static_cast<std::int16_t>(from_.take<std::uint16_t>());
      from_.failed = from_.failed || seat.input.axes[axis] == 0;
    }
    if ((has >> kSeatButtonsBit & 1) != 0) {
      seat.input.buttons =
          static_cast<std::uint16_t>(number(std::numeric_limits<std::uint16_t>::max()));
      from_.failed = from_.failed || seat.input.buttons == 0;
    }
    return seat;
  }

  FrameEvent event(std::size_t seats) {
    const auto kind = static_cast<EventKind>(from_.take<std::uint8_t>());
    const std::uint64_t seat = number(seats);
    from_.failed =
        from_.failed || kind < EventKind::kJoin || kind > EventKind::kResume || seat >= seats;
    return {kind, static_cast<std::uint16_t>(seat)};
  }

  FrameChange change() {
    const auto kind = static_cast<ChangeKind>(from_.take<std::uint8_t>());
    const std::uint64_t value = number(std::numeric_limits<std::uint32_t>::max());
    from_.failed = from_.failed || kind != ChangeKind::kInputDelay || value == 0;
    return {kind, static_cast<std::uint32_t>(value)};
  }

 private:
  LittleReader from_;
};

}  // namespace

void pack_frame(const InputFrame& frame, std::vector<std::byte>& into) {
  append_number(frame.tick, into);
  append_number(frame.seats.size(), into);
  for (const SeatFrame& seat : frame.seats) append_seat(seat, into);
  if (frame.events.empty() && frame.changes.empty()) return;
  append_number(frame.events.size(), into);
  for (const FrameEvent& event : frame.events) {
    into.push_back(static_cast<std::byte>(event.kind));
    append_number(event.seat, into);
  }
  append_number(frame.changes.size(), into);
  for (const FrameChange& change : frame.changes) {
    into.push_back(static_cast<std::byte>(change.kind));
    append_number(change.value, into);
  }
}

std::optional<InputFrame> unpack_frame(std::span<const std::byte> bytes, std::string& error) {
  FrameReader from(bytes);
  InputFrame frame;
  frame.tick = from.number(std::numeric_limits<std::uint64_t>::max());
  const auto seats = static_cast<std::size_t>(from.number(scenes::kSeatsMax));
  const bool begun = !from.failed() && frame.tick != 0 && seats <= from.bytes_left();
  if (begun) frame.seats.reserve(seats);
  for (std::size_t i = 0; begun && i < seats && !from.failed(); ++i) {
    frame.seats.push_back(from.seat());
  }
  const bool more = begun && !from.failed() && !from.at_end();
  const std::uint64_t events = more ? from.number(kFrameEventsMax) : 0;
  for (std::uint64_t i = 0; i < events && !from.failed(); ++i) {
    frame.events.push_back(from.event(seats));
  }
  const std::uint64_t changes = more ? from.number(kFrameChangesMax) : 0;
  for (std::uint64_t i = 0; i < changes && !from.failed(); ++i) {
    frame.changes.push_back(from.change());
  }
  const bool empty_end = more && events == 0 && changes == 0;
  if (begun && !from.failed() && from.at_end() && !empty_end) return frame;
  error = "a packed frame of " + std::to_string(bytes.size()) + " bytes that is none, near byte " +
          std::to_string(bytes.size() - from.bytes_left());
  return std::nullopt;
}

}  // namespace cycloid::protocol
