#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/codec.hpp"
#include "protocol/state/state_feed.hpp"
#include "server/room/admission.hpp"
#include "server/room/options.hpp"
#include "server/room/outbox.hpp"
#include "server/room/rates.hpp"
#include "server/room/seats.hpp"

namespace cycloid::server {

enum class PeerStage : std::uint8_t { kGreeting, kPlaying, kClosing };

/// What a room knows of one connection.
struct Peer {
  explicit Peer(const Limits& limits)
      : outbox(limits.queue_bytes_max),
        parts_left(limits.state_parts_per_tick_max),
        messages_rate(limits.messages_per_s, 2 * limits.messages_per_s),
        bytes_rate(limits.bytes_per_s, 2 * limits.bytes_per_s),
        desyncs(limits.resyncs_max, limits.resync_window),
        overruns(limits.resyncs_max, limits.resync_window) {}

  bool playing() const { return stage == PeerStage::kPlaying; }

  PeerStage stage = PeerStage::kGreeting;
  std::int64_t connected_ns = 0;
  std::int64_t heard_ns = 0;  ///< When its last whole message came.
  protocol::Framer framer{protocol::kHelloBytesMax};
  std::uint32_t messages = 0;  ///< Since the last tick.
  Outbox outbox;
  std::uint32_t parts_left;  ///< Of a state, until the next tick.
  RateBucket messages_rate;
  RateBucket bytes_rate;
  ActBudget desyncs;
  ActBudget overruns;

  std::string name;
  std::string build;
  Role role = Role::kPlayer;
  protocol::Mode mode = protocol::Mode::kLockstep;
  protocol::Profile profile = protocol::Profile::kExact;
  std::int32_t seat = protocol::kSpectator;
  bool unseated = false;  ///< Had a seat; the inputs that it sent before it knew are no mistake.
  std::uint64_t delay_ticks = 0;  ///< Behind the match, as a spectator.

  bool welcome_due = false;
  bool resumed = false;
  std::vector<std::byte> secret;  ///< To be said in its welcome.
  bool secret_proved = true;      ///< It has shown that it has that welcome.
  bool state_due = false;  ///< An exact state is to be begun as soon as the connection takes bytes.
  std::int64_t state_due_ns = 0;
  std::uint32_t state_restarts = 0;
  std::uint64_t exact_tick = 0;  ///< Of its last exact state; older digests say nothing.
  std::uint64_t next_frame = 0;  ///< Tick of the next frame to queue for a lockstep client.
  protocol::SentStates sent;     ///< Of a snapshot client.
  std::uint64_t free_bytes = 0;  ///< Of its state, which the room has asked for.
  bool desync_noticed = false;
};

}  // namespace cycloid::server
