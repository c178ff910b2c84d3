#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "protocol/log_format.hpp"
#include "scenes/catalogue.hpp"
#include "tests/cli/program.hpp"

namespace cycloid::cli {

inline void write_bytes(const std::string& file, const protocol::Bytes& bytes) {
  write_text(file, std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
}

/// Reads a log, lets `change` have its way with it, and writes it again with checks that fit. The
/// keyframes are left out.
inline void rewrite_log(const std::string& from, const std::string& to,
                        const std::function<void(protocol::Log&)>& change) {
  const std::string text = read_text(from);
  const auto* begin = reinterpret_cast<const std::byte*>(text.data());
  protocol::Log log = protocol::read_log({begin, text.size()});
  change(log);
  protocol::Bytes bytes;
  protocol::LogEncoder encoder(log.header, bytes);
  for (const protocol::LogTick& tick : log.ticks) encoder.tick(tick, bytes);
  if (log.footer) encoder.footer(*log.footer, bytes);
  write_bytes(to, bytes);
}

/// From a tick on one seat more than the scene has: no world steps to it.
inline void add_seat(std::uint64_t from, protocol::Log& log) {
  for (protocol::LogTick& tick : log.ticks)
    if (tick.frame.tick >= from) tick.frame.seats.emplace_back();
}

/// What may be done to the records of a log, in their order.
struct RecordChanges {
  std::function<void(protocol::LogTick&)> tick = [](protocol::LogTick&) {};
  std::function<void(protocol::LogKeyframe&)> keyframe = [](protocol::LogKeyframe&) {};
};

/// Writes a whole log again, with its keyframes, with checks and a footer that fit.
inline void rewrite_records(const std::string& file, const RecordChanges& change) {
  const std::string text = read_text(file);
  const auto read = std::as_bytes(std::span(text));
  const protocol::LogSummary log = protocol::scan_log(read);
  protocol::LogFooter footer = log.footer.value();
  protocol::Bytes bytes;
  protocol::LogEncoder encoder(log.header, bytes);
  protocol::LogCursor cursor(read, log.start);
  using Step = protocol::LogCursor::Step;
  for (Step step = cursor.next(); step != Step::kEnd; step = cursor.next()) {
    if (step == Step::kTick) {
      protocol::LogTick tick = cursor.tick();
      change.tick(tick);
      encoder.tick(tick, bytes);
      footer.digest = tick.digest;
    } else if (step == Step::kKeyframe) {
      protocol::LogKeyframe keyframe = cursor.keyframe();
      change.keyframe(keyframe);
      encoder.keyframe(keyframe.digest, keyframe.state, bytes);
    }
  }
  encoder.footer(footer, bytes);
  write_bytes(file, bytes);
}

}  // namespace cycloid::cli
