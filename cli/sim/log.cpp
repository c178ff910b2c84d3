#include "cli/sim/log.hpp"

#include <utility>
#include <vector>

namespace cycloid::sim {
namespace {

constexpr std::uint64_t kTickOfPlant = 30;

}  // namespace

SimLog::SimLog(SimDisk& disk, std::uint64_t first_file, const protocol::LogHeader& header,
               const Options& options, Chronicle& chronicle)
    : machine_(&disk),
      options_(options),
      chronicle_(&chronicle),
      disk_(std::make_shared<LogDisk>(disk, first_file, options.plant)),
      header_(header) {
  open("0", nullptr);
}

void SimLog::open(const std::string& path, const protocol::LogKeyframe* first) {
  server::LogWriterOptions writing;
  writing.path = path;
  writing.sync = options_.sync;
  writing.interval = std::chrono::milliseconds(options_.interval_ns / kMillisecond);
  writing.queue_bytes_max = options_.queue_bytes_max;
  writing.keyframes = {options_.keyframe_ticks, std::uint64_t{1} << 20};
  writing.disk = disk_;
  writing.threaded = false;
  writing.now_ns = [this] { return chronicle_->now_ns; };
  writing.unix_now_ns = writing.now_ns;
  writing.random = [number = header_.salt]() mutable { return number = scramble(number + 1); };
  writer_ = std::make_unique<server::LogWriter>(std::move(writing), header_, first);
}

void SimLog::branch(const protocol::LogTick& from, std::span<const std::byte> state) {
  header_.parent_log_id = writer_->log_id();
  close(last_);
  if (!durable() || machine_->killed()) return;
  closed_ = false;
  header_.salt = scramble(header_.salt + 2);
  header_.log_id = scramble(header_.salt + 3);
  header_.branch_tick = ticks_ = from.frame.tick;
  last_ = {ticks_, from.digest, {}};
  const protocol::LogKeyframe first{
      ticks_, from.digest, from.frame.seats, {state.begin(), state.end()}};
  branches_.push_back({files().size(), ticks_});
  open("branch " + std::to_string(branches_.size()), &first);
  written_ticks_ = synced_ticks_ = ticks_;
}

void SimLog::tick(const protocol::LogTick& tick) {
  if (closed_) return;
  const std::uint64_t number = tick.frame.tick;
  if (options_.plant == Plant::kLogDropsRecord && number == kTickOfPlant) return;
  if (options_.plant == Plant::kLogSwapsRecords && number == kTickOfPlant) {
    kept_ = tick;
    return;
  }
  hand_over(tick);
  if (kept_) hand_over(*std::exchange(kept_, std::nullopt));
}

void SimLog::hand_over(const protocol::LogTick& tick) {
  if (ticks_ == synced_ticks_) unsynced_since_ns_ = chronicle_->now_ns;
  const std::uint64_t syncs_before = disk_->syncs();
  writer_->tick(tick);
  ticks_ = tick.frame.tick;
  last_ = {ticks_, tick.digest, {}};
  if (options_.sync == server::LogSync::kEveryTick) take_note(syncs_before);
}

void SimLog::keyframe(std::uint64_t tick, std::uint64_t digest, std::span<const std::byte> state) {
  std::vector<std::byte> said(state.begin(), state.end());
  if (options_.plant == Plant::kLogSpoilsKeyframe) said[said.size() / 2] ^= std::byte{4};
  writer_->keyframe(tick, digest, said);
}

void SimLog::close(const protocol::LogFooter& footer) {
  const std::uint64_t syncs_before = disk_->syncs();
  if (!std::exchange(closed_, true)) writer_->close(footer);
  take_note(syncs_before);
}

void SimLog::turn() {
  if (!durable() || closed_ || machine_->stalled()) return;
  const std::uint64_t syncs_before = disk_->syncs();
  writer_->turn();
  take_note(syncs_before);
  const bool in_time = options_.sync != server::LogSync::kInterval || !durable() ||
                       machine_->killed() || synced_ticks_ == ticks_ ||
                       chronicle_->now_ns < unsynced_since_ns_ + options_.interval_ns;
  if (in_time) return;
  chronicle_->violate(Invariant::kLog, "tick " + std::to_string(synced_ticks_ + 1) +
                                           " waits for a sync for longer than the interval");
}

void SimLog::take_note(std::uint64_t syncs_before) {
  if (!durable() || machine_->killed()) return;
  written_ticks_ = ticks_;
  if (disk_->syncs() != syncs_before) synced_ticks_ = ticks_;
}

void SimLog::rotate() {
  if (closed_ || !durable()) return;
  if (writer_->rotate(std::to_string(rotations_ + 1))) return;  // The last one is not done yet.
  ++rotations_;
  chronicle_->count(Event::kRotation);
  chronicle_->note("the log is to go on in another file");
}

namespace {

/// What a file of the log goes on from.
struct LogOrigin {
  std::uint64_t tick = 0;
  std::uint64_t parent = 0;
  std::size_t timeline = 0;
};

/// Of the log's file of that place, as far as the log itself says; else behind the one before.
LogOrigin origin_of(const SimLog& log, std::size_t file, const LogOrigin& behind) {
  const auto& branches = log.branches();
  const std::size_t timeline = behind.timeline;
  const bool branched = timeline < branches.size() && branches[timeline].file == file;
  return branched ? LogOrigin{branches[timeline].tick, behind.parent, timeline + 1} : behind;
}

/// The parts before the last: whole, whatever happened since, and each going on from the one
/// before.
std::optional<std::string> older_mistake(const Ledger& ledger, const protocol::Log& part,
                                         const LogOrigin& origin) {
  if (part.state != protocol::LogState::kComplete) return "an older log: " + part.reason;
  if (part.header.branch_tick != origin.tick) return "an older log goes on from another tick";
  if (part.header.parent_log_id != origin.parent) return "an older log names another parent";
  if (const auto differs = ledger.not_a_prefix(part.ticks, origin.tick, origin.timeline))
    return "an older log: " + *differs;
  return {};
}

bool is_good(const LogFound& found, protocol::LogState state) {
  using protocol::LogState;
  const bool power_cut = found.death == Death::kPower;
  const bool torn_may_be = found.death || !found.log->durable();
  return state == LogState::kComplete || state == LogState::kOpen ||
         (state == LogState::kTorn && torn_may_be) || (state == LogState::kCorrupt && power_cut);
}

}  // namespace

std::optional<std::string> log_mistake(const LogFound& found, const SimDisk& disk) {
  using protocol::LogState;
  const std::vector<std::uint64_t>& files = found.log->files();
  LogOrigin origin;
  for (std::size_t i = 0; i + 1 < files.size(); ++i) {
    origin = origin_of(*found.log, i, origin);
    const protocol::Log part = protocol::read_log(disk.content(files[i]));
    if (const auto mistake = older_mistake(*found.ledger, part, origin)) return mistake;
    origin = {part.last_tick, part.header.log_id, origin.timeline};
  }
  origin = origin_of(*found.log, files.size() - 1, origin);
  const protocol::Log read = protocol::read_log(disk.content(files.back()));
  if (read.header.branch_tick != origin.tick || read.header.parent_log_id != origin.parent)
    return "the log does not go on from the one before";
  if (const auto differs = found.ledger->not_a_prefix(read.ticks, origin.tick, origin.timeline))
    return "the log: " + *differs;

  const bool power_cut = found.death == Death::kPower;
  const std::uint64_t owed = power_cut ? found.log->synced_ticks() : found.log->written_ticks();
  if (read.last_tick < owed) {
    return "the log has " + std::to_string(read.last_tick) + " ticks, of " + std::to_string(owed) +
           " that it said to have" + (read.reason.empty() ? "" : "; " + read.reason);
  }
  if (!is_good(found, read.state)) return "the log is not whole: " + read.reason;
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
  // A log that has ended for a full disk stays in its timeline.
  for (std::size_t timeline = 0; timeline <= ledger.timeline(); ++timeline) {
    if (!ledger.not_a_prefix(read.ticks, read.header.branch_tick, timeline)) return {};
  }
  return "a flipped bit gives ticks that were not confirmed";
}

std::optional<std::string> seek_mistake(const protocol::Bytes& bytes, scenes::Simulation fresh) {
  const protocol::LogSummary log = protocol::scan_log(bytes);
  if (log.keyframes.empty()) return {};
  const std::span<const std::byte> good =
      std::span(bytes).first(static_cast<std::size_t>(log.good_bytes));
  protocol::LogCursor cursor(good, log.start, log.keyframes.back());
  (void)cursor.next();
  const protocol::LogKeyframe& keyframe = cursor.keyframe();
  const std::string name = "the keyframe of tick " + std::to_string(keyframe.tick);
  if (!fresh.decode(keyframe.state).ok() || fresh.digest() != keyframe.digest)
    return name + " is not the state of its tick";
  std::vector<scenes::SeatInput> inputs;
  while (cursor.next() == protocol::LogCursor::Step::kTick) {
    inputs.clear();
    for (const protocol::SeatFrame& seat : cursor.tick().frame.seats) inputs.push_back(seat.input);
    if (!fresh.step(inputs).ok() || fresh.digest() != cursor.tick().digest)
      return name + ": a replay from there diverges at tick " + std::to_string(fresh.tick());
  }
  return {};
}

}  // namespace cycloid::sim
