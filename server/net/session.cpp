#include "server/net/session.hpp"

#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "server/net/rethrow.hpp"

namespace cycloid::server {

// GCC 12.2 destroys aggregate temporaries of a co_await expression twice: named locals only.

namespace {

/// From the room's last word to the end: time for the peer to read it and hang up.
constexpr std::chrono::seconds kLinger{1};
constexpr std::size_t kReadBytes = 16384;
/// What the kernel holds for a peer that does not read, beside what the room holds: it would grow
/// this to megabytes by itself, and the room would notice minutes later.
constexpr int kSendBufferBytes = 262144;

}  // namespace

Session::Session(asio::ip::tcp::socket socket, Room& room)
    : socket_(std::move(socket)),
      room_(room),
      reader_wake_(socket_.get_executor()),
      writer_wake_(socket_.get_executor()),
      linger_(socket_.get_executor()) {}

void Session::start() {
  asio::error_code ignored;  // A socket without an option still works, only later.
  socket_.set_option(asio::ip::tcp::no_delay(true), ignored);
  socket_.set_option(asio::socket_base::send_buffer_size(kSendBufferBytes), ignored);
  id_ = room_.connect();
  auto reader = [self = shared_from_this()] { return self->read_loop(); };
  auto writer = [self = shared_from_this()] { return self->write_loop(); };
  asio::co_spawn(socket_.get_executor(), std::move(reader), rethrow);
  asio::co_spawn(socket_.get_executor(), std::move(writer), rethrow);
  wake();
}

void Session::wake() {
  reader_wake_.cancel();
  writer_wake_.cancel();
  if (lingers_ || !socket_.is_open() || !room_.wants_close(id_)) return;
  lingers_ = true;
  linger_.expires_after(kLinger);
  linger_.async_wait([self = shared_from_this()](const asio::error_code&) { self->close(); });
}

void Session::close() {
  if (!socket_.is_open()) return;
  room_.disconnect(id_);
  asio::error_code ignored;  // Closed is closed.
  socket_.close(ignored);
  reader_wake_.cancel();
  writer_wake_.cancel();
  linger_.cancel();
}

asio::awaitable<void> Session::read_loop() {
  asio::error_code error;  // Peers going away is an expected event, so no exceptions here.
  auto done = asio::redirect_error(asio::use_awaitable, error);
  std::array<std::byte, kReadBytes> incoming;
  const auto target = asio::buffer(incoming);
  while (socket_.is_open()) {
    if (!room_.wants_bytes(id_)) {  // Until the next tick the bytes wait in the peer's network.
      reader_wake_.expires_at(asio::steady_timer::time_point::max());
      co_await reader_wake_.async_wait(done);
      continue;
    }
    const std::size_t bytes = co_await socket_.async_read_some(target, done);
    if (error) break;
    room_.receive(id_, std::span<const std::byte>(incoming).first(bytes));
    wake();
  }
  // Who has the last word still to come may hang up its own side; the writer, or the end of
  // lingering, closes then.
  reader_done_ = true;
  const bool last_word_waits = lingers_ && error == asio::error::eof && !last_word_said_;
  if (!last_word_waits) close();
}

asio::awaitable<void> Session::write_loop() {
  asio::error_code error;
  auto done = asio::redirect_error(asio::use_awaitable, error);
  while (socket_.is_open()) {
    if (room_.has_output(id_)) {
      const std::vector<Shared> output = room_.take_output(id_);
      std::vector<asio::const_buffer> buffers;
      for (const Shared& bytes : output) buffers.emplace_back(bytes->data(), bytes->size());
      co_await asio::async_write(socket_, buffers, done);
      if (error) break;
      continue;
    }
    if (room_.wants_close(id_)) {
      // The peer reads to the end and hangs up; closing here would reset what it has not read.
      last_word_said_ = true;
      asio::error_code ignored;
      socket_.shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
      if (!reader_done_) co_return;
      break;
    }
    writer_wake_.expires_at(asio::steady_timer::time_point::max());
    co_await writer_wake_.async_wait(done);
  }
  close();
}

}  // namespace cycloid::server
