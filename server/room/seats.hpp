#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "protocol/messages.hpp"
#include "server/room/input_window.hpp"
#include "server/room/margin_meter.hpp"

namespace cycloid::server {

/// Names a connection for the life of a room; never given out twice.
using PeerId = std::uint64_t;
inline constexpr PeerId kNobody = 0;

enum class SeatState : std::uint8_t {
  kFree,
  kReserved,  ///< For whoever it was promised to, up to a tick.
  kHeld,
  kLost,  ///< Its holder's connection is gone; up to a tick it may come back.
};

/// A seat: who holds it, and what was said there.
struct SeatHold {
  SeatState state = SeatState::kFree;
  PeerId holder = kNobody;     ///< Of kHeld.
  std::string identity;        ///< Of its holder, or of whom it is reserved for; may be "".
  std::uint64_t end_tick = 0;  ///< Of kReserved and kLost: free once this tick is made.
  std::uint32_t missed = 0;    ///< Inputs in a row.
  InputWindow window;
  MarginMeter margin;
};

/// What a newcomer asks for.
struct SeatClaim {
  std::int32_t wish = protocol::kAnySeat;
  std::int32_t bound = protocol::kAnySeat;  ///< By its token; kAnySeat: by none.
  std::string identity;
};

/// Why a claim has no seat.
struct SeatProblem {
  protocol::Refusal code = protocol::Refusal::kRoomFull;
  std::string reason;
};

/// The seats of a room. Knows nothing of events or connections: who changes a seat says so.
class SeatTable {
 public:
  explicit SeatTable(std::size_t seats) : seats_(seats) {}

  std::size_t size() const { return seats_.size(); }
  SeatHold& operator[](std::size_t seat) { return seats_[seat]; }
  const SeatHold& operator[](std::size_t seat) const { return seats_[seat]; }
  std::size_t held() const;

  /// The seat that the claim may have, which nobody holds; or nothing, and why. Changes nothing.
  /// @pre the wish is no spectator's, and there are seats.
  std::optional<std::size_t> find(const SeatClaim& claim, SeatProblem& problem) const;

  void sit(std::size_t seat, PeerId holder, const std::string& identity);
  void free(std::size_t seat) { seats_[seat] = {}; }
  /// Keeps what was said in time; @pre it is held.
  void lose(std::size_t seat, std::uint64_t end_tick);
  /// @pre it is held by another connection, or lost.
  void resume(std::size_t seat, PeerId holder);
  /// For an identity, or, where that is "", for the token bound to this seat. False, and nothing
  /// has changed, where the seat does not exist or is neither free nor reserved.
  [[nodiscard]] bool reserve(std::size_t seat, const std::string& identity, std::uint64_t end_tick);
  /// Frees what has waited long enough once `tick` is made, and says which seats were lost ones.
  std::vector<std::size_t> expire(std::uint64_t tick);
  /// The match goes on from an earlier tick: what was said is for ticks of a future that is gone,
  /// and what waits does so for as long as before.
  void rewind(std::uint64_t from_tick, std::uint64_t to_tick);

 private:
  bool may_claim(std::size_t seat, const SeatClaim& claim) const;
  std::string taken_by(std::size_t seat) const;

  std::vector<SeatHold> seats_;
};

}  // namespace cycloid::server
