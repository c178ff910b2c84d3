#include "cli/child.hpp"

#include <system_error>
#include <utility>

// The one place that knows where processes can be started.
#if defined(__unix__) || defined(__APPLE__)

#include <fcntl.h>
#include <poll.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>

namespace cycloid::cli {
namespace {

/// Between fork and exec only async-signal-safe calls are allowed; this never returns.
[[noreturn]] void become(char** command, int out, int err) {
  setpgid(0, 0);  // A ^C of the terminal is for the parent, which then decides the order.
#ifdef __linux__
  prctl(PR_SET_PDEATHSIG, SIGTERM);
#endif
  dup2(out, STDOUT_FILENO);
  dup2(err, STDERR_FILENO);
  execvp(command[0], command);
  _exit(127);
}

void make_pipe(int (&ends)[2]) {
  if (pipe(ends) != 0) throw std::system_error(errno, std::generic_category(), "pipe");
  for (const int end : ends) fcntl(end, F_SETFD, FD_CLOEXEC);
}

}  // namespace

std::string this_program() {
  return "/proc/self/exe";
}

Child::Child(std::string name, const std::vector<std::string>& command,
             std::size_t output_bytes_max)
    : name_(std::move(name)), output_bytes_max_(output_bytes_max) {
  std::vector<std::string> words = command;
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  int out[2];
  int err[2];
  make_pipe(out);
  streams_[0].fd = out[0];
  make_pipe(err);
  streams_[1].fd = err[0];
  pid_ = fork();
  if (pid_ == 0) become(pointers.data(), out[1], err[1]);
  const int error = errno;
  close(out[1]);
  close(err[1]);
  if (pid_ < 0) throw std::system_error(error, std::generic_category(), "fork");
}

Child::~Child() {
  if (!exit_code_) reap(WNOHANG);
  if (!exit_code_) {
    kill(pid_, SIGKILL);
    reap(0);
  }
  for (Stream& stream : streams_) {
    if (stream.fd >= 0) close(stream.fd);
  }
}

bool Child::finished() const {
  return exit_code_ && streams_[0].fd < 0 && streams_[1].fd < 0;
}

void Child::ask_to_stop() {
  if (!exit_code_) kill(pid_, SIGTERM);
}

void Child::drain(Stream& stream) {
  char bytes[65536];
  const ssize_t count = read(stream.fd, bytes, sizeof bytes);
  if (count > 0) {
    const std::size_t room = output_bytes_max_ - stream.text.size();
    stream.text.append(bytes, std::min(static_cast<std::size_t>(count), room));
  } else if (count == 0 || errno != EINTR) {
    close(std::exchange(stream.fd, -1));
  }
}

void Child::reap(int flags) {
  int status = 0;
  int reaped = 0;
  do {
    reaped = waitpid(pid_, &status, flags);
  } while (reaped < 0 && errno == EINTR);
  if (reaped == 0) return;
  if (reaped < 0) status = SIGKILL;  // Somebody else reaped it; it is gone, and not as we wanted.
  exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

bool pump(const std::vector<Child*>& children, std::chrono::steady_clock::time_point deadline,
          const std::function<bool()>& done) {
  constexpr int kPollMs = 20;  // Also how late the end of a process is noticed.
  while (!done()) {
    std::vector<pollfd> polled;
    std::vector<std::pair<Child*, Child::Stream*>> owners;
    bool all_finished = true;
    for (Child* child : children) {
      if (!child->exit_code_) child->reap(WNOHANG);
      all_finished = all_finished && child->finished();
      for (Child::Stream& stream : child->streams_) {
        if (stream.fd < 0) continue;
        polled.push_back({stream.fd, POLLIN, 0});
        owners.emplace_back(child, &stream);
      }
    }
    if (all_finished || std::chrono::steady_clock::now() >= deadline) return done();
    if (poll(polled.data(), polled.size(), kPollMs) <= 0) continue;
    for (std::size_t i = 0; i < polled.size(); ++i) {
      if (polled[i].revents != 0) owners[i].first->drain(*owners[i].second);
    }
  }
  return true;
}

}  // namespace cycloid::cli

#else

namespace cycloid::cli {

std::string this_program() {
  return "";
}

Child::Child(std::string, const std::vector<std::string>& command, std::size_t)
    : output_bytes_max_(0) {
  throw std::system_error(std::make_error_code(std::errc::function_not_supported),
                          "cannot start " + command.front() + ": not on this platform");
}
Child::~Child() = default;
bool Child::finished() const {
  return true;
}
void Child::ask_to_stop() {}

bool pump(const std::vector<Child*>&, std::chrono::steady_clock::time_point,
          const std::function<bool()>& done) {
  return done();
}

}  // namespace cycloid::cli

#endif
