#pragma once

#include <asio.hpp>
#include <cstdint>
#include <functional>
#include <string>

namespace cycloid::server {

struct ListenerOptions {
  std::string address;
  std::uint16_t port = 0;  ///< 0: any.
  std::function<void(asio::ip::tcp::socket)> on_connection;
  /// A connection for which there is no descriptor to keep it with: one word, then it is closed.
  std::function<void(asio::ip::tcp::socket&)> on_crowded;
  /// Told once when connections cannot be accepted.
  std::function<void(const std::string&)> trouble;
  std::function<void()> on_failure;  ///< Told each time.
};

/// Takes connections in. Its sockets belong to the context, not to the listener's strand, so that
/// whoever has one may use it on a strand of his own.
///
/// Without descriptors it tries again every 100 ms, because a moment's want passes. After a second
/// it gives up a descriptor that it has kept for that, and turns away with it, one after the other,
/// those who would else wait without a word.
class Listener {
 public:
  /// @throws std::system_error where the address is none or cannot be bound.
  Listener(asio::strand<asio::io_context::executor_type> strand, ListenerOptions options);
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  ~Listener();

  std::uint16_t port() const { return port_; }
  void start();
  /// No new connections. On the strand.
  void close();

 private:
  asio::awaitable<void> accept_loop();
  void open_reserve();
  void close_reserve();
  void turn_away();

  asio::strand<asio::io_context::executor_type> strand_;
  ListenerOptions options_;
  asio::ip::tcp::acceptor acceptor_;
  asio::steady_timer back_off_;
  std::uint16_t port_ = 0;
  int reserve_ = -1;
  int failures_ = 0;  ///< In a row.
  bool trouble_told_ = false;
};

}  // namespace cycloid::server
