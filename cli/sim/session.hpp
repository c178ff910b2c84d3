#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/sim/chronicle.hpp"
#include "cli/sim/pipe.hpp"
#include "cli/sim/plant.hpp"
#include "server/room/room.hpp"

namespace cycloid::sim {

/// The server's side of a connection, as server/net/session.cpp is over a socket: reads while the
/// room wants bytes, writes one batch after the other, lingers for a second behind the last word.
class Session {
 public:
  Session(std::shared_ptr<Wire> wire, server::Room& room, const server::Limits& limits, Plant plant,
          Chronicle& chronicle);

  /// @param step_ns  Since the last one that the server took.
  void step(std::int64_t step_ns);
  /// The server is gone: the kernel resets what it held.
  void die() { wire_->reset(); }
  bool closed() const { return closed_; }

  /// That a welcome gave it, while the room has not sent it away; or below 0.
  std::int32_t seat() const { return closed_ || room_->wants_close(id_) ? -1 : seat_; }

 private:
  void read();
  void receive(std::span<const std::byte> bytes);
  void write();
  void look_at(const protocol::Bytes& output);
  void check_bound(const protocol::Bytes& output);
  void close();
  std::string name() const { return "connection " + std::to_string(wire_->number); }

  std::shared_ptr<Wire> wire_;
  server::Room* room_;
  server::Limits limits_;
  Plant plant_;
  Chronicle* chronicle_;
  OutputTamper tamper_;
  server::PeerId id_ = server::kNobody;
  protocol::Bytes said_;  ///< Of the plant that extends the deadline: all before the welcome.
  protocol::Bytes pending_;
  std::size_t written_ = 0;
  std::int64_t greeting_ns_ = 0;  ///< How long the server has waited for its hello.
  std::int64_t linger_until_ns_ = kNever;
  std::int32_t seat_ = -1;
  bool answered_ = false;
  bool last_word_said_ = false;
  bool reader_done_ = false;
  bool closed_ = false;
};

}  // namespace cycloid::sim
