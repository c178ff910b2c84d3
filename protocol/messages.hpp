#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "scenes/simulation.hpp"
#include "solver/definitions.hpp"
#include "solver/version.hpp"

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
  kFaulted = 11,       ///< The world is in its fault state.
  kTokenInvalid = 12,  ///< None where one is needed, damaged, or signed by nobody known here.
  kTokenExpired = 13,
  kTokenUsed = 14,   ///< Its nonce was seen before.
  kTokenScope = 15,  ///< Good, but for another room, seat or role.
  kNoSuchRoom = 16,
  kRoomLocked = 17,     ///< Full by an admin's word, not by its seats.
  kRateLimited = 18,    ///< More messages, bytes, inputs or connections than one peer may have.
  kKicked = 19,         ///< By an admin.
  kReplaced = 20,       ///< The same seat was resumed on another connection.
  kResumeUnknown = 21,  ///< A resume token that is not, or no longer, of a seat here.
  kResyncLimit = 22,    ///< Desynced more often than a room mends.
};
inline constexpr Refusal kLastRefusal = Refusal::kResyncLimit;

/// Peers of another version do not understand each other; of another minor version they do, and the
/// newer one leaves out what the older one has not heard of.
inline constexpr std::uint32_t kProtocolVersion = 2;
inline constexpr std::uint16_t kProtocolMinor = 1;
/// From this minor version on a client understands packed frames.
inline constexpr std::uint16_t kPackedFramesMinor = 1;

/// Most bytes of one message's payload, by direction and by what the peer has proved. Checked
/// before anything is allocated.
inline constexpr std::uint32_t kHelloBytesMax = 1024;  ///< Before the hello is accepted.
inline constexpr std::uint32_t kClientMessageBytesMax = 4096;
inline constexpr std::uint32_t kServerMessageBytesMax = 64u << 20;

/// Of messages and logs, too.
using solver::kTickEnd;

inline constexpr std::size_t kNameBytesMax = 64;
inline constexpr std::size_t kRoomNameBytesMax = 64;
inline constexpr std::size_t kTokenBytesMax = 512;
inline constexpr std::size_t kBuildBytesMax = 128;
inline constexpr std::size_t kResumeBytes = 32;
/// Of one part of an exact snapshot, and of one part of a client's own state.
inline constexpr std::size_t kSnapshotPartBytesMax = 16384;
inline constexpr std::size_t kStatePartBytesMax = 3072;
inline constexpr std::size_t kTickDigestsMax = 192;  ///< In one message of them.
inline constexpr std::size_t kReasonBytesMax = 512;  ///< What is longer is cut when it is sent.
inline constexpr std::size_t kFrameEventsMax = 1024;
inline constexpr std::size_t kFrameChangesMax = 8;

/// Where the input of a seat in a frame came from.
enum class Origin : std::uint8_t {
  kGiven = 1,     ///< The client's, in time.
  kRepeated = 2,  ///< The last one given, because none came in time.
  kAbsent = 3,    ///< Neutral: nobody sits there, or nothing was ever given.
  kNeutral = 4,  ///< Somebody sits there, none came in time, and the room's policy repeats nothing.
};

struct SeatFrame {
  Origin origin = Origin::kAbsent;
  scenes::SeatInput input;
  friend bool operator==(const SeatFrame&, const SeatFrame&) = default;
};

enum class EventKind : std::uint8_t {
  kJoin = 1,
  kLeave = 2,   ///< The seat is free.
  kKick = 3,    ///< As kLeave, by an admin or by the room's policy for slow peers.
  kLost = 4,    ///< The holder's connection is gone; the seat waits for it to resume.
  kResume = 5,  ///< It has.
};

struct FrameEvent {
  EventKind kind = EventKind::kJoin;
  std::uint16_t seat = 0;
  friend bool operator==(const FrameEvent&, const FrameEvent&) = default;
};

/// A setting of the room that holds from this frame on.
enum class ChangeKind : std::uint8_t {
  kInputDelay = 1,  ///< `value` ticks of lead that clients are to keep.
};

struct FrameChange {
  ChangeKind kind = ChangeKind::kInputDelay;
  std::uint32_t value = 0;
  friend bool operator==(const FrameChange&, const FrameChange&) = default;
};

/// What happened in one tick, decided by the server alone. The frames with the scene are the match.
struct InputFrame {
  std::uint64_t tick = 0;  ///< The tick this frame makes; the first is 1.
  std::vector<SeatFrame> seats;
  std::vector<FrameEvent> events;
  std::vector<FrameChange> changes{};
  friend bool operator==(const InputFrame&, const InputFrame&) = default;
};

enum class Mode : std::uint8_t { kLockstep = 1, kSnapshot = 2 };

/// What the snapshots of a snapshot client hold.
enum class Profile : std::uint8_t {
  kExact = 1,      ///< The state, to the bit.
  kQuantised = 2,  ///< Poses, to the bounds of protocol/state/quantised.hpp.
};

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
  std::uint16_t protocol_minor = kProtocolMinor;
  std::string room{};               ///< "": the only one, or the one that the token names.
  std::vector<std::byte> token{};   ///< Signed admission; empty where the server asks for none.
  std::vector<std::byte> resume{};  ///< kResumeBytes of the last Welcome, or empty.
  std::string build{};              ///< Compiler and flags, for a desync report.
  Profile profile = Profile::kExact;
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

/// The snapshot of `tick` has been taken in: the server may send what differs from it.
struct Ack {
  std::uint64_t tick = 0;
};

/// A client's digests of the ticks first_tick, first_tick + 1, ... after it has diverged.
struct TickDigests {
  std::uint64_t first_tick = 0;
  std::vector<std::uint64_t> digests;  ///< At most kTickDigestsMax.
};

/// Part of the client's own state after `tick`, because the server asked for it. Parts come in
/// order of their offset; the last one ends at total_bytes.
struct StatePart {
  std::uint64_t tick = 0;
  std::uint32_t total_bytes = 0;
  std::uint32_t offset = 0;
  std::vector<std::byte> bytes;  ///< 1 to kStatePartBytesMax.
};

using ClientMessage = std::variant<Hello, Input, Digest, Ping, Bye, Ack, TickDigests, StatePart>;

// What the server says.

struct Welcome {
  std::int32_t seat = kSpectator;
  std::uint32_t seats = 0;
  /// Of the exact state that follows, or before it; or of the one that the client has said it
  /// holds, which then goes on.
  std::uint64_t tick = 0;
  std::uint32_t tick_rate_millihertz = 60000;
  std::uint32_t input_delay_ticks = 2;  ///< Lead at which a client should send its inputs.
  std::uint16_t protocol_minor = kProtocolMinor;
  std::string room{};
  std::vector<std::byte> resume{};  ///< kResumeBytes that bring the seat back, once; or empty.
  std::string build{};              ///< The server's compiler and flags.
  std::uint32_t digest_ticks = 60;  ///< Ticks between two digests.
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

/// Part of the exact state after `tick`, beside which frames of later ticks go on. Parts come in
/// order of their offset; the last one ends at total_bytes. One that begins again at 0 replaces
/// what came before.
struct SnapshotPart {
  std::uint64_t tick = 0;
  std::uint64_t digest = 0;
  std::uint32_t total_bytes = 0;
  std::uint32_t offset = 0;
  std::vector<std::byte> bytes;  ///< 1 to kSnapshotPartBytesMax of World::encode.
};

/// The state after `tick` as what differs from that of `baseline_tick`, which the client has
/// acknowledged; 0: from nothing.
struct StateDelta {
  std::uint64_t tick = 0;
  std::uint64_t baseline_tick = 0;
  std::uint64_t digest = 0;  ///< Of the exact state, or of the quantised one; see `profile`.
  Profile profile = Profile::kExact;
  std::vector<std::byte> bytes;  ///< As protocol/state/ says for the profile.
};

/// How the inputs of this client come in, so that it can steer its lead.
struct Margin {
  std::uint64_t tick = 0;  ///< The last tick closed.
  std::int32_t early_ticks =
      0;                     ///< Of the worst input since the last Margin; < 0: it came too late.
  std::uint32_t merged = 0;  ///< Inputs taken since the last Margin.
  std::uint32_t missed = 0;  ///< Ticks since then that closed without one.
};

/// Send your state after `tick`: it is the first that differs.
struct StateWanted {
  std::uint64_t tick = 0;
};

enum class NoticeKind : std::uint8_t {
  kSlowed = 1,      ///< Overload has put the match `value` ms behind its clock, in sum.
  kNotDurable = 2,  ///< The log has ended; the match goes on.
  kDraining = 3,    ///< The server goes away in `value` ms.
  kRewound = 4,     ///< The match goes on from tick `value`; its exact state follows.
  kReport = 5,      ///< A desync of this client was traced; `text` says to what.
};

/// What a client may want to show to its user. `text` is for people.
struct RoomNotice {
  NoticeKind kind = NoticeKind::kSlowed;
  std::uint64_t tick = 0;
  std::uint64_t value = 0;
  std::string text;
};

using ServerMessage = std::variant<Welcome, Refused, InputFrame, Snapshot, Digest, Pong, Bye,
                                   SnapshotPart, StateDelta, Margin, StateWanted, RoomNotice>;

}  // namespace cycloid::protocol
