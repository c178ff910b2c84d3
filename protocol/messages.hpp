#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "scenes/simulation.hpp"

namespace cycloid::protocol {

/// Why the server sends a client away. Stands before the constants, one of which an enumerator
/// would shadow.
enum class Refusal : std::uint8_t {
  kProtocolVersion = 1,
  kSolverVersion = 2,
  kSceneDigest = 3,
  kSeatTaken = 4,
  kNoSuchSeat = 5,
  kRoomFull = 6,
  kBadMessage = 7,  ///< Not verifiable, out of turn, or out of range.
  kTooLarge = 8,
  kTooSlow = 9,  ///< Its queue overran, or it was silent for too long.
  kDraining = 10,
  kFaulted = 11,  ///< The world is in its fault state.
};

inline constexpr std::uint32_t kProtocolVersion = 1;

/// Most bytes of one message's payload, by direction and by what the peer has proved. Checked
/// before anything is allocated.
inline constexpr std::uint32_t kHelloBytesMax = 1024;  ///< Before the hello is accepted.
inline constexpr std::uint32_t kClientMessageBytesMax = 4096;
inline constexpr std::uint32_t kServerMessageBytesMax = 64u << 20;

inline constexpr std::size_t kNameBytesMax = 64;
inline constexpr std::size_t kReasonBytesMax = 512;  ///< What is longer is cut when it is sent.
inline constexpr std::size_t kFrameEventsMax = 1024;

/// Where the input of a seat in a frame came from.
enum class Origin : std::uint8_t {
  kGiven = 1,     ///< The client's, in time.
  kRepeated = 2,  ///< The last one given, because none came in time.
  kAbsent = 3,    ///< Neutral: nobody sits there, or nothing was ever given.
};

struct SeatFrame {
  Origin origin = Origin::kAbsent;
  scenes::SeatInput input;
  friend bool operator==(const SeatFrame&, const SeatFrame&) = default;
};

enum class EventKind : std::uint8_t { kJoin = 1, kLeave = 2 };

struct FrameEvent {
  EventKind kind = EventKind::kJoin;
  std::uint16_t seat = 0;
  friend bool operator==(const FrameEvent&, const FrameEvent&) = default;
};

/// What happened in one tick, decided by the server alone. The frames with the scene are the match.
struct InputFrame {
  std::uint64_t tick = 0;  ///< The tick this frame makes; the first is 1.
  std::vector<SeatFrame> seats;
  std::vector<FrameEvent> events;
  friend bool operator==(const InputFrame&, const InputFrame&) = default;
};

enum class Mode : std::uint8_t { kLockstep = 1, kSnapshot = 2 };

inline constexpr std::int32_t kAnySeat = -1;
inline constexpr std::int32_t kSpectator = -2;

// What a client says.

struct Hello {
  std::uint32_t protocol_version = kProtocolVersion;
  std::uint32_t solver_version = solver::kSolverVersion;
  std::uint64_t scene_digest = 0;
  Mode mode = Mode::kLockstep;
  std::int32_t seat_wish = kAnySeat;
  std::string name;  ///< For the server's log; at most 64 bytes of UTF-8.
};

/// Wanted at `tick`. Too late is too late: it is never applied to a past tick.
struct Input {
  std::uint64_t tick = 0;
  scenes::SeatInput input;
};

/// The sender's digest after `tick`.
struct Digest {
  std::uint64_t tick = 0;
  std::uint64_t digest = 0;
};

struct Ping {
  std::uint64_t token = 0;
};

struct Bye {
  std::string reason;
};

using ClientMessage = std::variant<Hello, Input, Digest, Ping, Bye>;

// What the server says.

struct Welcome {
  std::int32_t seat = kSpectator;
  std::uint32_t seats = 0;
  std::uint64_t tick = 0;  ///< Last tick made. A snapshot of exactly this tick follows.
  std::uint32_t tick_rate_millihertz = 60000;
  std::uint32_t input_delay_ticks = 2;  ///< Lead at which a client should send its inputs.
};

/// The server's last word on a connection; `reason` holds both values where two did not match.
struct Refused {
  Refusal code = Refusal::kBadMessage;
  std::string reason;
};

struct Snapshot {
  std::uint64_t tick = 0;
  std::uint64_t digest = 0;
  std::vector<std::byte> state;  ///< World::encode.
};

struct Pong {
  std::uint64_t token = 0;
  std::uint64_t tick = 0;
};

using ServerMessage = std::variant<Welcome, Refused, InputFrame, Snapshot, Digest, Pong, Bye>;

}  // namespace cycloid::protocol
