#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "server/host/host.hpp"
#include "server/operation/http_server.hpp"

namespace cycloid::server {

inline constexpr std::size_t kAdminTokenBytesMin = 16;

struct AdminOptions {
  std::string token;                         ///< @pre at least kAdminTokenBytesMin bytes.
  std::string snapshot_directory;            ///< "": snapshots are refused.
  std::chrono::milliseconds patience{5000};  ///< With a room that does not answer.
  /// Reads the configuration again; may be empty.
  std::function<ActResult()> reload;
};

/// What an admin may ask over HTTP; docs/server.md has the table. Every act, done or not, leaves
/// one line in the log, whatever its level; every mistake gets a status and a sentence that names
/// the field.
class Admin {
 public:
  Admin(Host& host, AdminOptions options);

  /// Answers paths that begin with "/admin". May wait for a room; any thread.
  HttpReply handle(const HttpRequest& request);

 private:
  struct Act;

  bool authorized(const HttpRequest& request) const;
  void note_stranger(const HttpRequest& request);
  HttpReply route(const HttpRequest& request, Act& act);
  HttpReply act_on_room(const HttpRequest& request, Act& act);
  ActResult perform(HostedRoom& room, Act& act);
  ActResult make(Act& act);
  ActResult snapshot(HostedRoom& room, Act& act);
  ActResult kick(HostedRoom& room, Act& act);
  ActResult reserve(HostedRoom& room, Act& act);
  ActResult wait(const std::function<void(HostedRoom::Done)>& ask) const;
  void audit(const HttpRequest& request, const Act& act, const HttpReply& reply) const;

  Host& host_;
  AdminOptions options_;
  std::shared_ptr<spdlog::logger> record_;  ///< The log again, with every level of it.
  std::mutex strangers_mutex_;
  std::chrono::steady_clock::time_point stranger_said_{};
  std::uint64_t strangers_unsaid_ = 0;
};

/// The token in a file, without white space around it.
/// @returns "" and `mistake`, a sentence, where there is none.
std::string read_admin_token(const std::string& path, std::string& mistake);

/// Whether they are equal, in a time that says nothing about where they differ.
bool equal_secrets(const std::string& a, const std::string& b);

}  // namespace cycloid::server
