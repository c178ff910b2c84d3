#pragma once

#include <array>
#include <asio.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>

#include "client/net/tls.hpp"
#include "protocol/codec.hpp"
#include "protocol/messages.hpp"
#include "transport/stream.hpp"

namespace cycloid::client {

/// One connection to a server, over TCP or through TLS: messages in and out, knows nothing of
/// physics.
///
/// Every wait has a deadline and every queue a bound; whichever is reached closes the connection,
/// and the reason names it. Ends with exactly one `on_closed`. All calls and handlers are on the
/// thread that runs the io_context, which must have run dry before a Connection is destroyed.
class Connection {
 public:
  struct Limits {
    std::chrono::milliseconds connect{5000};   ///< TLS's handshake included.
    std::chrono::milliseconds silence{10000};  ///< Longest time without a byte from the server.
    std::chrono::milliseconds farewell{1000};  ///< From our last byte to the server's end.
    std::size_t queue_bytes_max = std::size_t{1} << 20;
  };
  struct Handlers {
    std::function<void()> on_open;
    std::function<void(const protocol::ServerMessage&)> on_message;
    std::function<void()> on_poll;  ///< Every `kPollInterval` from `open` until closed.
    std::function<void(const std::string& reason)> on_closed;
  };
  static constexpr std::chrono::milliseconds kPollInterval{50};

  /// @param tls  How to speak TLS; null: not at all.
  Connection(asio::io_context& io, Limits limits, Handlers handlers,
             std::shared_ptr<const ClientTls> tls = nullptr);

  /// @param host  An address, or a name to look up.
  void open(const std::string& host, std::uint16_t port);
  void send(const protocol::ClientMessage& message);
  /// Sends what is queued, says that this was all, waits for the server to close; `reason` is what
  /// `on_closed` is told. No message is handed out any more.
  void finish(const std::string& reason);
  void close(const std::string& reason);

  std::uint64_t bytes_in() const { return bytes_in_; }
  std::uint64_t bytes_out() const { return bytes_out_; }

 private:
  using Clock = std::chrono::steady_clock;
  enum class Stage : std::uint8_t { kConnecting, kOpen, kFinishing, kClosed };

  void connect(const std::string& host, const asio::ip::tcp::resolver::results_type& endpoints);
  void shake_hands(const std::string& host);
  void opened();
  void read();
  void take(std::size_t bytes);
  void write();
  void shut_when_sent();
  void poll();
  std::string overdue() const;

  Limits limits_;
  Handlers handlers_;
  asio::ip::tcp::resolver resolver_;
  std::shared_ptr<const ClientTls> tls_;
  transport::Stream stream_;
  asio::steady_timer timer_;
  protocol::Framer framer_;
  std::array<std::byte, 16384> incoming_{};
  std::deque<protocol::Bytes> queue_;
  std::size_t queue_bytes_ = 0;
  Stage stage_ = Stage::kConnecting;
  bool writing_ = false;
  bool shut_ = false;
  Clock::time_point since_;  ///< What the deadline of the stage counts from.
  std::string farewell_;
  std::uint64_t bytes_in_ = 0;
  std::uint64_t bytes_out_ = 0;
};

}  // namespace cycloid::client
