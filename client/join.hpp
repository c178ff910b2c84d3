#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "client/replica/follower.hpp"
#include "protocol/messages.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::client {

struct JoinOptions {
  std::string host = "127.0.0.1";
  std::uint16_t port = 0;
  scenes::Scene scene;
  protocol::Mode mode = protocol::Mode::kLockstep;
  std::int32_t seat_wish = protocol::kAnySeat;
  std::string name;
  std::uint64_t ticks = 0;  ///< Leave after so many ticks of the match; 0: stay.
  int workers = 1;
  InputSource input;  ///< Where empty: scenes::scripted_input of the scene.
  std::chrono::milliseconds connect{5000};
  std::chrono::milliseconds handshake{10000};  ///< From the connection to the first snapshot.
  std::chrono::milliseconds silence{10000};
  /// Asked about every 50 ms, on the thread of `join`; true makes it leave.
  std::function<bool()> should_stop;
  /// Told after every message that was taken in, such as to draw the state.
  std::function<void(Follower&)> on_progress;
};

enum class End : std::uint8_t {
  kTicks,         ///< The wanted number of ticks was seen.
  kBye,           ///< The server closed the match.
  kStopped,       ///< By `should_stop`.
  kRefused,       ///< By the server; `refused` says why.
  kDisconnected,  ///< No connection, or it broke, or a deadline passed.
  kFailed,        ///< The server broke the protocol, or the scene cannot run here.
};

const char* end_name(End end);

struct JoinReport {
  End end = End::kFailed;
  std::string reason;
  Progress progress;
  std::uint64_t final_digest = 0;  ///< Of the state at `progress.last_tick`.
  std::uint64_t bytes_in = 0;
  std::uint64_t bytes_out = 0;

  const std::optional<protocol::Refused>& refused() const { return progress.refused; }
};

/// Plays in a room until the ticks are over, the server says goodbye or sends us away, or the
/// connection breaks. Blocks; but never longer than the deadlines where the server does not answer.
JoinReport join(const JoinOptions& options);

}  // namespace cycloid::client
