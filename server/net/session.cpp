#include "server/net/session.hpp"

#include <utility>

#include "server/net/rethrow.hpp"

namespace cycloid::server {

// GCC 12.2 destroys aggregate temporaries of a co_await expression twice: named locals only.

namespace {

/// From the room's last word to the end: time for the peer to read it and hang up.
constexpr std::chrono::seconds kLinger{1};

}  // namespace

Session::Session(Entrant entrant, SessionPlace place)
    : entrant_(std::move(entrant)),
      place_(std::move(place)),
      reader_wake_(place_.strand),
      writer_wake_(place_.strand),
      linger_(place_.strand) {}

void Session::start() {
  enter();
  auto reader = [self = shared_from_this()] { return self->read_loop(); };
  auto writer = [self = shared_from_this()] { return self->write_loop(); };
  asio::co_spawn(place_.strand, std::move(reader), rethrow);
  asio::co_spawn(place_.strand, std::move(writer), rethrow);
  wake();
}

void Session::enter() {
  id_ = place_.room.admit(entrant_.admission);
  const protocol::Bytes rest = std::exchange(entrant_.rest, {});
  if (!rest.empty()) place_.room.receive(id_, rest);
  entrant_.admission = {};
}

void Session::wake() {
  reader_wake_.cancel();
  writer_wake_.cancel();
  if (lingers_ || !entrant_.stream->is_open() || !place_.room.wants_close(id_)) return;
  lingers_ = true;
  linger_.expires_after(kLinger);
  linger_.async_wait([self = shared_from_this()](const asio::error_code&) { self->close(); });
}

void Session::close() {
  if (!entrant_.stream->is_open()) return;
  place_.room.disconnect(id_);
  entrant_.stream->close();
  reader_wake_.cancel();
  writer_wake_.cancel();
  linger_.cancel();
}

asio::awaitable<std::size_t> Session::read(asio::error_code& error) {
  auto done = asio::redirect_error(asio::use_awaitable, error);
  transport::Stream& stream = *entrant_.stream;
  if (stream.is_tls()) {
    tls_bytes_.resize(kSessionTlsReadBytes);
    const auto target = asio::buffer(tls_bytes_);
    const std::size_t bytes = co_await stream.async_read_some(target, done);
    co_return bytes;
  }
  // No bytes are there to read before they are read, so one array does for all of a room.
  const auto scratch = asio::buffer(place_.scratch.data(), place_.scratch.size());
  for (;;) {
    co_await stream.socket().async_wait(asio::ip::tcp::socket::wait_read, done);
    if (error) co_return 0;
    const std::size_t bytes = stream.socket().read_some(scratch, error);
    if (error != asio::error::would_block) co_return bytes;
  }
}

asio::awaitable<void> Session::read_loop() {
  asio::error_code error;  // Peers going away is an expected event, so no exceptions here.
  auto done = asio::redirect_error(asio::use_awaitable, error);
  transport::Stream& stream = *entrant_.stream;
  stream.socket().non_blocking(true, error);
  while (stream.is_open()) {
    if (!place_.room.wants_bytes(id_)) {  // Until the next tick they wait in the peer's network.
      reader_wake_.expires_at(asio::steady_timer::time_point::max());
      co_await reader_wake_.async_wait(done);
      continue;
    }
    const std::size_t bytes = co_await read(error);
    if (error) break;
    const std::span<const std::byte> source = stream.is_tls() ? tls_bytes_ : place_.scratch;
    place_.room.receive(id_, source.first(bytes));
    wake();
  }
  // Who has the last word still to come may hang up its own side; the writer, or the end of
  // lingering, closes then.
  reader_done_ = true;
  const bool last_word_waits = lingers_ && transport::is_end(error) && !last_word_said_;
  if (!last_word_waits) close();
}

asio::awaitable<void> Session::write(std::vector<Shared> output, asio::error_code& error) {
  auto done = asio::redirect_error(asio::use_awaitable, error);
  transport::Stream& stream = *entrant_.stream;
  if (!stream.is_tls()) {
    std::vector<asio::const_buffer> buffers;
    for (const Shared& bytes : output) buffers.emplace_back(bytes->data(), bytes->size());
    co_await asio::async_write(stream.socket(), buffers, done);
    co_return;
  }
  // Of several buffers each would be a record and a write of its own.
  protocol::Bytes joined;
  for (const Shared& bytes : output) joined.insert(joined.end(), bytes->begin(), bytes->end());
  const auto source = asio::buffer(joined);
  co_await asio::async_write(stream, source, done);
}

asio::awaitable<void> Session::write_loop() {
  asio::error_code error;
  auto done = asio::redirect_error(asio::use_awaitable, error);
  transport::Stream& stream = *entrant_.stream;
  while (stream.is_open()) {
    if (place_.room.has_output(id_)) {
      std::vector<Shared> output = place_.room.take_output(id_);
      co_await write(std::move(output), error);
      if (error) break;
      continue;
    }
    if (place_.room.wants_close(id_)) {
      // The peer reads to the end and hangs up; closing here would reset what it has not read.
      last_word_said_ = true;
      asio::error_code ignored;
      stream.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
      if (!reader_done_) co_return;
      break;
    }
    writer_wake_.expires_at(asio::steady_timer::time_point::max());
    co_await writer_wake_.async_wait(done);
  }
  close();
}

}  // namespace cycloid::server
