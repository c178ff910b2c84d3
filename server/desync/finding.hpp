#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/log_format.hpp"
#include "scenes/scene.hpp"
#include "server/room/seats.hpp"

namespace cycloid::server {

/// The exact state of the server after a tick, as it was in its memory.
struct KeptState {
  std::uint64_t tick = 0;
  std::uint64_t digest = 0;
  std::shared_ptr<const std::vector<std::byte>> state;  ///< Simulation::encode; never empty.
};

/// A lockstep client as a report names it.
struct ClientIdentity {
  PeerId peer = kNobody;
  std::string name;
  std::string build;  ///< Compiler and flags, by its own word.
  std::int32_t seat = protocol::kSpectator;
};

/// What the replicas said of one tick, each once.
struct ReplicaVotes {
  std::uint32_t with_server = 0;
  std::uint32_t largest_other = 0;  ///< Most replicas that agree with each other, but not with us.
  std::uint64_t other_digest = 0;   ///< What those said.
  std::uint32_t replicas = 0;       ///< All that said something.

  /// Whether the replicas prove the server wrong, as far as a count can.
  bool against_server() const { return largest_other >= 2 && largest_other > with_server; }
};

/// The room of a match and what it runs, the same for all its findings.
struct RoomIdentity {
  std::string room;
  std::shared_ptr<const scenes::Scene> scene;
  std::uint64_t scene_digest = 0;
  std::string build;  ///< The server's compiler and flags.
  std::uint32_t tick_rate_millihertz = 60000;
};

/// A desync with all that is needed to look into it, away from the room: a value that any thread
/// may work on.
struct Finding {
  std::shared_ptr<const RoomIdentity> room;
  ClientIdentity client;
  std::uint64_t noticed_tick = 0;  ///< Whose digests were compared.
  std::uint64_t tick = 0;          ///< The first of which the digests are known to differ.
  /// The tick before is known to be equal; else `tick` is only the first that could be compared.
  bool is_first = false;
  std::uint64_t server_digest = 0;  ///< Of `tick`.
  std::uint64_t client_digest = 0;  ///< By the client's word.
  ReplicaVotes votes;               ///< Of `noticed_tick`.

  std::optional<KeptState> start;        ///< Of the server, of a tick before `tick`.
  std::vector<protocol::LogTick> ticks;  ///< From there on, beyond `tick` where they were made.
  std::optional<KeptState> later;        ///< Of the server, of `tick` or later.
  std::vector<std::byte> client_state;   ///< After `tick`, as the client sent it; may be anything.
  std::string missing;                   ///< Why there is no client_state, or "".
};

}  // namespace cycloid::server
