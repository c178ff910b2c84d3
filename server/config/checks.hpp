#pragma once

#include <functional>
#include <string>

#include "server/config/config.hpp"

namespace cycloid::server {

/// What is wrong with values that are each in range: they contradict each other, or name what is
/// not there. Reads the files of secrets and certificates into the configuration.
/// @param complain  Told key and reason.
void check_config(ServerConfig& config,
                  const std::function<void(const std::string&, std::string)>& complain);

}  // namespace cycloid::server
