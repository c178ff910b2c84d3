#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/places.hpp"

namespace cycloid::cli {

struct Ran {
  int exit = -1;  ///< 128 + signal where one ended it; it is killed after a minute.
  std::string out;
  std::string err;

  nlohmann::json json() const { return nlohmann::json::parse(out); }
};

/// Runs the built program to its end.
Ran run_program(const std::vector<std::string>& arguments);
/// Runs another one, named by its path.
Ran run_other(const std::string& program, const std::vector<std::string>& arguments);

/// A folder of its own for a test, removed with it.
class Folder {
 public:
  Folder();
  ~Folder();
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

/// The built program, or another, beside the test; ended with it.
class Background {
 public:
  explicit Background(const std::vector<std::string>& arguments,
                      const std::string& program = places::program());
  ~Background();
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  /// What follows `words` on its line, once such a line is there; "" after ten seconds without.
  std::string wait_for(const std::string& words) const;
  void ask_to_stop();
  void kill_now();
  Ran wait();

 private:
  Folder folder_;
  int pid_;
  bool reaped_ = false;
};

std::string read_text(const std::string& file);
void write_text(const std::string& file, const std::string& text);

}  // namespace cycloid::cli
