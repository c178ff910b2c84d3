#pragma once

#include <sys/types.h>

#include <cstdint>
#include <string>
#include <vector>

namespace cycloid::load {

/// What a process has used.
struct Usage {
  double cpu_s = 0.0;
  std::uint64_t resident_bytes = 0;
};

/// `cycloid serve` as a process of its own, so that its time and memory are nobody else's.
class ServerProcess {
 public:
  /// Starts it and waits until it listens.
  /// @throws std::runtime_error where it does not within 10 s; what it said is in the text.
  ServerProcess(const std::string& program, const std::vector<std::string>& arguments);
  ServerProcess(const ServerProcess&) = delete;
  ServerProcess& operator=(const ServerProcess&) = delete;
  /// Ends it, by its own id.
  ~ServerProcess();

  std::uint16_t port() const { return port_; }
  Usage usage() const;
  /// SIGTERM; waits for the end and returns what it printed on stdout after it listened.
  std::string stop();
  /// SIGKILL; waits for the end.
  void kill_now();

 private:
  std::string read_line();

  pid_t id_ = -1;
  int output_ = -1;
  std::uint16_t port_ = 0;
};

}  // namespace cycloid::load
