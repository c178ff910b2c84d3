#include "server/net/session.hpp"

#include <chrono>
#include <utility>

namespace cycloid::server {
namespace {

/// From the room's last word to the end: time for the peer to read it and hang up.
constexpr std::chrono::seconds kLinger{1};

}  // namespace

Session::Session(Entrant entrant, SessionPlace place)
    : entrant_(std::move(entrant)),
      place_(std::move(place)),
      pause_(place_.strand),
      linger_(place_.strand),
      incoming_(entrant_.stream->is_tls() ? kSessionTlsReadBytes : kSessionReadBytes) {}

void Session::start() {
  asio::error_code ignored;  // A socket that cannot be set so fails at its first read.
  entrant_.stream->socket().non_blocking(true, ignored);
  enter();
  wake();
}

void Session::enter() {
  id_ = place_.room.admit(entrant_.admission);
  const protocol::Bytes rest = std::exchange(entrant_.rest, {});
  if (!rest.empty()) place_.room.receive(id_, rest);
  entrant_.admission = {};
}

void Session::wake() {
  if (!entrant_.stream->is_open()) return;
  write();
  read();
  linger();
}

void Session::close() {
  if (!entrant_.stream->is_open()) return;
  place_.room.disconnect(id_);
  entrant_.stream->close();
  pause_.cancel();
  linger_.cancel();
}

void Session::read() {
  if (reading_ || reader_done_ || !entrant_.stream->is_open()) return;
  if (!place_.room.wants_bytes(id_)) return pause();  // They wait in the peer's network.
  if (paused_) {
    pause_.cancel();
    return;
  }
  reading_ = true;
  auto handler = [self = shared_from_this()](const asio::error_code& error, std::size_t bytes) {
    self->on_read(error, bytes);
  };
  entrant_.stream->async_read_some(asio::buffer(incoming_),
                                   asio::bind_executor(place_.strand, std::move(handler)));
}

void Session::pause() {
  if (std::exchange(paused_, true)) return;
  pause_.expires_at(asio::steady_timer::time_point::max());
  pause_.async_wait([self = shared_from_this()](const asio::error_code&) {
    self->paused_ = false;
    self->read();
  });
}

void Session::on_read(const asio::error_code& error, std::size_t bytes) {
  reading_ = false;
  if (!entrant_.stream->is_open()) return;
  if (!error) {
    place_.room.receive(id_, std::span<const std::byte>(incoming_).first(bytes));
    return wake();
  }
  // Who has the last word still to come may hang up its own side; the last write, or the end of
  // lingering, closes then.
  reader_done_ = true;
  const bool last_word_waits = lingers_ && transport::is_end(error) && !last_word_said_;
  if (!last_word_waits) close();
}

void Session::write() {
  while (!writing_ && entrant_.stream->is_open()) {
    if (!place_.room.has_output(id_)) {
      if (place_.room.wants_close(id_)) say_last_word();
      return;
    }
    output_ = place_.room.take_output(id_);
    const asio::error_code error = write_now();
    if (error == asio::error::would_block) {
      write_rest();
    } else if (error) {
      close();
    }
  }
}

/// Without an error all is written.
asio::error_code Session::write_now() {
  asio::error_code error;
  if (entrant_.stream->is_tls()) return asio::error::would_block;
  buffers_.clear();
  for (const Shared& bytes : output_) buffers_.emplace_back(bytes->data(), bytes->size());
  rest_ = buffers_;
  while (!rest_.empty()) {
    std::size_t bytes = entrant_.stream->socket().write_some(rest_, error);
    if (error) return error;
    while (!rest_.empty() && bytes >= rest_.front().size()) {
      bytes -= rest_.front().size();
      rest_ = rest_.subspan(1);
    }
    if (!rest_.empty()) rest_.front() += bytes;
  }
  output_.clear();
  return error;
}

void Session::write_rest() {
  writing_ = true;
  auto handler = [self = shared_from_this()](const asio::error_code& error, std::size_t) {
    self->on_written(error);
  };
  auto bound = asio::bind_executor(place_.strand, std::move(handler));
  if (!entrant_.stream->is_tls()) {
    return asio::async_write(entrant_.stream->socket(), rest_, std::move(bound));
  }
  joined_.clear();
  for (const Shared& bytes : output_) joined_.insert(joined_.end(), bytes->begin(), bytes->end());
  asio::async_write(*entrant_.stream, asio::buffer(joined_), std::move(bound));
}

void Session::on_written(const asio::error_code& error) {
  writing_ = false;
  output_.clear();
  if (error) return close();
  wake();
}

void Session::say_last_word() {
  if (std::exchange(last_word_said_, true)) return;
  // The peer reads to the end and hangs up; closing here would reset what it has not read.
  asio::error_code ignored;
  entrant_.stream->socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  if (reader_done_) close();
}

void Session::linger() {
  if (lingers_ || !entrant_.stream->is_open() || !place_.room.wants_close(id_)) return;
  lingers_ = true;
  linger_.expires_after(kLinger);
  linger_.async_wait([self = shared_from_this()](const asio::error_code&) { self->close(); });
}

}  // namespace cycloid::server
