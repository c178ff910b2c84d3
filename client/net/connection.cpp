#include "client/net/connection.hpp"

#include <span>
#include <utility>

namespace cycloid::client {

using asio::ip::tcp;

// Plain callbacks: each operation names its next one. No handler keeps the connection alive; the
// owner does, until the io_context has run dry.

Connection::Connection(asio::io_context& io, Limits limits, Handlers handlers,
                       std::shared_ptr<const ClientTls> tls)
    : limits_(limits),
      handlers_(std::move(handlers)),
      resolver_(io),
      tls_(std::move(tls)),
      stream_(io.get_executor(), tls_ == nullptr ? nullptr : tls_->context()),
      timer_(io),
      framer_(protocol::kServerMessageBytesMax) {}

void Connection::open(const std::string& host, std::uint16_t port) {
  since_ = Clock::now();
  poll();
  asio::error_code error;
  const asio::ip::address address = asio::ip::make_address(host, error);
  if (!error) {  // A number needs no name service, which cannot be interrupted.
    const tcp::endpoint endpoint(address, port);
    return connect(host, tcp::resolver::results_type::create(endpoint, host, ""));
  }
  resolver_.async_resolve(
      host, std::to_string(port),
      [this, host](const asio::error_code& failure, const tcp::resolver::results_type& endpoints) {
        if (stage_ == Stage::kClosed) return;
        if (failure) return close("cannot look up: " + failure.message());
        connect(host, endpoints);
      });
}

void Connection::connect(const std::string& host, const tcp::resolver::results_type& endpoints) {
  asio::async_connect(stream_.socket(), endpoints,
                      [this, host](const asio::error_code& failure, const tcp::endpoint&) {
                        if (stage_ == Stage::kClosed) return;
                        if (failure) return close("cannot connect: " + failure.message());
                        shake_hands(host);
                      });
}

void Connection::shake_hands(const std::string& host) {
  if (tls_ == nullptr) return opened();
  if (!tls_->prepare(stream_, host)) return close("no name to verify the server by");
  stream_.async_handshake(asio::ssl::stream_base::client, [this](const asio::error_code& failure) {
    if (stage_ == Stage::kClosed) return;
    if (failure) return close(tls_->reason(stream_, failure));
    opened();
  });
}

void Connection::opened() {
  asio::error_code ignored;  // A socket without the option still works, only later.
  stream_.socket().set_option(tcp::no_delay(true), ignored);
  stage_ = Stage::kOpen;
  since_ = Clock::now();
  read();
  handlers_.on_open();
}

void Connection::read() {
  stream_.async_read_some(asio::buffer(incoming_),
                          [this](const asio::error_code& error, std::size_t bytes) {
                            if (stage_ == Stage::kClosed) return;
                            if (stage_ == Stage::kFinishing && error) return close(farewell_);
                            if (transport::is_end(error)) return close("the server hung up");
                            if (error) return close("cannot read: " + error.message());
                            take(bytes);
                            if (stage_ != Stage::kClosed) read();
                          });
}

void Connection::take(std::size_t bytes) {
  bytes_in_ += bytes;
  if (stage_ == Stage::kFinishing) return;
  since_ = Clock::now();
  // A bad size behind good messages shows only once these are taken out.
  (void)framer_.feed(std::span<const std::byte>(incoming_).first(bytes));
  while (stage_ == Stage::kOpen) {
    const auto payload = framer_.next();
    if (!payload && framer_.broken()) {
      return close("a message of " + std::to_string(framer_.announced_bytes()) +
                   " bytes, of at most " + std::to_string(protocol::kServerMessageBytesMax));
    }
    if (!payload) return;
    const auto decoded = protocol::decode_server(*payload);
    if (!decoded.message) return close("not a message: " + decoded.error);
    handlers_.on_message(*decoded.message);
  }
}

void Connection::send(const protocol::ClientMessage& message) {
  if (stage_ != Stage::kOpen) return;
  protocol::Bytes bytes = protocol::encode(message);
  if (queue_bytes_ + bytes.size() > limits_.queue_bytes_max) {
    return close("the server does not take what is sent");
  }
  queue_bytes_ += bytes.size();
  queue_.push_back(std::move(bytes));
  write();
}

void Connection::write() {
  if (writing_ || queue_.empty()) return;
  writing_ = true;
  asio::async_write(stream_, asio::buffer(queue_.front()),
                    [this](const asio::error_code& error, std::size_t bytes) {
                      writing_ = false;
                      bytes_out_ += bytes;
                      if (stage_ == Stage::kClosed) return;
                      // What the server said last may still be on its way; the read loop ends it.
                      if (error && stage_ == Stage::kOpen) return;
                      if (error) return close(farewell_);
                      queue_bytes_ -= queue_.front().size();
                      queue_.pop_front();
                      write();
                      shut_when_sent();
                    });
}

void Connection::finish(const std::string& reason) {
  if (stage_ == Stage::kConnecting) return close(reason);
  if (stage_ != Stage::kOpen) return;
  farewell_ = reason;
  stage_ = Stage::kFinishing;
  since_ = Clock::now();
  shut_when_sent();
}

void Connection::shut_when_sent() {
  if (stage_ != Stage::kFinishing || shut_ || writing_ || !queue_.empty()) return;
  shut_ = true;
  stream_.async_shutdown([](const asio::error_code&) {});  // It fails where the server was faster.
}

void Connection::close(const std::string& reason) {
  if (stage_ == Stage::kClosed) return;
  stage_ = Stage::kClosed;
  resolver_.cancel();
  timer_.cancel();
  stream_.close();
  handlers_.on_closed(reason);
}

void Connection::poll() {
  timer_.expires_after(kPollInterval);
  timer_.async_wait([this](const asio::error_code&) {
    if (stage_ == Stage::kClosed) return;
    if (const std::string reason = overdue(); !reason.empty()) return close(reason);
    poll();
    handlers_.on_poll();
  });
}

std::string Connection::overdue() const {
  const auto waited = Clock::now() - since_;
  if (stage_ == Stage::kConnecting && waited > limits_.connect) return "no connection in time";
  if (stage_ == Stage::kOpen && waited > limits_.silence) return "the server fell silent";
  if (stage_ == Stage::kFinishing && waited > limits_.farewell) return farewell_;
  return "";
}

}  // namespace cycloid::client
