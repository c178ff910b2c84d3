#include "server/log/log_writer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <utility>

namespace cycloid::server {
namespace {

using Clock = std::chrono::steady_clock;

/// A new name is on the disk when its folder is.
void sync_folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::absolute(path).parent_path();
  const int file = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (file < 0) return;  // A folder that may be written but not read; the data is synced anyway.
  (void)::fsync(file);
  (void)::close(file);
}

}  // namespace

LogCalls system_log_calls() {
  return {::write, ::fdatasync};
}

LogWriter::LogWriter(LogWriterOptions options, const protocol::LogHeader& header)
    : options_(std::move(options)) {
  protocol::Bytes bytes;
  encoder_.emplace(header, bytes);
  file_ = ::open(options_.path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644);
  if (file_ < 0) throw std::system_error(errno, std::generic_category(), options_.path);
  if (!write_all(bytes) || !sync()) {
    const int why = errno;
    (void)::close(file_);
    (void)::unlink(options_.path.c_str());
    throw std::system_error(why, std::generic_category(), options_.path);
  }
  sync_folder_of(options_.path);
  thread_ = std::thread([this] { run(); });
}

LogWriter::~LogWriter() {
  stop();
  (void)::close(file_);
}

void LogWriter::tick(const protocol::LogTick& tick) {
  record_.clear();
  encoder_->tick(tick, record_);
  hand_over(options_.sync == LogSync::kEveryTick);
}

void LogWriter::close(const protocol::LogFooter& footer) {
  record_.clear();
  encoder_->footer(footer, record_);
  hand_over(true);
  stop();
}

std::string LogWriter::error() const {
  const std::scoped_lock lock(mutex_);
  return error_;
}

void LogWriter::hand_over(bool wait) {
  std::unique_lock lock(mutex_);
  if (failed_ || stop_) return;
  if (queue_.size() + record_.size() > options_.queue_bytes_max) {
    return fail(lock, "the disk does not keep up: more than " +
                          std::to_string(options_.queue_bytes_max) + " bytes wait");
  }
  queue_.insert(queue_.end(), record_.begin(), record_.end());
  const std::uint64_t mine = ++handed_over_;
  if (wait) wanted_ = mine;
  work_.notify_one();
  if (wait) written_.wait(lock, [&] { return synced_ >= mine || failed_; });
}

void LogWriter::stop() {
  {
    const std::scoped_lock lock(mutex_);
    stop_ = true;
  }
  work_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void LogWriter::run() {
  protocol::Bytes batch;
  Clock::time_point next_sync = Clock::now() + options_.interval;
  std::unique_lock lock(mutex_);
  std::uint64_t written = 0;
  while (!failed_) {
    const auto due = [&] { return !queue_.empty() || stop_ || wanted_ > synced_; };
    if (written == synced_) {
      work_.wait(lock, due);
    } else {
      (void)work_.wait_until(lock, next_sync, due);
    }
    batch.clear();
    batch.swap(queue_);
    const std::uint64_t taken = handed_over_;
    const bool last = stop_;
    const bool sync_now = last || wanted_ > synced_ || Clock::now() >= next_sync;

    lock.unlock();
    std::string failure;
    if (!write_all(batch)) failure = "write";
    if (failure.empty() && sync_now && !sync()) failure = "sync";
    const int why = errno;
    if (sync_now) next_sync = Clock::now() + options_.interval;
    lock.lock();

    written = taken;
    if (!failure.empty()) return fail(lock, failure + ": " + std::generic_category().message(why));
    if (sync_now) synced_ = taken;
    written_.notify_all();
    if (last) return;
  }
}

bool LogWriter::write_all(const protocol::Bytes& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = options_.calls.write(file_, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count == 0) errno = EIO;  // Such a file takes nothing, and says no error either.
    if (count <= 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return true;
}

bool LogWriter::sync() {
  int result = 0;
  do {
    result = options_.calls.sync(file_);
  } while (result != 0 && errno == EINTR);
  return result == 0;
}

void LogWriter::fail(const std::unique_lock<std::mutex>&, const std::string& what) {
  if (failed_.exchange(true)) return;
  error_ = options_.path + ": " + what;
  written_.notify_all();
  work_.notify_one();
}

}  // namespace cycloid::server
