#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "server/operation/operation.hpp"
#include "tests/server/host_fixture.hpp"
#include "tests/server/http_fixture.hpp"

namespace cycloid::server {

/// A host with a room "arena", and the port that it is watched and steered by.
class OperationTest : public testing::Test {
 protected:
  void open(HostOptions options, bool with_admin = true) {
    server_.emplace(std::move(options));
    OperationOptions operation;
    operation.missed_ticks_max = 12;
    if (with_admin) {
      AdminOptions admin;
      admin.token = kAdminToken;
      admin.snapshot_directory = testing::TempDir();
      operation.admin = std::move(admin);
    }
    auto bound = Operation::bind(operation);
    operation_.emplace(server_->host(), std::move(operation), std::move(bound));
  }
  void open(bool with_admin = true) {
    HostOptions options = quiet_host(lines_);
    options.rooms.push_back({"arena", two_seat_settings()});
    open(std::move(options), with_admin);
  }
  /// @returns the folder that the room writes its logs into.
  std::filesystem::path open_with_logs(const std::string& name) {
    const std::filesystem::path folder =
        testing::TempDir() + "/cycloid-" + name + "-" + std::to_string(::getpid());
    std::filesystem::create_directories(folder);
    HostOptions options = quiet_host(lines_);
    options.rooms.push_back({"arena", two_seat_settings()});
    options.rooms[0].settings.log_directory = folder;
    open(std::move(options));
    return folder;
  }
  Answer get(const std::string& path) { return http(operation_->port(), "GET", path); }
  Answer post(const std::string& path, const std::string& body = "") {
    return http(operation_->port(), "POST", path, body);
  }
  std::string error_of(const Answer& answer) {
    return nlohmann::json::parse(answer.body).value("error", "");
  }
  std::string close() {
    operation_.reset();
    return last_words(server_, lines_);
  }

  HostLines lines_;
  std::optional<RunningHost> server_;
  std::optional<Operation> operation_;
};

}  // namespace cycloid::server
