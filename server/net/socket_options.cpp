#include "server/net/socket_options.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

namespace cycloid::server {
namespace {

void set_number(asio::ip::tcp::socket& socket, int name, int value) {
  (void)::setsockopt(socket.native_handle(), IPPROTO_TCP, name, &value, sizeof value);
}

}  // namespace

void set_socket_options(asio::ip::tcp::socket& socket, const SocketOptions& options) {
  asio::error_code ignored;
  socket.set_option(asio::ip::tcp::no_delay(true), ignored);
  socket.set_option(asio::socket_base::send_buffer_size(options.send_buffer_bytes), ignored);
  socket.set_option(asio::socket_base::keep_alive(true), ignored);
  const auto keep_alive_s = static_cast<int>(options.keep_alive.count());
  set_number(socket, TCP_KEEPIDLE, keep_alive_s);
  set_number(socket, TCP_KEEPINTVL, keep_alive_s);
  set_number(socket, TCP_KEEPCNT, 3);
  set_number(socket, TCP_USER_TIMEOUT, static_cast<int>(options.user_timeout.count()));
}

}  // namespace cycloid::server
