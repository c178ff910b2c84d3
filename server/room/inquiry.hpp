#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "protocol/messages.hpp"
#include "server/room/exact_states.hpp"
#include "server/room/seats.hpp"

namespace cycloid::server {

/// A client's digest that is not the room's.
struct Mismatch {
  PeerId peer = kNobody;
  std::string name;
  std::string build;  ///< Of the client, as its hello says.
  std::uint64_t tick = 0;
  std::uint64_t theirs = 0;
  std::uint64_t ours = 0;
  std::int32_t seat = protocol::kSpectator;
};

/// What a room still knows of the last ticks. Valid during the call that hands it over.
class RoomEvidence {
 public:
  virtual ~RoomEvidence() = default;
  virtual std::uint64_t tick() const = 0;  ///< The last one made.
  virtual std::optional<std::uint64_t> digest_at(std::uint64_t tick) const = 0;
  virtual const protocol::InputFrame* frame_at(std::uint64_t tick) const = 0;  ///< Or null.
  /// The newest exact state of `tick` or before that is kept, or null. All frames since are kept.
  virtual std::shared_ptr<const ExactState> state_at_or_before(std::uint64_t tick) const = 0;
  /// The oldest exact state of `tick` or later that is kept, or null.
  virtual std::shared_ptr<const ExactState> state_from(std::uint64_t tick) const = 0;
};

/// What to send to the peer; or, where `error` is not "", why it is sent away with kBadMessage.
struct InquiryAnswer {
  std::vector<protocol::ServerMessage> messages;
  std::string error;
};

/// Finds out what a client that has diverged has done otherwise. The room has sent it the exact
/// state already and does not wait for any of this.
class DesyncInquiry {
 public:
  virtual ~DesyncInquiry() = default;
  virtual InquiryAnswer on_mismatch(const Mismatch& mismatch, const RoomEvidence& evidence) = 0;
  virtual InquiryAnswer on_tick_digests(PeerId peer, const protocol::TickDigests& digests,
                                        const RoomEvidence& evidence) = 0;
  virtual InquiryAnswer on_state_part(PeerId peer, const protocol::StatePart& part,
                                      const RoomEvidence& evidence) = 0;
  virtual void on_gone(PeerId peer) = 0;
  /// The match ends, or goes on from an earlier tick: what is known by now of what was asked is all
  /// that there will be. The evidence is still that of before, but for its `tick`.
  virtual void on_break(const std::string& why, const RoomEvidence& evidence) = 0;

  /// Every digest that a client answered with where it was asked to, equal or not.
  virtual void on_digest(PeerId peer, std::uint64_t tick, std::uint64_t digest) {
    (void)peer, (void)tick, (void)digest;
  }
  /// What has come up since, such as a report; asked once after every tick.
  virtual std::vector<std::pair<PeerId, protocol::ServerMessage>> take_messages(
      const RoomEvidence& evidence) {
    (void)evidence;
    return {};
  }
};

}  // namespace cycloid::server
