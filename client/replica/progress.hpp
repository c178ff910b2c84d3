#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/replica/witness.hpp"
#include "protocol/messages.hpp"

namespace cycloid::client {

/// What a seat says for a tick.
using InputSource = std::function<scenes::SeatInput(int seat, std::uint64_t tick)>;

enum class Phase : std::uint8_t {
  kGreeting,  ///< The hello is out, no welcome yet.
  kLoading,   ///< Welcome, or a rewind; the exact state has not come whole yet.
  kRunning,
  kEnded,    ///< The server said goodbye.
  kRefused,  ///< The server sent us away.
  kFailed,   ///< The server broke the rules, or the world cannot step.
};

/// How far a follower has come. Counts since the hello.
struct Progress {
  Phase phase = Phase::kGreeting;
  std::string reason;  ///< Why it is over; "" while it is not.
  std::optional<protocol::Refused> refused;
  std::int32_t seat = protocol::kSpectator;
  std::uint64_t first_tick = 0;  ///< Of the first exact state.
  std::uint64_t last_tick = 0;   ///< Of the newest state that the server has confirmed.
  std::uint64_t frames = 0;
  std::uint64_t snapshots = 0;    ///< Exact states and deltas that were taken in.
  std::uint64_t states_kept = 0;  ///< Times that it went on from the state it came back with.
  std::uint64_t digests_compared = 0;
  std::uint64_t mismatches = 0;  ///< Digests that were compared and differed.
  std::uint64_t resyncs = 0;     ///< Exact states that ended a mismatch.
  std::uint64_t rewinds = 0;     ///< Times that the match went back to an earlier tick.
  std::uint64_t inputs_sent = 0;
  std::uint64_t inputs_replaced = 0;  ///< Frames in which my input was not the one I gave.
  std::uint64_t deltas_dropped = 0;   ///< Of a baseline that is not held here.
  std::uint32_t lead_ticks = 0;       ///< How far ahead of the last frame inputs are sent.
  std::int32_t early_ticks = 0;       ///< As the server's last Margin says.

  bool over() const { return phase >= Phase::kEnded; }
  /// Whether there has been a state of the server's on this connection.
  bool begun() const { return snapshots + states_kept != 0; }
};

struct FollowerOptions {
  std::uint64_t scene_digest = 0;
  std::int32_t seat_wish = protocol::kAnySeat;
  std::string name;
  std::string room;               ///< "": the only one, or the one that the token names.
  std::vector<std::byte> token;   ///< Signed admission; empty where the server asks for none.
  std::vector<std::byte> resume;  ///< Of the last Welcome, to get its seat back; or empty.
  /// The simulation handed over is the confirmed state that the connection before has left: the
  /// server is asked for the frames since. Of a lockstep client with `resume`, else ignored.
  bool holds_state = false;
  std::string build;  ///< Compiler and flags, for a desync report.
  protocol::Profile profile = protocol::Profile::kExact;
  InputSource input;  ///< Asked once for every tick, in order, when the client has a seat.
  /// Most ticks beyond the confirmed one that a replica predicts, up to 64; 0: none.
  std::uint32_t predict_ticks = 0;
  /// By seat: buttons that mean something only when they go down, and that no prediction repeats.
  std::vector<std::uint16_t> one_shot;
  /// Of an exact state that comes in parts; a server that announces more has failed.
  std::uint32_t snapshot_bytes_max = protocol::kServerMessageBytesMax;
  /// Frames that may wait for an exact state that is still on its way: one minute at 60 Hz.
  std::size_t frames_waiting_max = 3600;
  /// Of the states that a snapshot client keeps for deltas, all together.
  std::size_t baselines_bytes_max = std::size_t{32} << 20;
  std::shared_ptr<Witness> witness;  ///< May be none.
  /// Told every notice for the user of the client. May be empty.
  std::function<void(const protocol::RoomNotice&)> on_notice;
  /// Told every confirmed frame, in order, once its tick is made. May be empty.
  std::function<void(const protocol::InputFrame&)> on_frame;
};

}  // namespace cycloid::client
