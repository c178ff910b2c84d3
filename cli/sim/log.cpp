#include "cli/sim/log.hpp"

#include <span>
#include <utility>

namespace cycloid::sim {
namespace {

constexpr std::uint64_t kTickOfPlant = 30;

}  // namespace

SimLog::SimLog(SimDisk& disk, std::uint64_t file, const protocol::LogHeader& header,
               const Options& options, Chronicle& chronicle)
    : disk_(&disk), file_(file), options_(options), chronicle_(&chronicle) {
  encoder_.emplace(header, queue_);
  disk_->create(file_, queue_);
  queue_.clear();
  next_sync_ns_ = chronicle_->now_ns + options_.interval_ns;
}

void SimLog::tick(const protocol::LogTick& tick) {
  if (!durable() || closed_) return;
  const std::uint64_t number = tick.frame.tick;
  if (options_.plant == Plant::kLogDropsRecord && number == kTickOfPlant) return;
  if (options_.plant == Plant::kLogSwapsRecords && number == kTickOfPlant) {
    kept_ = tick;
    return;
  }
  hand_over(tick);
  if (kept_) hand_over(*std::exchange(kept_, std::nullopt));
  if (options_.mode != LogMode::kEveryTick) return;
  write();
  sync();
}

void SimLog::hand_over(const protocol::LogTick& tick) {
  encoder_->tick(tick, queue_);
  ticks_ = tick.frame.tick;
  if (queue_.size() > options_.queue_bytes_max) fail("the disk does not keep up");
}

void SimLog::close(const protocol::LogFooter& footer) {
  if (durable() && !closed_) {
    encoder_->footer(footer, queue_);
    write();
    sync();
  }
  closed_ = true;
}

void SimLog::work() {
  if (!durable() || closed_ || disk_->stalled()) return;
  write();
  if (chronicle_->now_ns < next_sync_ns_) return;
  next_sync_ns_ = chronicle_->now_ns + options_.interval_ns;
  if (synced_ticks_ != written_ticks_) sync();
}

void SimLog::write() {
  std::size_t done = 0;
  while (durable() && done < queue_.size()) {
    const DiskWrite wrote = disk_->write(file_, std::span<const std::byte>(queue_).subspan(done));
    done += wrote.bytes;
    if (wrote.error == DiskError::kInputOutput) fail("write: input/output error");
    if (wrote.error == DiskError::kNoSpace) fail("write: no space left");
  }
  queue_.clear();
  if (durable() && !disk_->killed()) written_ticks_ = ticks_;
}

void SimLog::sync() {
  DiskError error = DiskError::kInterrupted;
  while (durable() && error == DiskError::kInterrupted) error = disk_->sync(file_);
  if (error == DiskError::kInputOutput) fail("sync: input/output error");
  if (durable() && !disk_->killed()) synced_ticks_ = written_ticks_;
}

void SimLog::fail(const std::string& what) {
  if (!error_.empty()) return;
  error_ = what;
  chronicle_->note("the log has ended: " + what);
}

std::optional<std::string> log_mistake(const LogFound& found, const protocol::Bytes& bytes) {
  using protocol::LogState;
  const protocol::Log read = protocol::read_log(bytes);
  if (const auto differs = found.ledger->not_a_prefix(read.ticks)) return "the log: " + *differs;

  const bool power_cut = found.death == Death::kPower;
  const std::uint64_t owed = power_cut ? found.log->synced_ticks() : found.log->written_ticks();
  if (read.ticks.size() < owed) {
    return "the log has " + std::to_string(read.ticks.size()) + " ticks, of " +
           std::to_string(owed) + " that it said to have" +
           (read.reason.empty() ? "" : "; " + read.reason);
  }
  const bool torn_may_be = found.death || !found.log->durable();
  const bool good = read.state == LogState::kComplete || read.state == LogState::kOpen ||
                    (read.state == LogState::kTorn && torn_may_be) ||
                    (read.state == LogState::kCorrupt && power_cut);
  if (!good) return "the log is not whole: " + read.reason;
  if (found.log->closed() && found.log->durable() && !found.death &&
      read.state != LogState::kComplete) {
    return "the log was closed, but says: " + read.reason;
  }
  return {};
}

std::optional<std::string> flip_mistake(const Ledger& ledger, const protocol::Bytes& bytes) {
  const protocol::Log read = protocol::read_log(bytes);
  const bool seen =
      read.state != protocol::LogState::kComplete && read.state != protocol::LogState::kOpen;
  if (!seen) return "a flipped bit of the log is not seen";
  if (const auto differs = ledger.not_a_prefix(read.ticks)) return "a flipped bit: " + *differs;
  return {};
}

}  // namespace cycloid::sim
