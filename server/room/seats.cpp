#include "server/room/seats.hpp"

#include <algorithm>
#include <utility>

namespace cycloid::server {

std::size_t SeatTable::held() const {
  return static_cast<std::size_t>(std::ranges::count(seats_, SeatState::kHeld, &SeatHold::state));
}

bool SeatTable::may_claim(std::size_t seat, const SeatClaim& claim) const {
  const SeatHold& hold = seats_[seat];
  if (hold.state == SeatState::kFree) return true;
  if (hold.state != SeatState::kReserved) return false;
  if (!hold.identity.empty()) return hold.identity == claim.identity;
  return std::cmp_equal(claim.bound, seat);
}

std::string SeatTable::taken_by(std::size_t seat) const {
  const SeatHold& hold = seats_[seat];
  const std::string name = "seat " + std::to_string(seat);
  switch (hold.state) {
    case SeatState::kReserved:
      return name + " is reserved up to tick " + std::to_string(hold.end_tick);
    case SeatState::kLost:
      return name + " waits for its player up to tick " + std::to_string(hold.end_tick);
    case SeatState::kHeld:
    case SeatState::kFree:
      break;
  }
  return name + " is held by client " + std::to_string(hold.holder);
}

std::optional<std::size_t> SeatTable::find(const SeatClaim& claim, SeatProblem& problem) const {
  const std::string seats = std::to_string(seats_.size());
  const std::int32_t wish = claim.bound == protocol::kAnySeat ? claim.wish : claim.bound;
  if (wish != protocol::kAnySeat) {
    const auto seat = static_cast<std::size_t>(wish);
    if (wish < 0 || seat >= seats_.size()) {
      problem = {protocol::Refusal::kNoSuchSeat,
                 "seat " + std::to_string(wish) + ", here are " + seats + " seats from 0"};
    } else if (!may_claim(seat, claim)) {
      problem = {protocol::Refusal::kSeatTaken, taken_by(seat)};
    } else {
      return seat;
    }
    return std::nullopt;
  }
  // What was promised to the newcomer comes before what anybody may have.
  std::optional<std::size_t> found;
  for (std::size_t seat = 0; seat < seats_.size(); ++seat) {
    if (!may_claim(seat, claim)) continue;
    if (seats_[seat].state == SeatState::kReserved) return seat;
    if (!found) found = seat;
  }
  if (!found) problem = {protocol::Refusal::kRoomFull, seats + " seats taken, of " + seats};
  return found;
}

void SeatTable::sit(std::size_t seat, PeerId holder, const std::string& identity) {
  seats_[seat] = {};
  seats_[seat].state = SeatState::kHeld;
  seats_[seat].holder = holder;
  seats_[seat].identity = identity;
}

void SeatTable::lose(std::size_t seat, std::uint64_t end_tick) {
  SeatHold& hold = seats_[seat];
  hold.state = SeatState::kLost;
  hold.holder = kNobody;
  hold.end_tick = end_tick;
}

void SeatTable::resume(std::size_t seat, PeerId holder) {
  SeatHold& hold = seats_[seat];
  hold.state = SeatState::kHeld;
  hold.holder = holder;
  hold.missed = 0;
  hold.window.count_anew();
  hold.margin = {};
}

bool SeatTable::reserve(std::size_t seat, const std::string& identity, std::uint64_t end_tick) {
  if (seat >= seats_.size()) return false;
  SeatHold& hold = seats_[seat];
  if (hold.state == SeatState::kHeld || hold.state == SeatState::kLost) return false;
  hold = {};
  hold.state = SeatState::kReserved;
  hold.identity = identity;
  hold.end_tick = end_tick;
  return true;
}

std::vector<std::size_t> SeatTable::expire(std::uint64_t tick) {
  std::vector<std::size_t> lost;
  for (std::size_t seat = 0; seat < seats_.size(); ++seat) {
    const SeatState state = seats_[seat].state;
    const bool waits = state == SeatState::kReserved || state == SeatState::kLost;
    if (!waits || tick < seats_[seat].end_tick) continue;
    if (state == SeatState::kLost) lost.push_back(seat);
    free(seat);
  }
  return lost;
}

void SeatTable::rewind(std::uint64_t from_tick, std::uint64_t to_tick) {
  for (SeatHold& hold : seats_) {
    hold.window = {};
    hold.margin = {};
    hold.missed = 0;
    const std::uint64_t left = hold.end_tick > from_tick ? hold.end_tick - from_tick : 0;
    hold.end_tick = to_tick + left;
  }
}

}  // namespace cycloid::server
