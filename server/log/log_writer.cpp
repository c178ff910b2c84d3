#include "server/log/log_writer.hpp"

#include <algorithm>
#include <utility>

#include "server/log/random_number.hpp"

namespace cycloid::server {
namespace {

template <class Clock>
std::int64_t clock_ns() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch())
      .count();
}

/// A name beside the log's that no other process takes.
std::string temporary_name(const std::string& path, std::uint64_t number) {
  return path + "." + std::to_string(number) + ".tmp";
}

}  // namespace

LogSync log_sync_of(const std::string& word) {
  const auto found = std::find(kLogSyncNames.begin(), kLogSyncNames.end(), word);
  return static_cast<LogSync>(found - kLogSyncNames.begin());
}

LogWriter::LogWriter(LogWriterOptions options, const protocol::LogHeader& header,
                     const protocol::LogKeyframe* first)
    : options_(std::move(options)), header_(header) {
  if (!options_.now_ns) options_.now_ns = clock_ns<std::chrono::steady_clock>;
  if (!options_.unix_now_ns) options_.unix_now_ns = clock_ns<std::chrono::system_clock>;
  if (!options_.random) options_.random = random_number;
  encoder_.emplace(header_, record_);
  if (first != nullptr) encoder_->first_keyframe(*first, record_);
  file_ = new_file(options_.path);
  if (!file_->create() || !file_->append(record_) || !file_->publish())
    throw std::system_error(file_->code(), std::generic_category(), options_.path);
  next_keyframe_ = header_.branch_tick + options_.keyframes.ticks_min;
  next_sync_ns_ = options_.now_ns() + std::chrono::nanoseconds(options_.interval).count();
  if (options_.threaded) thread_ = std::thread([this] { run(); });
}

LogWriter::~LogWriter() {
  stop();
}

std::unique_ptr<LogFile> LogWriter::new_file(const std::string& path) const {
  return std::make_unique<LogFile>(options_.disk, path, temporary_name(path, options_.random()));
}

void LogWriter::tick(const protocol::LogTick& tick) {
  record_.clear();
  encoder_->tick(tick, record_);
  hand_over(options_.sync == LogSync::kEveryTick);
}

bool LogWriter::wants_keyframe(std::uint64_t tick) const {
  if (failed_) return false;
  return rotating_ != nullptr || (options_.keyframes.bytes_per_tick != 0 && tick >= next_keyframe_);
}

void LogWriter::keyframe(std::uint64_t tick, std::uint64_t digest,
                         std::span<const std::byte> state) {
  if (failed_) return;
  const KeyframePolicy& policy = options_.keyframes;
  if (policy.bytes_per_tick != 0)
    next_keyframe_ = tick + std::max(policy.ticks_min, state.size() / policy.bytes_per_tick);
  if (rotating_) return turn_over(tick, digest, state);
  record_.clear();
  encoder_->keyframe(digest, state, record_);
  hand_over(false);
}

std::error_code LogWriter::rotate(const std::string& path) {
  const auto why = [](std::errc code) { return std::make_error_code(code); };
  if (failed_) return why(std::errc::io_error);
  {
    const std::scoped_lock lock(mutex_);
    if (rotating_ || next_) return why(std::errc::device_or_resource_busy);
  }
  std::unique_ptr<LogFile> file = new_file(path);
  if (!file->create()) return {file->code(), std::generic_category()};
  rotating_ = std::move(file);
  return {};
}

/// The footer of the old file and the header and keyframe of the new one, in one go.
void LogWriter::turn_over(std::uint64_t tick, std::uint64_t digest,
                          std::span<const std::byte> state) {
  record_.clear();
  encoder_->footer({tick, digest, {}}, record_);
  hand_over(false);

  header_.parent_log_id = std::exchange(header_.log_id, options_.random());
  header_.branch_tick = tick;
  header_.salt = options_.random();
  header_.start_unix_ns = options_.unix_now_ns();
  const protocol::LogKeyframe first{tick, digest, encoder_->seats(), {state.begin(), state.end()}};
  record_.clear();
  encoder_.emplace(header_, record_);
  encoder_->first_keyframe(first, record_);
  const std::scoped_lock lock(mutex_);
  options_.path = rotating_->path();
  std::unique_ptr<LogFile> file = std::move(rotating_);
  if (failed_ || stop_) return;
  // In one go with its first bytes, which any queue has room for: the writer must not find the
  // file, and publish it, before its header.
  if (record_.size() > options_.queue_bytes_max)
    largest_bytes_ = std::max(largest_bytes_, record_.size());
  next_.emplace();
  next_->file = std::move(file);
  next_->queue = record_;
  waiting_bytes_ += record_.size();
  ++handed_over_;
  if (options_.threaded) work_.notify_one();
}

void LogWriter::close(const protocol::LogFooter& footer) {
  record_.clear();
  encoder_->footer(footer, record_);
  hand_over(true);
  stop();
  rotating_.reset();
}

std::string LogWriter::error() const {
  const std::scoped_lock lock(mutex_);
  return error_;
}

void LogWriter::hand_over(bool wait) {
  std::unique_lock lock(mutex_);
  if (failed_ || stop_) return;
  // One that can never fit says nothing about the disk: it waits beside what may wait.
  if (record_.size() > options_.queue_bytes_max)
    largest_bytes_ = std::max(largest_bytes_, record_.size());
  const std::size_t most = options_.queue_bytes_max + largest_bytes_;
  if (waiting_bytes_ + record_.size() > most) {
    return fail(lock, options_.path + ": the disk does not keep up: more than " +
                          std::to_string(most) + " bytes wait");
  }
  protocol::Bytes& queue = next_ ? next_->queue : queue_;
  queue.insert(queue.end(), record_.begin(), record_.end());
  waiting_bytes_ += record_.size();
  const std::uint64_t mine = ++handed_over_;
  if (wait) wanted_ = mine;
  if (!options_.threaded) {
    if (wait) work(lock);
    return;
  }
  work_.notify_one();
  if (wait) written_.wait(lock, [&] { return synced_ >= mine || failed_; });
}

void LogWriter::turn() {
  std::unique_lock lock(mutex_);
  if (!failed_ && !stopped_) work(lock);
}

void LogWriter::stop() {
  {
    std::unique_lock lock(mutex_);
    const bool first = !std::exchange(stop_, true);
    if (first && !options_.threaded && !failed_) work(lock);
  }
  work_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void LogWriter::run() {
  std::unique_lock lock(mutex_);
  const auto due = [&] {
    return !queue_.empty() || next_ || stop_ || wanted_ > synced_ || failed_;
  };
  while (!failed_ && !stopped_) {
    if (in_kernel_ == synced_ || options_.sync == LogSync::kNone) {
      work_.wait(lock, due);
    } else {
      const std::chrono::nanoseconds left(next_sync_ns_ - options_.now_ns());
      (void)work_.wait_for(lock, left, due);
    }
    if (!failed_) work(lock);
  }
}

/// Brings what waits to the disk, in the order in which it came. Unlocked while the disk works.
void LogWriter::work(std::unique_lock<std::mutex>& lock) {
  const protocol::Bytes batch = std::exchange(queue_, {});
  std::optional<Next> next = std::exchange(next_, {});
  const std::uint64_t taken = handed_over_;
  const bool last = stop_;
  const bool is_due = options_.sync != LogSync::kNone && options_.now_ns() >= next_sync_ns_;
  const bool sync_now = taken > synced_ && (last || wanted_ > synced_ || is_due);

  lock.unlock();
  bool good = write_out(batch, sync_now || next);
  std::size_t bytes = batch.size();
  if (good && next) {
    file_ = std::move(next->file);
    good = file_->append(next->queue) && file_->publish();
    bytes += next->queue.size();
  }
  lock.lock();

  if (!good) return fail(lock, file_->error());
  waiting_bytes_ -= bytes;
  in_kernel_ = taken;
  if (sync_now || next) synced_ = taken;
  stopped_ = last;
  written_.notify_all();
}

bool LogWriter::write_out(const protocol::Bytes& batch, bool sync_now) {
  if (!file_->append(batch)) return false;
  if (!sync_now) return true;
  next_sync_ns_ = options_.now_ns() + std::chrono::nanoseconds(options_.interval).count();
  return file_->sync();
}

void LogWriter::fail(const std::unique_lock<std::mutex>&, const std::string& what) {
  if (failed_.exchange(true)) return;
  error_ = what;
  written_.notify_all();
  work_.notify_one();
}

}  // namespace cycloid::server
