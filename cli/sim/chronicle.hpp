#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "cli/sim/random.hpp"

namespace cycloid::sim {

/// What has to hold after every step of a run.
enum class Invariant : std::uint8_t {
  kFrames,    ///< What clients take for confirmed is what was confirmed, in order, once.
  kDigests,   ///< A client's state of a confirmed tick is the server's, and so is a replay's.
  kInputs,    ///< An input counts for the tick that it was said for, or not at all.
  kSeats,     ///< A seat has one holder.
  kQueues,    ///< What waits is bounded.
  kLog,       ///< The log on the disk is a prefix of what was confirmed, and verifies.
  kHonesty,   ///< Who keeps the rules is never told otherwise, nor believes that of the server.
  kRefusals,  ///< Who is refused has changed nothing.
  kDeadline,  ///< Who says no hello is gone in time, whatever bytes come.
  kDelay,     ///< Who sees the match late sees nothing sooner.
  kLiveness,  ///< When the faults are over, all that live come to be in sync.
  kCount
};
const char* invariant_name(Invariant invariant);

/// What a run met. Counted, so that a test sees that the faults do happen.
enum class Event : std::uint8_t {
  kConnection,
  kWelcome,
  kRefusal,
  kOneByteSegment,
  kCoalesced,
  kStall,
  kBlackhole,
  kReset,
  kHalfClose,
  kZeroWindow,
  kDuplicate,
  kStorm,
  kGarbage,
  kBitFlip,
  kLeave,
  kDesync,
  kResync,
  kServerPause,
  kProcessKill,
  kPowerCut,
  kRestart,
  kShortWrite,
  kInterrupted,
  kWriteError,
  kNoSpace,
  kSyncError,
  kDiskStall,
  kReadFlip,
  kLogVerified,
  kRotation,
  kSlowPeerDropped,
  kTokenShown,   ///< And the hello with it was good.
  kSeatResumed,  ///< By a secret of the last welcome.
  kStateKept,    ///< And the server went on from the state that the client still had.
  kQuantisedShown,
  kRewind,
  kSeenLate,  ///< By a spectator, a tick that was right.
  kCount
};
const char* event_name(Event event);

struct Violation {
  Invariant invariant = Invariant::kFrames;
  std::int64_t at_ns = 0;
  std::string text;
};

/// What all parts of a run share: the clock, the first violation, counts, and a digest of all that
/// happened.
class Chronicle {
 public:
  std::int64_t now_ns = 0;
  bool quiet = false;  ///< The faults are over.
  std::function<void(std::int64_t now_ns, const std::string& line)> narrate;  ///< May be empty.

  /// Only the first counts: what follows from it is no news.
  void violate(Invariant invariant, const std::string& text) {
    if (!violation_) violation_ = Violation{invariant, now_ns, text};
    note("violated " + std::string(invariant_name(invariant)) + ": " + text);
  }
  const std::optional<Violation>& violation() const { return violation_; }

  void count(Event event) { ++counts_[static_cast<std::size_t>(event)]; }
  std::uint64_t counted(Event event) const { return counts_[static_cast<std::size_t>(event)]; }

  void note(const std::string& line) const {
    if (narrate) narrate(now_ns, line);
  }

  void mix(std::uint64_t value) { digest_ = scramble(digest_ ^ value); }
  void mix(std::span<const std::byte> bytes) {
    for (const std::byte byte : bytes) {  // FNV-1a: these are few bytes.
      digest_ = (digest_ ^ static_cast<std::uint64_t>(byte)) * 0x100000001b3;
    }
    mix(bytes.size());
  }
  std::uint64_t digest() const { return digest_; }

 private:
  std::optional<Violation> violation_;
  std::array<std::uint64_t, static_cast<std::size_t>(Event::kCount)> counts_{};
  std::uint64_t digest_ = 0xcbf29ce484222325;
};

}  // namespace cycloid::sim
