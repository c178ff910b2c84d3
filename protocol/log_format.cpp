#include "protocol/log_format.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "protocol/crc32c.hpp"
#include "protocol/little_endian.hpp"

namespace cycloid::protocol {
namespace {

// docs/protocol.md has the format byte by byte.

constexpr std::array<char, 8> kMagic = {'C', 'Y', 'C', 'L', 'O', 'G', '\r', '\n'};
constexpr std::uint32_t kFormatVersion = 1;
constexpr std::size_t kHeaderFixedBytes = 16;  ///< Magic, format version, payload size.
constexpr std::size_t kHeaderPayloadBytesMin = 32;
constexpr std::size_t kRecordFixedBytes = 5;  ///< Payload size, kind.
constexpr std::size_t kCheckBytes = 4;
constexpr std::size_t kTickFixedBytes = 20;
constexpr std::size_t kSeatBytes = 11;
constexpr std::size_t kEventBytes = 3;
constexpr std::size_t kFooterBytes = 16;

enum class Kind : std::uint8_t { kTick = 1, kFooter = 2 };

/// Over the salt, the check before, then the record from its size to the end of its payload.
std::uint32_t record_check(std::uint64_t salt, std::uint32_t before,
                           std::span<const std::byte> record) {
  std::array<std::byte, 12> chain{};
  solver::store_little(salt, chain.data());
  solver::store_little(before, chain.data() + 8);
  return crc32c(record, crc32c(chain));
}

std::size_t begin_record(Kind kind, std::size_t payload_bytes, Bytes& into) {
  const std::size_t begin = into.size();
  append_little(static_cast<std::uint32_t>(payload_bytes), into);
  append_little(static_cast<std::uint8_t>(kind), into);
  return begin;
}

std::size_t tick_bytes(std::size_t seats, std::size_t events) {
  return kTickFixedBytes + seats * kSeatBytes + events * kEventBytes;
}

void append_frame(const InputFrame& frame, Bytes& into) {
  append_little(static_cast<std::uint16_t>(frame.seats.size()), into);
  append_little(static_cast<std::uint16_t>(frame.events.size()), into);
  for (const SeatFrame& seat : frame.seats) {
    append_little(static_cast<std::uint8_t>(seat.origin), into);
    for (const std::int16_t axis : seat.input.axes) {
      append_little(static_cast<std::uint16_t>(axis), into);
    }
    append_little(seat.input.buttons, into);
  }
  for (const FrameEvent& event : frame.events) {
    append_little(static_cast<std::uint8_t>(event.kind), into);
    append_little(event.seat, into);
  }
}

/// One record where it stands: its extent is plausible and its check is right, or it is none.
struct Record {
  Kind kind = Kind::kTick;
  std::span<const std::byte> payload;
  std::size_t bytes = 0;
  std::uint32_t check = 0;
};

/// How long the record at `at` says it is, check included; nothing if no record is that long.
std::optional<std::size_t> record_bytes(std::span<const std::byte> log, std::size_t at) {
  LittleReader reader{log.subspan(at)};
  const auto payload_bytes = reader.take<std::uint32_t>();
  const auto kind = static_cast<Kind>(reader.take<std::uint8_t>());
  std::size_t expected = kFooterBytes;
  if (kind == Kind::kTick) {
    (void)reader.take_bytes(16);
    const auto seats = reader.take<std::uint16_t>();
    const auto events = reader.take<std::uint16_t>();
    if (seats > scenes::kSeatsMax || events > kFrameEventsMax) return {};
    expected = tick_bytes(seats, events);
  } else if (kind != Kind::kFooter) {
    return {};
  }
  if (reader.failed || payload_bytes != expected) return {};
  const std::size_t bytes = kRecordFixedBytes + expected + kCheckBytes;
  if (bytes > log.size() - at) return {};
  return bytes;
}

/// The check that the content of a record of plausible extent should have.
std::uint32_t computed_check(std::span<const std::byte> log, std::size_t at, std::size_t bytes,
                             std::uint64_t salt, std::uint32_t before) {
  return record_check(salt, before, log.subspan(at, bytes - kCheckBytes));
}

std::optional<Record> record_at(std::span<const std::byte> log, std::size_t at, std::uint64_t salt,
                                std::uint32_t before) {
  const auto bytes = record_bytes(log, at);
  if (!bytes) return {};
  Record record;
  record.bytes = *bytes;
  record.check = solver::load_little<std::uint32_t>(log.data() + at + *bytes - kCheckBytes);
  if (computed_check(log, at, *bytes, salt, before) != record.check) return {};
  record.kind = static_cast<Kind>(log[at + 4]);
  record.payload = log.subspan(at + kRecordFixedBytes, *bytes - kRecordFixedBytes - kCheckBytes);
  return record;
}

/// Whether a whole record of this log stands anywhere after the damaged one at `at`: then the
/// damage is not the end of an interrupted write. The check before a candidate is read from the
/// bytes before it; where those are what is damaged, it is computed.
bool valid_record_follows(std::span<const std::byte> log, std::size_t at, std::uint64_t salt,
                          std::uint32_t before) {
  if (const auto bytes = record_bytes(log, at); bytes && *bytes < log.size() - at) {
    const std::uint32_t check = computed_check(log, at, *bytes, salt, before);
    if (record_at(log, at + *bytes, salt, check)) return true;
  }
  for (std::size_t next = at + 1; next < log.size(); ++next) {
    const auto stored = solver::load_little<std::uint32_t>(log.data() + next - kCheckBytes);
    if (record_at(log, next, salt, stored)) return true;
  }
  return false;
}

/// The tick of a record whose extent and check are right; nothing if its values are not.
std::optional<LogTick> read_tick(std::span<const std::byte> payload) {
  LittleReader reader{payload};
  LogTick tick;
  tick.frame.tick = reader.take<std::uint64_t>();
  tick.digest = reader.take<std::uint64_t>();
  const auto seats = reader.take<std::uint16_t>();
  const auto events = reader.take<std::uint16_t>();
  tick.frame.seats.resize(seats);
  for (SeatFrame& seat : tick.frame.seats) {
    seat.origin = static_cast<Origin>(reader.take<std::uint8_t>());
    for (std::int16_t& axis : seat.input.axes) {
      axis = static_cast<std::int16_t>(reader.take<std::uint16_t>());
    }
    seat.input.buttons = reader.take<std::uint16_t>();
    if (seat.origin < Origin::kGiven || seat.origin > Origin::kAbsent) return {};
  }
  tick.frame.events.resize(events);
  for (FrameEvent& event : tick.frame.events) {
    event.kind = static_cast<EventKind>(reader.take<std::uint8_t>());
    event.seat = reader.take<std::uint16_t>();
    if (event.kind != EventKind::kJoin && event.kind != EventKind::kLeave) return {};
    if (event.seat >= seats) return {};
  }
  return tick;
}

std::string at_byte(std::size_t at) {
  return " at byte " + std::to_string(at);
}

/// Reads one log from front to back.
class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  Log read() {
    if (!read_header()) return std::move(log_);
    while (at_ < bytes_.size()) {
      if (log_.footer) return corrupt("bytes after the footer" + at_byte(at_));
      const auto record = record_at(bytes_, at_, log_.header.salt, check_);
      if (!record) return damaged();
      if (!take(*record)) return std::move(log_);
      at_ += record->bytes;
      check_ = record->check;
      log_.good_bytes = at_;
    }
    log_.state = log_.footer ? LogState::kComplete : LogState::kOpen;
    if (!log_.footer) log_.reason = "no footer" + at_byte(at_);
    return std::move(log_);
  }

 private:
  Log corrupt(std::string reason) {
    log_.state = LogState::kCorrupt;
    log_.reason = std::move(reason);
    return std::move(log_);
  }

  Log damaged() {
    const bool follows = valid_record_follows(bytes_, at_, log_.header.salt, check_);
    log_.state = follows ? LogState::kCorrupt : LogState::kTorn;
    log_.reason = (follows ? "a damaged record" : "a cut or damaged last record") + at_byte(at_);
    return std::move(log_);
  }

  bool read_header() {
    log_.state = LogState::kCorrupt;
    const auto* magic = reinterpret_cast<const std::byte*>(kMagic.data());
    if (bytes_.size() < kHeaderFixedBytes || !std::equal(magic, magic + 8, bytes_.begin())) {
      log_.reason = "not a log: no header at byte 0";
      return false;
    }
    LittleReader reader{bytes_.subspan(kMagic.size())};
    const auto format = reader.take<std::uint32_t>();
    const std::size_t payload_bytes = reader.take<std::uint32_t>();
    if (format != kFormatVersion) return incompatible("log format", format, kFormatVersion);
    const std::size_t header_bytes = kHeaderFixedBytes + payload_bytes;
    if (payload_bytes < kHeaderPayloadBytesMin || bytes_.size() < header_bytes + kCheckBytes) {
      log_.reason = "a header that is cut or damaged, at byte 0";
      return false;
    }
    check_ = crc32c(bytes_.first(header_bytes));
    if (solver::load_little<std::uint32_t>(bytes_.data() + header_bytes) != check_ ||
        !read_header_payload(bytes_.subspan(kHeaderFixedBytes, payload_bytes))) {
      log_.reason = "a damaged header, at byte 0";
      return false;
    }
    const LogHeader& header = log_.header;
    if (header.protocol_version != kProtocolVersion) {
      return incompatible("protocol version", header.protocol_version, kProtocolVersion);
    }
    if (header.solver_version != solver::kSolverVersion) {
      return incompatible("solver version", header.solver_version, solver::kSolverVersion);
    }
    at_ = header_bytes + kCheckBytes;
    log_.good_bytes = at_;
    return true;
  }

  bool read_header_payload(std::span<const std::byte> payload) {
    LittleReader reader{payload};
    LogHeader& header = log_.header;
    header.protocol_version = reader.take<std::uint32_t>();
    header.solver_version = reader.take<std::uint32_t>();
    header.scene_digest = reader.take<std::uint64_t>();
    header.salt = reader.take<std::uint64_t>();
    const auto name = reader.take_bytes(reader.take<std::uint32_t>());
    const auto scene = reader.take_bytes(reader.take<std::uint32_t>());
    header.scene_name.assign(reinterpret_cast<const char*>(name.data()), name.size());
    header.scene.assign(scene.begin(), scene.end());
    return !reader.failed && reader.bytes.empty();
  }

  bool incompatible(const std::string& what, std::uint32_t theirs, std::uint32_t ours) {
    log_.state = LogState::kIncompatible;
    log_.reason = what + " " + std::to_string(theirs) + ", here " + std::to_string(ours);
    return false;
  }

  /// A record whose check is right; false, and the log is corrupt, if it makes no sense here.
  bool take(const Record& record) {
    if (record.kind == Kind::kFooter) {
      LittleReader reader{record.payload};
      LogFooter footer;
      footer.ticks = reader.take<std::uint64_t>();
      footer.digest = reader.take<std::uint64_t>();
      const bool fits = footer.ticks == log_.ticks.size() &&
                        (log_.ticks.empty() || log_.ticks.back().digest == footer.digest);
      if (fits) log_.footer = footer;
      if (!fits) (void)fail("a footer of another match");
      return fits;
    }
    auto tick = read_tick(record.payload);
    if (!tick) return fail("a tick with values out of range");
    if (tick->frame.tick != log_.ticks.size() + 1) {
      return fail("tick " + std::to_string(tick->frame.tick) + " instead of " +
                  std::to_string(log_.ticks.size() + 1));
    }
    log_.ticks.push_back(std::move(*tick));
    return true;
  }

  bool fail(const std::string& what) {
    log_.state = LogState::kCorrupt;
    log_.reason = what + at_byte(at_);
    return false;
  }

  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
  std::uint32_t check_ = 0;
  Log log_;
};

}  // namespace

LogEncoder::LogEncoder(const LogHeader& header, Bytes& into) : salt_(header.salt) {
  const std::size_t begin = into.size();
  const std::size_t payload_bytes =
      kHeaderPayloadBytesMin + header.scene_name.size() + header.scene.size();
  const auto* magic = reinterpret_cast<const std::byte*>(kMagic.data());
  into.insert(into.end(), magic, magic + kMagic.size());
  append_little(kFormatVersion, into);
  append_little(static_cast<std::uint32_t>(payload_bytes), into);
  append_little(header.protocol_version, into);
  append_little(header.solver_version, into);
  append_little(header.scene_digest, into);
  append_little(header.salt, into);
  append_little(static_cast<std::uint32_t>(header.scene_name.size()), into);
  const auto* name = reinterpret_cast<const std::byte*>(header.scene_name.data());
  into.insert(into.end(), name, name + header.scene_name.size());
  append_little(static_cast<std::uint32_t>(header.scene.size()), into);
  into.insert(into.end(), header.scene.begin(), header.scene.end());
  check_ = crc32c(std::span<const std::byte>(into).subspan(begin));
  append_little(check_, into);
}

void LogEncoder::tick(const LogTick& tick, Bytes& into) {
  const InputFrame& frame = tick.frame;
  const std::size_t begin =
      begin_record(Kind::kTick, tick_bytes(frame.seats.size(), frame.events.size()), into);
  append_little(frame.tick, into);
  append_little(tick.digest, into);
  append_frame(frame, into);
  check_ = record_check(salt_, check_, std::span<const std::byte>(into).subspan(begin));
  append_little(check_, into);
}

void LogEncoder::footer(const LogFooter& footer, Bytes& into) {
  const std::size_t begin = begin_record(Kind::kFooter, kFooterBytes, into);
  append_little(footer.ticks, into);
  append_little(footer.digest, into);
  check_ = record_check(salt_, check_, std::span<const std::byte>(into).subspan(begin));
  append_little(check_, into);
}

Log read_log(std::span<const std::byte> bytes) {
  return Reader(bytes).read();
}

}  // namespace cycloid::protocol
