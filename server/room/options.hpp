#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>

#include "protocol/lockstep.hpp"
#include "server/room/policy.hpp"

namespace cycloid::server {

/// The most lead that clients may be told to keep. Well within the window of inputs, so that what
/// comes a little earlier than that is still in time.
inline constexpr std::uint32_t kInputDelayTicksMax = 60;
static_assert(kInputDelayTicksMax < protocol::kInputWindowTicks);

/// What one room and its peers may use up; docs/protocol.md says what happens at each bound.
/// None may be 0 unless its comment says so.
struct Limits {
  std::size_t connections_max = 1024;
  /// Of one client in a tick, or in 100 ms where a tick lasts longer; what is more waits.
  std::uint32_t messages_per_tick_max = 64;
  std::size_t queue_bytes_max = std::size_t{1} << 20;  ///< Of one client, states not counted.
  std::chrono::nanoseconds handshake{std::chrono::seconds{5}};  ///< From connection to hello.
  std::chrono::nanoseconds idle{std::chrono::seconds{30}};      ///< Without any message.
  std::uint32_t catch_up_ticks_max = 8;  ///< In one `advance`; a room further behind is slowed.
  std::uint64_t digest_ticks = 60;       ///< Ticks between two digests to lockstep clients.
  std::uint64_t snapshot_ticks = 3;      ///< Ticks between two snapshots to snapshot clients.
  /// The lead that clients are told to keep at first, up to kInputDelayTicksMax.
  std::uint32_t input_delay_ticks = 2;

  std::chrono::nanoseconds queue_age{std::chrono::seconds{2}};  ///< Of the oldest waiting frame.
  std::uint32_t state_parts_per_tick_max = 8;                   ///< Of 16 KiB, likewise.
  std::uint32_t state_restarts_max = 3;  ///< Of one transfer to a client that lags behind.
  std::uint32_t resyncs_max = 3;         ///< Of one client within `resync_window`.
  std::chrono::nanoseconds resync_window{std::chrono::minutes{5}};
  std::uint32_t words_per_input_max = 8;  ///< Inputs that one client may say for the same tick.
  std::uint64_t messages_per_s = 1200;    ///< Of one client, twice as many at once.
  std::uint64_t bytes_per_s = 262144;     ///< Likewise; of both see `at_tick_rate`.

  std::chrono::nanoseconds resume{std::chrono::seconds{10}};  ///< 0: a lost seat is free at once.
  std::uint32_t slow_ticks_max = 120;  ///< Inputs missed in a row before `RoomOptions::slow`.

  // What late spectators need is kept all the same; a configuration that has no room for it is
  // refused.
  std::size_t frames_kept_max = 3600;
  std::uint64_t keyframe_ticks = 60;
  std::size_t keyframe_bytes_max = std::size_t{8} << 20;
  /// Of all states that snapshots may differ from, for each profile.
  std::size_t baseline_bytes_max = std::size_t{4} << 20;
  std::size_t snapshot_bytes_max = 1200;  ///< Of one quantised snapshot.
};

/// The limits of a room of so many ticks a second: an honest client says a message or two a tick,
/// so what one may say in a second stands for up to 300 ticks, and is as many times more where
/// there are more.
inline Limits at_tick_rate(std::uint32_t tick_rate_millihertz, Limits limits) {
  constexpr std::uint64_t kMillihertz = 300'000;
  constexpr std::uint64_t kMost = 1'000'000'000;  // Twice as many fit a Rate.
  for (std::uint64_t* per_s : {&limits.messages_per_s, &limits.bytes_per_s}) {
    const std::uint64_t scaled = *per_s * tick_rate_millihertz / kMillihertz;
    *per_s = std::max(*per_s, std::min(scaled, kMost));
  }
  return limits;
}

/// What a room has to keep for spectators that see the match so many ticks late: they are served
/// from the kept state before what they may see, and by the frames behind it. 0 without a delay.
inline std::uint64_t frames_for_delay(std::uint64_t delay_ticks, std::uint64_t keyframe_ticks) {
  return delay_ticks == 0 ? 0 : delay_ticks + 2 * keyframe_ticks;
}
inline std::uint64_t states_for_delay(std::uint64_t delay_ticks, std::uint64_t keyframe_ticks) {
  return delay_ticks == 0 ? 0 : delay_ticks / keyframe_ticks + 2;
}

struct RoomOptions {
  Limits limits;
  std::uint64_t scene_digest = 0;
  std::uint32_t tick_rate_millihertz = 60000;  ///< @pre > 0.
  std::uint64_t ticks = 0;                     ///< End after so many; 0: never.
  bool stop_on_log_error = false;
  std::string name;   ///< "": answers to every room name.
  std::string build;  ///< The server's compiler and flags, for a desync report.
  InputPolicy policy;
  SlowPeer slow = SlowPeer::kReplace;
  DelayPolicy delay;
  std::uint64_t spectator_delay_ticks = 0;  ///< Admins see the match as it is.
};

}  // namespace cycloid::server
