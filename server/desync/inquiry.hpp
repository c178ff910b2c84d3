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
#include "server/desync/history.hpp"

namespace cycloid::server {

/// Bounds of what desyncs may cost a room. None may be 0.
struct DesyncDeskOptions {
  HistoryOptions history;
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
/// Sans I/O: what peers say and the time in, messages and findings out. It never waits, and nobody
/// waits for it: the room gives the client its exact state at once. Whatever a client says or does
/// not say ends, at the latest at its deadline, in a finding; what is missing in it is said.
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
      : options_(options), room_(std::move(room)), history_(options.history) {}

  /// The match begins, or goes on elsewhere: with this state.
  void start(const scenes::Simulation& simulation);
  /// After every tick. One that does not follow the last one begins the match anew.
  void on_tick(const protocol::InputFrame& frame, std::uint64_t digest,
               const scenes::Simulation& simulation);

  /// Every digest that a lockstep client answers with, equal or not: the vote of that replica.
  void on_digest(PeerId peer, std::uint64_t tick, std::uint64_t digest);
  /// It was not ours. False where a bound forbids to look into it.
  bool on_mismatch(const ClientIdentity& client, const protocol::Digest& said, std::int64_t now_ns);
  /// What to send to the peer, if anything.
  std::optional<protocol::StateWanted> on_tick_digests(PeerId peer,
                                                       const protocol::TickDigests& digests);
  void on_state_part(PeerId peer, const protocol::StatePart& part);
  /// The peer is gone, or will say no more.
  void on_leave(PeerId peer);

  /// What is found by now, to be looked into on another thread. Call it once per tick.
  /// @param replicas  Lockstep clients in the room, whose votes are waited for.
  std::vector<Finding> take_findings(std::int64_t now_ns, std::size_t replicas);

  const History& history() const { return history_; }
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

  void capture(std::uint64_t tick, Finding& finding) const;
  void differs_at(std::uint64_t tick, std::uint64_t mine, std::uint64_t theirs, Inquiry& inquiry);
  void give_up(Inquiry& inquiry, std::string why);
  Inquiry* asked(PeerId peer, Stage stage);
  bool within_rate(std::int64_t now_ns);
  ReplicaVotes votes(std::uint64_t tick) const;
  Finding finish(Inquiry& inquiry);

  DesyncDeskOptions options_;
  std::shared_ptr<const RoomIdentity> room_;
  History history_;
  std::map<PeerId, Inquiry> inquiries_;
  std::map<std::uint64_t, std::map<PeerId, std::uint64_t>> votes_;  ///< By tick.
  std::int64_t hour_begin_ns_ = 0;
  std::uint32_t hour_findings_ = 0;
  Counts counts_;
};

}  // namespace cycloid::server
