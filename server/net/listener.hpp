#pragma once

#include <asio.hpp>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "server/net/session.hpp"

namespace cycloid::server {

/// Takes connections in and holds their sessions.
class Listener {
 public:
  /// @param trouble  Told once when connections cannot be accepted, such as without descriptors.
  /// @throws std::system_error where the address is none or cannot be bound.
  Listener(asio::io_context& io, const std::string& address, std::uint16_t port,
           std::size_t sessions_max, std::function<void(const std::string&)> trouble);

  std::uint16_t port() const { return acceptor_.local_endpoint().port(); }
  /// Who connects from now on, or has since the construction, comes into this room.
  void start(Room& room);
  /// After every tick: each session looks after what the room has for it.
  void wake_all();
  /// No new connections. Those that are open end by themselves.
  void close();
  /// Whether a session lives.
  bool busy() const;

 private:
  asio::awaitable<void> accept_loop(Room& room);

  asio::ip::tcp::acceptor acceptor_;
  asio::steady_timer back_off_;
  std::size_t sessions_max_;
  std::function<void(const std::string&)> trouble_;
  bool trouble_told_ = false;
  std::vector<std::weak_ptr<Session>> sessions_;
};

}  // namespace cycloid::server
