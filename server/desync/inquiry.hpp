#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "protocol/messages.hpp"
#include "server/desync/finding.hpp"
#include "server/room/inquiry.hpp"

namespace cycloid::server {

/// Bounds of what desyncs may cost a room. None may be 0.
struct DesyncDeskOptions {
  std::size_t inquiries_max = 2;         ///< At a time; a peer has at most one.
  std::uint32_t findings_per_hour = 20;  ///< What is more is counted only.
  std::chrono::nanoseconds deadline{std::chrono::seconds{10}};  ///< For all that a client sends.
  /// For the other replicas' digests, and for the ticks after the one that differs.
  std::chrono::nanoseconds votes_wait{std::chrono::seconds{1}};
  /// A client's state may have twice the bytes of the server's and so many more.
  std::size_t state_slack_bytes = std::size_t{64} << 10;
};

/// Asks desynced clients of one room which tick went wrong, and for their state of that tick.
///
/// Sans I/O: what peers say, what the room still knows and the time in, messages and findings out.
/// It never waits, and nobody waits for it: the room gives the client its exact state at once.
/// Whatever a client says or does not say ends, at the latest at its deadline, in a finding; what
/// is missing in it is said.
class DesyncDesk {
 public:
  struct Counts {
    std::uint64_t opened = 0;
    std::uint64_t skipped = 0;   ///< Mismatches beyond a bound.
    std::uint64_t unasked = 0;   ///< Messages of peers that were not asked for them.
    std::uint64_t complete = 0;  ///< Findings with the client's state, ...
    std::uint64_t without = 0;   ///< ... and without.
  };

  DesyncDesk(DesyncDeskOptions options, std::shared_ptr<const RoomIdentity> room)
      : options_(options), room_(std::move(room)) {}

  /// Every digest that a lockstep client answers with, equal or not: the vote of that replica.
  void on_digest(PeerId peer, std::uint64_t tick, std::uint64_t digest);
  /// It was not ours. False where a bound forbids to look into it.
  bool on_mismatch(const ClientIdentity& client, const protocol::Digest& said, std::int64_t now_ns,
                   const RoomEvidence& evidence);
  /// What to send to the peer, if anything.
  std::optional<protocol::StateWanted> on_tick_digests(PeerId peer,
                                                       const protocol::TickDigests& digests,
                                                       const RoomEvidence& evidence);
  void on_state_part(PeerId peer, const protocol::StatePart& part, const RoomEvidence& evidence);
  /// The peer is gone, or will say no more.
  void on_leave(PeerId peer);

  /// What is found by now, to be looked into on another thread. Call it once per tick.
  std::vector<Finding> take_findings(std::int64_t now_ns, const RoomEvidence& evidence);
  /// The match ends, or goes on from an earlier tick: all that is open is found as far as it is
  /// known, with `why` as what is missing, and nothing of this branch is mixed with what comes.
  std::vector<Finding> close(const std::string& why, const RoomEvidence& evidence);

  const Counts& counts() const { return counts_; }
  std::size_t open() const { return inquiries_.size(); }
  std::size_t held_bytes() const;  ///< Of what clients have sent.

 private:
  enum class Stage : std::uint8_t { kDigests, kState, kDone };
  struct Inquiry {
    Stage stage = Stage::kDigests;
    std::int64_t opened_ns = 0;
    std::uint64_t next_tick = 0;              ///< Of the next digest; 0: any.
    std::optional<std::uint64_t> equal_tick;  ///< The last found equal.
    std::uint32_t total_bytes = 0;            ///< As the first part says.
    Finding finding;
  };

  void differs_at(const protocol::Digest& said, std::uint64_t mine, const RoomEvidence& evidence,
                  Inquiry& inquiry);
  void give_up(Inquiry& inquiry, std::string why);
  Inquiry* asked(PeerId peer, Stage stage);
  bool within_rate(std::int64_t now_ns);
  ReplicaVotes votes(std::uint64_t tick, const RoomEvidence& evidence) const;
  void recount(Inquiry& inquiry, const RoomEvidence& evidence) const;
  Finding finish(Inquiry& inquiry, const RoomEvidence& evidence);

  DesyncDeskOptions options_;
  std::shared_ptr<const RoomIdentity> room_;
  std::map<PeerId, Inquiry> inquiries_;
  std::map<std::uint64_t, std::map<PeerId, std::uint64_t>> votes_;  ///< By tick.
  std::int64_t hour_begin_ns_ = 0;
  std::uint32_t hour_findings_ = 0;
  Counts counts_;
};

}  // namespace cycloid::server
