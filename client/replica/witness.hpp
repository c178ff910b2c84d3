#pragma once

#include <cstdint>
#include <vector>

#include "protocol/messages.hpp"

namespace cycloid::client {

/// Messages to send, in order. Whoever owns the connection empties it.
using Outbox = std::vector<protocol::ClientMessage>;

/// Sees every confirmed state of a lockstep replica, and answers what the server asks after a
/// mismatch. This one keeps nothing and says nothing.
class Witness {
 public:
  virtual ~Witness() = default;

  /// The world as it is after a confirmed tick, whatever has been predicted beyond it.
  virtual void confirmed(const scenes::Simulation&) {}
  /// The confirmed world right before the step that leaves it, and before `diverged`: what
  /// `confirmed` saw, unless something in memory has changed it since.
  virtual void leaving(const scenes::Simulation&, Outbox&) {}
  /// My digest of this tick is the server's.
  virtual void agreed(std::uint64_t /*tick*/) {}
  /// The exact state of the server is in place of the world now: what was seen before is gone.
  virtual void replaced(const scenes::Simulation&) {}
  /// My digest of this tick is not the server's.
  virtual void diverged(std::uint64_t /*tick*/, Outbox&) {}
  /// The server asks for my state after a tick.
  virtual void wanted(const protocol::StateWanted&, Outbox&) {}
};

}  // namespace cycloid::client
