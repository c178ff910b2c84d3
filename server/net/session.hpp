#pragma once

#include <asio.hpp>
#include <chrono>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "protocol/transport/stream.hpp"
#include "server/room/admission.hpp"
#include "server/room/room.hpp"

namespace cycloid::server {

/// A connection that the gate has let through, on its way to its room.
struct Entrant {
  std::unique_ptr<transport::Stream> stream;
  Admission admission;
  protocol::Bytes rest;         ///< What came behind the hello.
  std::shared_ptr<void> count;  ///< Let go behind the connection, which is counted by that.
};

/// Of one read, over TCP or through TLS.
inline constexpr std::size_t kSessionReadBytes = 16384;
inline constexpr std::size_t kSessionTlsReadBytes = 4096;

/// Where a session lives. All of it outlives the session, because `keep` does.
struct SessionPlace {
  asio::any_io_executor strand;  ///< The room's.
  Room& room;
  std::span<std::byte> scratch;  ///< To read into; between two suspensions it is whoever runs.
  std::shared_ptr<void> keep;
};

/// One connection in a room: bytes between a socket and the room, which decides everything. All of
/// it on the room's strand.
///
/// A reader and a writer, each a coroutine that owns a reference; the session dies when both have
/// ended. What waits to be sent lies in the room, bounded; beside it there is one write under way,
/// of all that waited: one writev for each client and tick.
class Session : public std::enable_shared_from_this<Session> {
 public:
  Session(Entrant entrant, SessionPlace place);

  /// Brings the client into the room.
  void start();
  /// The room was called: it may have output, or want the connection closed.
  void wake();
  void close();

 private:
  asio::awaitable<void> read_loop();
  asio::awaitable<void> write_loop();
  void enter();
  asio::awaitable<std::size_t> read(asio::error_code& error);
  asio::awaitable<void> write(std::vector<Shared> output, asio::error_code& error);

  Entrant entrant_;
  SessionPlace place_;
  PeerId id_ = kNobody;
  asio::steady_timer reader_wake_;  ///< Waits for ever; cancelled to go on.
  asio::steady_timer writer_wake_;
  asio::steady_timer linger_;         ///< Bounds the end of a connection.
  std::vector<std::byte> tls_bytes_;  ///< Read through TLS; empty over TCP alone.
  bool lingers_ = false;
  bool reader_done_ = false;
  bool last_word_said_ = false;
};

}  // namespace cycloid::server
