#pragma once

#include <asio.hpp>
#include <chrono>

namespace cycloid::server {

/// What the kernel is asked for, for every connection.
struct SocketOptions {
  /// What the kernel holds for a peer that does not read, beside what the room holds: it would grow
  /// this to megabytes by itself, and the room would notice minutes later.
  int send_buffer_bytes = 262144;
  std::chrono::seconds keep_alive{15};  ///< Silence before the kernel asks; then twice more.
  std::chrono::milliseconds user_timeout{20000};  ///< Of sent bytes that nobody acknowledges.
};

/// Sets these and TCP_NODELAY. What the kernel refuses it refuses: the socket still works, only
/// later.
void set_socket_options(asio::ip::tcp::socket& socket, const SocketOptions& options);

}  // namespace cycloid::server
