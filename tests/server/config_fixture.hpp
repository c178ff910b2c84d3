#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <future>
#include <string>
#include <utility>

#include "server/config/run.hpp"
#include "tests/server/host_fixture.hpp"

namespace cycloid::server {

inline scenes::Loaded load_for_test(const std::string& name) {
  if (name != "two-seats") return scenes::find(name);
  scenes::Loaded loaded;
  loaded.scene = two_seat_scene();
  return loaded;
}

inline constexpr const char* kConfigRooms = R"(
[template.duel]
scene = "two-seats"
on_first_join = true
empty_ttl_s = 60

[[room]]
name = "arena"
template = "duel"
)";

/// A file that is gone with the test.
class ConfigFile {
 public:
  explicit ConfigFile(const std::string& what)
      : path_(testing::TempDir() + "cycloid-" + what + "-" + std::to_string(::getpid())) {}
  ~ConfigFile() { std::filesystem::remove(path_); }
  void write(const std::string& text) const { std::ofstream(path_) << text; }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// A configured server that runs beside the test.
class Configured {
 public:
  /// @param load_again  Of a reload.
  explicit Configured(const ConfigFile& file, SceneLoader load_again = load_for_test) {
    ConfiguredServer server;
    server.config = *read_config_file(file.path(), load_for_test).config;
    server.file = file.path();
    server.load_scene = std::move(load_again);
    server.config.host.logger = lines_.logger();
    std::promise<ListeningAt> at;
    auto listening = at.get_future();
    report_ = std::async(std::launch::async, [this, server, &at] {
      return run_configured(
          server, [&](const ListeningAt& where) { at.set_value(where); }, stop_.get_token());
    });
    at_ = listening.get();
  }
  ~Configured() { stop_.request_stop(); }
  const ListeningAt& at() const { return at_; }
  HostReport stop() {
    stop_.request_stop();
    return report_.get();
  }
  std::string lines() const { return lines_.text(); }

 private:
  HostLines lines_;
  std::stop_source stop_;
  std::future<HostReport> report_;
  ListeningAt at_;
};

}  // namespace cycloid::server
