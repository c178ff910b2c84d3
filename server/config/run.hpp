#pragma once

#include <functional>
#include <stop_token>
#include <string>

#include "server/config/config.hpp"

namespace cycloid::server {

/// A configuration with where it came from, so that it can be read again.
struct ConfiguredServer {
  ServerConfig config;
  std::string file;        ///< "": it cannot be.
  SceneLoader load_scene;  ///< For reading it again.
  /// What the command line says against the file, after each reload; `config` has it already. May
  /// be empty.
  std::function<void(ServerConfig&)> override_config;
};

/// Where a server listens.
struct ListeningAt {
  std::uint16_t port = 0;
  std::uint16_t operation_port = 0;  ///< 0: nowhere.
};

/// Runs it until it is drained. Blocks.
/// @param on_listening  Told once, before the first tick. May be empty.
/// @throws std::system_error and std::invalid_argument, as Host and Operation do.
HostReport run_configured(ConfiguredServer server,
                          const std::function<void(const ListeningAt&)>& on_listening,
                          std::stop_token stop = {});

}  // namespace cycloid::server
