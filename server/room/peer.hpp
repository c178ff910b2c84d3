#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "protocol/codec.hpp"
#include "protocol/state/state_feed.hpp"
#include "server/admission/refill_bucket.hpp"
#include "server/room/act_budget.hpp"
#include "server/room/admission.hpp"
#include "server/room/options.hpp"
#include "server/room/outbox.hpp"
#include "server/room/seats.hpp"

namespace cycloid::server {

enum class PeerStage : std::uint8_t { kGreeting, kPlaying, kClosing };

/// What a room knows of one connection.
struct Peer {
  Peer(const Limits& limits, std::int64_t now_ns)
      : connected_ns(now_ns),
        heard_ns(now_ns),
        outbox(limits.queue_bytes_max),
        parts_left(limits.state_parts_per_tick_max),
        messages_rate(twice_at_once(limits.messages_per_s), now_ns),
        bytes_rate(twice_at_once(limits.bytes_per_s), now_ns),
        desyncs(limits.resyncs_max, limits.resync_window),
        overruns(limits.resyncs_max, limits.resync_window) {}

  static Rate twice_at_once(std::uint64_t per_s) {
    return {static_cast<std::uint32_t>(per_s), static_cast<std::uint32_t>(2 * per_s)};
  }
  /// New rates begin with all that they allow at once; what was done counts on against new budgets.
  void set_limits(const Limits& limits, std::int64_t now_ns) {
    messages_rate = RefillBucket(twice_at_once(limits.messages_per_s), now_ns);
    bytes_rate = RefillBucket(twice_at_once(limits.bytes_per_s), now_ns);
    desyncs.set_bounds(limits.resyncs_max, limits.resync_window);
    overruns.set_bounds(limits.resyncs_max, limits.resync_window);
  }
  bool playing() const { return stage == PeerStage::kPlaying; }

  PeerStage stage = PeerStage::kGreeting;
  std::int64_t connected_ns = 0;
  std::int64_t heard_ns = 0;  ///< When its last whole message came.
  protocol::Framer framer{protocol::kHelloBytesMax};
  std::uint32_t messages = 0;  ///< Since it was last served.
  Outbox outbox;
  std::uint32_t parts_left;  ///< Of a state, until it is served again.
  RefillBucket messages_rate;
  RefillBucket bytes_rate;
  ActBudget desyncs;
  ActBudget overruns;

  std::string name;
  std::string identity;  ///< Of its token; "" where it had none.
  std::string build;
  Role role = Role::kPlayer;
  protocol::Mode mode = protocol::Mode::kLockstep;
  bool packs = false;  ///< Understands packed frames.
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
  std::uint64_t exact_tick = 0;         ///< Of its last exact state; older digests say nothing.
  std::uint64_t next_frame = 0;         ///< Tick of the next frame to queue for a lockstep client.
  protocol::SentStates sent;            ///< Of a snapshot client, as the next two.
  std::uint64_t acknowledged_tick = 0;  ///< The last one that it has said, of whichever branch.
  std::uint32_t rewinds_unheard = 0;    ///< That it was told of, and has not shown to have heard.
  std::uint64_t free_bytes = 0;         ///< Of its state, which the room has asked for.
  bool desync_noticed = false;
};

}  // namespace cycloid::server
