#include "tests/cli/program.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <thread>

namespace cycloid::cli {
namespace {

constexpr std::chrono::seconds kDeadline{60};

pid_t spawn(const std::string& program, const std::vector<std::string>& arguments,
            const std::string& out, const std::string& err) {
  std::vector<std::string> words = {program};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const int flags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), flags, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), flags, 0600);
  pid_t pid = -1;
  const int error = posix_spawn(&pid, program.c_str(), &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw std::runtime_error("cannot start " + program);
  return pid;
}

int wait_for_exit(pid_t pid) {
  const auto deadline = std::chrono::steady_clock::now() + kDeadline;
  int status = 0;
  while (waitpid(pid, &status, WNOHANG) == 0) {
    if (std::chrono::steady_clock::now() > deadline) kill(pid, SIGKILL);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

Ran run_program(const std::vector<std::string>& arguments) {
  return Background(arguments).wait();
}

Ran run_other(const std::string& program, const std::vector<std::string>& arguments) {
  return Background(arguments, program).wait();
}

Background::Background(const std::vector<std::string>& arguments, const std::string& program)
    : pid_(spawn(program, arguments, folder_.file("out"), folder_.file("err"))) {}

Background::~Background() {
  kill_now();
}

void Background::kill_now() {
  if (reaped_) return;
  kill(pid_, SIGKILL);
  wait_for_exit(pid_);
  reaped_ = true;
}

std::string Background::wait_for(const std::string& words) const {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  while (std::chrono::steady_clock::now() < deadline) {
    const std::string text = read_text(folder_.file("out")) + read_text(folder_.file("err"));
    const std::size_t at = text.find(words);
    const std::size_t end = at == std::string::npos ? at : text.find('\n', at);
    if (end != std::string::npos) {
      return text.substr(at + words.size(), end - at - words.size());
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  return "";
}

void Background::ask_to_stop() {
  if (!reaped_) kill(pid_, SIGTERM);
}

Ran Background::wait() {
  Ran ran;
  ran.exit = wait_for_exit(pid_);
  reaped_ = true;
  ran.out = read_text(folder_.file("out"));
  ran.err = read_text(folder_.file("err"));
  return ran;
}

Folder::Folder() {
  std::string name = (std::filesystem::temp_directory_path() / "cycloid-cli-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("cannot make " + name);
  path_ = name;
}

Folder::~Folder() {
  std::error_code ignored;  // A folder that stays is litter, no failure.
  std::filesystem::remove_all(path_, ignored);
}

std::string read_text(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void write_text(const std::string& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  if (!stream.flush()) throw std::runtime_error("cannot write " + file);
}

}  // namespace cycloid::cli
