#include "bench/load/server_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <stdexcept>
#include <system_error>

extern char** environ;

namespace cycloid::load {
namespace {

constexpr int kStartMs = 10000;

pid_t spawn(const std::string& program, const std::vector<std::string>& arguments, int output) {
  std::vector<char*> words{const_cast<char*>(program.c_str())};
  for (const std::string& word : arguments) words.push_back(const_cast<char*>(word.c_str()));
  words.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  (void)posix_spawn_file_actions_init(&actions);
  (void)posix_spawn_file_actions_adddup2(&actions, output, STDOUT_FILENO);
  pid_t id = -1;
  const int error = posix_spawn(&id, program.c_str(), &actions, nullptr, words.data(), environ);
  (void)posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::system_error(error, std::generic_category(), program);
  return id;
}

}  // namespace

ServerProcess::ServerProcess(const std::string& program,
                             const std::vector<std::string>& arguments) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0) throw std::system_error(errno, std::generic_category());
  output_ = ends[0];
  id_ = spawn(program, arguments, ends[1]);
  (void)::close(ends[1]);
  std::string said;
  while (port_ == 0) {
    const std::string line = read_line();
    said += line + '\n';
    const std::size_t colon = line.rfind(':');
    if (line.rfind("listening on ", 0) == 0 && colon != std::string::npos) {
      port_ = static_cast<std::uint16_t>(std::stoul(line.substr(colon + 1)));
    } else if (line.empty()) {
      kill_now();
      throw std::runtime_error("the server does not listen: " + said);
    }
  }
}

ServerProcess::~ServerProcess() {
  if (id_ > 0) kill_now();
  (void)::close(output_);
}

Usage ServerProcess::usage() const {
  Usage usage;
  std::ifstream stat("/proc/" + std::to_string(id_) + "/stat");
  std::string text((std::istreambuf_iterator<char>(stat)), {});
  // Behind the name, which may hold anything: state, then numbers; times are the 12th and 13th.
  const std::size_t behind = text.rfind(')');
  if (behind == std::string::npos) return usage;
  std::size_t at = behind + 2;
  for (int field = 0; field < 11 && at != std::string::npos; ++field) at = text.find(' ', at) + 1;
  std::size_t end = 0;
  const double user = std::stod(text.substr(at), &end);
  const double system = std::stod(text.substr(at + end));
  usage.cpu_s = (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
  std::ifstream pages("/proc/" + std::to_string(id_) + "/statm");
  std::uint64_t all = 0;
  std::uint64_t resident = 0;
  pages >> all >> resident;
  usage.resident_bytes = resident * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
  return usage;
}

std::string ServerProcess::stop() {
  if (id_ <= 0) return {};
  (void)::kill(id_, SIGTERM);
  std::string said;
  char buffer[4096];
  for (ssize_t count = 1; count > 0;) {
    count = ::read(output_, buffer, sizeof buffer);
    if (count < 0 && errno == EINTR)
      count = 1;
    else if (count > 0)
      said.append(buffer, static_cast<std::size_t>(count));
  }
  (void)::waitpid(id_, nullptr, 0);
  id_ = -1;
  return said;
}

void ServerProcess::kill_now() {
  if (id_ <= 0) return;
  (void)::kill(id_, SIGKILL);
  (void)::waitpid(id_, nullptr, 0);
  id_ = -1;
}

std::string ServerProcess::read_line() {
  std::string line;
  char c = 0;
  pollfd ready{output_, POLLIN, 0};
  while (::poll(&ready, 1, kStartMs) > 0 && ::read(output_, &c, 1) == 1 && c != '\n') line += c;
  return line;
}

}  // namespace cycloid::load
