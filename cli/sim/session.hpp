#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "cli/sim/chronicle.hpp"
#include "cli/sim/ledger.hpp"
#include "cli/sim/pipe.hpp"
#include "cli/sim/plant.hpp"
#include "server/admission/gate.hpp"
#include "server/room/room.hpp"

namespace cycloid::sim {

/// What a connection comes to: first the gate, then the room.
struct House {
  server::Gate* gate = nullptr;
  server::Room* room = nullptr;
  const Ledger* ledger = nullptr;
};

/// The server's side of a connection, as server/host/gatehouse.cpp and server/net/session.cpp are
/// over a socket: its first message is for the gate; then it reads while the room wants bytes,
/// writes one batch after the other, and lingers for a second behind the last word.
class Session {
 public:
  Session(std::shared_ptr<Wire> wire, const House& house, const server::Limits& limits, Plant plant,
          Chronicle& chronicle);

  /// @param step_ns  Since the last one that the server took.
  void step(std::int64_t step_ns);
  server::GateId gate_id() const { return gate_id_; }
  /// The gate's last word.
  void turn_away(const server::GateRefused& refused);
  /// The server is gone: the kernel resets what it held.
  void die() { wire_->reset(); }
  bool closed() const { return closed_; }

  bool is_over(const Wire& wire) const { return wire_.get() == &wire; }
  bool is_served() const { return stage_ == Stage::kRoom && !closed_ && !is_dismissed(); }
  /// The room has yet to hand out all of an exact state.
  bool waits_for_state() const { return stage_ == Stage::kRoom && house_.room->owes_state(id_); }

  /// That a welcome gave it, while the room has not sent it away; or below 0.
  std::int32_t seat() const { return closed_ || is_dismissed() ? -1 : seat_; }

 private:
  enum class Stage : std::uint8_t { kGate, kRoom, kTurnedAway };

  void enter(const server::PeerAddress& from);
  void hear_at_gate(std::span<const std::byte> bytes);
  bool wants_bytes() const { return stage_ != Stage::kRoom || house_.room->wants_bytes(id_); }
  /// Nothing will be said to it any more but what waits already.
  bool is_dismissed() const {
    return stage_ == Stage::kTurnedAway ||
           (stage_ == Stage::kRoom && house_.room->wants_close(id_));
  }
  void read();
  void receive(std::span<const std::byte> bytes);
  void write();
  void look_at(const protocol::Bytes& output);
  void check_bound(const protocol::Bytes& output);
  void close();
  std::string name() const { return "connection " + std::to_string(wire_->number); }

  std::shared_ptr<Wire> wire_;
  House house_;
  server::Limits limits_;
  Plant plant_;
  Chronicle* chronicle_;
  OutputTamper tamper_;
  Stage stage_ = Stage::kGate;
  server::GateId gate_id_ = 0;
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
