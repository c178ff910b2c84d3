#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace cycloid::cli {

/// What names this very program in a Child's command.
std::string this_program();

/// A process; its output is collected. Whoever destroys it ends and reaps it, and on Linux it ends
/// by itself when this process dies. Where a platform has no processes to start, the constructor
/// throws and says so.
class Child {
 public:
  /// Most bytes kept of each stream, unless the owner wants more; the rest is read and dropped, so
  /// that nobody blocks.
  static constexpr std::size_t kOutputBytesMax = std::size_t{1} << 20;

  /// @param command  The program, looked for in PATH where it has no slash, and its arguments.
  Child(std::string name, const std::vector<std::string>& command,
        std::size_t output_bytes_max = kOutputBytesMax);
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child();

  const std::string& name() const { return name_; }
  const std::string& out() const { return streams_[0].text; }
  const std::string& err() const { return streams_[1].text; }
  /// Both streams at their end and the process reaped.
  bool finished() const;
  /// The exit code, or 128 + the signal that ended it; none while it runs.
  std::optional<int> exit_code() const { return exit_code_; }
  void ask_to_stop();

 private:
  friend bool pump(const std::vector<Child*>&, std::chrono::steady_clock::time_point,
                   const std::function<bool()>&);
  struct Stream {
    int fd = -1;
    std::string text;
  };
  void drain(Stream& stream);
  void reap(int flags);

  std::string name_;
  std::size_t output_bytes_max_;
  int pid_ = -1;
  Stream streams_[2];
  std::optional<int> exit_code_;
};

/// Collects the children's output until `done`, all have finished, or the deadline.
/// @returns whether `done` holds.
bool pump(const std::vector<Child*>& children, std::chrono::steady_clock::time_point deadline,
          const std::function<bool()>& done);

}  // namespace cycloid::cli
