#include "cli/log_file.hpp"

#include <iostream>
#include <utility>

#include "cli/files.hpp"
#include "cli/output.hpp"

namespace cycloid::cli {

using protocol::LogState;

std::string LoadedLog::blemish() const {
  if (log.state == LogState::kComplete) return "";
  const char* name = log.state == LogState::kOpen      ? "not closed"
                     : log.state == LogState::kCorrupt ? "salvaged"
                                                       : "torn";
  std::string text =
      std::string(name) + " after " + std::to_string(log.tick_count()) + " good ticks";
  if (!log.reason.empty()) text += ": " + log.reason;
  if (log.lost_bytes != 0)
    text += "; the " + std::to_string(log.lost_bytes) + " bytes behind byte " +
            std::to_string(log.good_bytes) + " are lost";
  if (log.tick_behind && *log.tick_behind > log.last_tick + 1)
    text += ", ticks " + std::to_string(log.last_tick + 1) + " to at least " +
            std::to_string(*log.tick_behind - 1);
  return text;
}

Exit LoadedLog::exit() const {
  return log.state == LogState::kTorn && !salvaged ? kExitCorrupt : kExitGood;
}

bool is_log_file(const std::string& file) {
  constexpr std::size_t kWordsBytes = 16;  // More than those with which a log begins.
  return kind_of(file).is_file && protocol::looks_like_log(read_beginning(file, kWordsBytes));
}

std::vector<std::byte> read_log_bytes(const std::string& file) {
  if (kind_of(file).is_device) throw Failure(kExitIo, file + ": is a device, not a file");
  return read_file(file);
}

LoadedLog load_log(const std::string& file, const LoadOptions& options) {
  return parse_log(file, read_log_bytes(file), options);
}

LoadedLog parse_log(const std::string& file, std::span<const std::byte> bytes,
                    const LoadOptions& options) {
  protocol::LogSummary log = protocol::scan_log(bytes);
  const bool damaged = log.state == LogState::kCorrupt || log.state == LogState::kTorn;
  const bool salvaged = options.salvage && damaged && log.good_bytes != 0;
  if (log.state == LogState::kCorrupt && !salvaged) {
    const bool helps = log.good_bytes != 0 && log.tick_count() != 0;
    throw Failure(kExitCorrupt,
                  file + ": corrupt: " + log.reason +
                      (helps ? "; --salvage takes the " + std::to_string(log.tick_count()) +
                                   " good ticks before"
                             : ""));
  }
  if (log.state == LogState::kIncompatible)
    throw Failure(kExitIncompatible, file + ": incompatible: " + log.reason);
  scenes::Loaded loaded = scenes::from_binary(log.header.scene);
  if (!loaded.scene) throw Failure(kExitCorrupt, mistakes_text(file + ": scene", loaded.mistakes));
  const std::uint64_t digest = scenes::scene_digest(*loaded.scene);
  if (digest != log.header.scene_digest) {
    throw Failure(kExitIncompatible, file + ": the scene's digest is " + hex16(digest) +
                                         " here, the log says " + hex16(log.header.scene_digest));
  }
  const auto good = bytes.first(static_cast<std::size_t>(log.good_bytes));
  return {file, std::move(log),
          std::make_shared<const std::vector<std::byte>>(good.begin(), good.end()),
          std::move(*loaded.scene), salvaged};
}

void print_blemish(const LoadedLog& loaded) {
  const std::string blemish = loaded.blemish();
  if (!blemish.empty()) std::cerr << "cycloid: " << loaded.file << ": " << blemish << '\n';
}

TickReader::TickReader(const LoadedLog& loaded)
    : bytes_(loaded.bytes), start_(loaded.log.start), keyframes_(loaded.log.keyframes) {}

void TickReader::rewind(std::uint64_t tick) {
  const protocol::KeyframePlace* from = nullptr;
  for (const protocol::KeyframePlace& place : keyframes_)
    if (place.tick < tick) from = &place;
  if (from == nullptr)
    cursor_.emplace(*bytes_, start_);
  else
    cursor_.emplace(*bytes_, start_, *from);
}

const protocol::LogTick& TickReader::at(std::uint64_t tick) {
  if (cursor_ && cursor_->last_tick() == tick) return cursor_->tick();
  if (!cursor_ || cursor_->last_tick() > tick) rewind(tick);
  while (cursor_->last_tick() < tick)
    if (cursor_->next() == protocol::LogCursor::Step::kEnd)
      throw Failure(kExitUsage, "there is no tick " + std::to_string(tick));
  return cursor_->tick();
}

}  // namespace cycloid::cli
