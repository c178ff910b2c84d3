#pragma once

#include <string>

namespace cycloid::server {

/// The code of what needs a file that cannot be written.
inline constexpr int kCannotWrite = 500;

/// What an act on a room, or on the host, came to. The codes are those of HTTP.
struct ActResult {
  int status = 200;
  std::string text;  ///< Why not, where status is 400 or more.

  bool ok() const { return status < 400; }
};

}  // namespace cycloid::server
