#pragma once

#include <asio.hpp>
#include <chrono>
#include <memory>

#include "server/room/room.hpp"

namespace cycloid::server {

/// One connection: bytes between a socket and the room, which decides everything.
///
/// A reader and a writer, each a coroutine that owns a reference; the session dies when both have
/// ended. What waits to be sent lies in the room, bounded; beside it there is one write under way.
class Session : public std::enable_shared_from_this<Session> {
 public:
  Session(asio::ip::tcp::socket socket, Room& room);

  void start();
  /// The room was called: it may have output, or want the connection closed.
  void wake();
  void close();

 private:
  asio::awaitable<void> read_loop();
  asio::awaitable<void> write_loop();

  asio::ip::tcp::socket socket_;
  Room& room_;
  PeerId id_ = kNobody;
  asio::steady_timer reader_wake_;  ///< Waits for ever; cancelled to go on.
  asio::steady_timer writer_wake_;
  asio::steady_timer linger_;  ///< Bounds the end of a connection.
  bool lingers_ = false;
  bool reader_done_ = false;
  bool last_word_said_ = false;
};

}  // namespace cycloid::server
