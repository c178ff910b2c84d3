#pragma once

#include <asio.hpp>
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

/// Of one read, over TCP or through TLS. What a client says in a tick has some 40 bytes.
inline constexpr std::size_t kSessionReadBytes = 512;
inline constexpr std::size_t kSessionTlsReadBytes = 4096;

using RoomStrand = asio::strand<asio::io_context::executor_type>;

/// Where a session lives. All of it outlives the session, because `keep` does.
struct SessionPlace {
  RoomStrand strand;
  Room& room;
  std::shared_ptr<void> keep;
};

/// One connection in a room: bytes between a socket and the room, which decides everything. All of
/// it on the room's strand.
///
/// What waits to be sent lies in the room, bounded. When the room was called it is written at once,
/// all of it in one write, as far as the socket takes it; only for what is left does anything wait.
/// So a client costs a tick one system call to read and one to write, and no timer and no hop to
/// another handler. Through TLS, whose writes cannot be tried, each is waited for.
///
/// The session lives as long as one of its waits does: there is a read, or a pause of reading,
/// until its end.
class Session : public std::enable_shared_from_this<Session> {
 public:
  Session(Entrant entrant, SessionPlace place);

  /// Brings the client into the room.
  void start();
  /// The room was called: it may have output, or want the connection closed.
  void wake();
  void close();

 private:
  void enter();
  void read();
  void pause();
  void on_read(const asio::error_code& error, std::size_t bytes);
  void write();
  asio::error_code write_now();
  void write_rest();
  void on_written(const asio::error_code& error);
  void say_last_word();
  void linger();

  Entrant entrant_;
  SessionPlace place_;
  PeerId id_ = kNobody;
  asio::steady_timer pause_;         ///< While the room wants no bytes; cancelled to go on.
  asio::steady_timer linger_;        ///< Bounds the end of a connection.
  std::vector<std::byte> incoming_;  ///< What one read takes.
  std::vector<Shared> output_;       ///< What one write takes, and its buffers.
  std::vector<asio::const_buffer> buffers_;
  std::span<asio::const_buffer> rest_;  ///< Of the buffers: not written yet.
  protocol::Bytes joined_;              ///< The same for TLS, where each buffer would be a record.
  bool reading_ = false;
  bool paused_ = false;
  bool writing_ = false;
  bool lingers_ = false;
  bool reader_done_ = false;
  bool last_word_said_ = false;
};

}  // namespace cycloid::server
