#include "server/host/patient_log.hpp"

#include <fcntl.h>
#include <poll.h>
#include <spdlog/async_logger.h>
#include <spdlog/details/null_mutex.h>
#include <spdlog/details/thread_pool.h>
#include <spdlog/sinks/base_sink.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdint>
#include <limits>
#include <string>
#include <string_view>
#include <utility>

#include "server/host/process_time.hpp"

namespace cycloid::server {
namespace {

using Pool = spdlog::details::thread_pool;

/// How long a reader is waited for before the deadline is looked at again.
constexpr int kLookMs = 20;

/// Where a terminal has room for a byte, a write waits until it has it for a line. Opened once more
/// it does not, and whoever else has it still waits. -1: it is none, or cannot be opened.
int open_terminal(int descriptor) {
  if (::isatty(descriptor) == 0) return -1;
  const std::string path = "/proc/self/fd/" + std::to_string(descriptor);
  return ::open(path.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC);
}

/// Waits for room before it writes, so that the wait can be ended: a blocked write cannot.
class PatientSink final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 public:
  explicit PatientSink(int descriptor)
      : terminal_(open_terminal(descriptor)), descriptor_(terminal_ < 0 ? descriptor : terminal_) {}
  PatientSink(const PatientSink&) = delete;
  PatientSink& operator=(const PatientSink&) = delete;
  ~PatientSink() override {
    if (terminal_ >= 0) (void)::close(terminal_);
  }

  /// Whose queue leaves out lines, and whose thread writes them: it is there as long as anything
  /// is written. @pre before the first line
  void count_of(Pool* pool) { pool_ = pool; }
  /// Any thread.
  void give_up_at(std::int64_t at_ns) { give_up_ns_ = at_ns; }

 private:
  void sink_it_(const spdlog::details::log_msg& line) override {
    say_what_is_left_out(line);
    write(line);
  }
  void flush_() override {}  // There is no buffer.

  void say_what_is_left_out(const spdlog::details::log_msg& before) {
    const std::size_t left_out = pool_->overrun_counter();
    if (left_out == said_left_out_) return;
    const std::string text = std::to_string(left_out - std::exchange(said_left_out_, left_out)) +
                             " lines are left out here: nobody read them in time";
    write({before.logger_name, spdlog::level::warn, text});
  }

  void write(const spdlog::details::log_msg& line) {
    spdlog::memory_buf_t formatted;
    formatter_->format(line, formatted);
    std::string_view text(formatted.data(), formatted.size());
    while (!text.empty() && has_room()) {
      // Where a pipe has room at all, it has it for so many bytes.
      const ssize_t bytes =
          ::write(descriptor_, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
      if (bytes > 0) text.remove_prefix(static_cast<std::size_t>(bytes));
      if (bytes >= 0 || errno == EINTR) continue;
      if (errno != EAGAIN || is_too_late()) return;  // There is no reader any more, or no time.
      (void)::poll(nullptr, 0, kLookMs);  // A terminal has room, but none for the end of a line.
    }
  }

  bool is_too_late() const { return process_now_ns() >= give_up_ns_; }

  /// Waits for it; false where that is given up.
  bool has_room() const {
    for (;;) {
      const bool too_late = is_too_late();
      pollfd reader{descriptor_, POLLOUT, 0};
      if (::poll(&reader, 1, too_late ? 0 : kLookMs) > 0) return true;
      if (too_late) return false;
    }
  }

  int terminal_;  ///< Its own, to close; -1: none.
  int descriptor_;
  Pool* pool_ = nullptr;
  std::size_t said_left_out_ = 0;
  std::atomic<std::int64_t> give_up_ns_{std::numeric_limits<std::int64_t>::max()};
};

/// A logger and its thread, which end together.
struct LogThread {
  explicit LogThread(int descriptor)
      : sink(std::make_shared<PatientSink>(descriptor)),
        pool(std::make_shared<Pool>(kLogLinesWaitingMax, 1)),
        logger(std::make_shared<spdlog::async_logger>(
            "cycloid", sink, pool, spdlog::async_overflow_policy::overrun_oldest)) {
    sink->count_of(pool.get());
  }
  LogThread(const LogThread&) = delete;
  LogThread& operator=(const LogThread&) = delete;
  ~LogThread() {
    sink->give_up_at(process_now_ns() + std::chrono::nanoseconds(kLogFarewell).count());
    pool.reset();  // Its thread has written all before it ends.
  }

  std::shared_ptr<PatientSink> sink;
  std::shared_ptr<Pool> pool;
  std::shared_ptr<spdlog::async_logger> logger;
};

}  // namespace

std::shared_ptr<spdlog::logger> log_to(int descriptor) {
  const auto thread = std::make_shared<LogThread>(descriptor);
  return {thread, thread->logger.get()};
}

}  // namespace cycloid::server
