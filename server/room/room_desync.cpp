#include <algorithm>
#include <utility>

#include "protocol/text.hpp"
#include "server/room/room.hpp"

namespace cycloid::server {
namespace {

/// What a client may send of a state that it was asked for, beside the state itself.
constexpr std::uint64_t kStateBytesBeside = 65536;

}  // namespace

class Room::Evidence final : public RoomEvidence {
 public:
  explicit Evidence(const Room& room) : room_(room) {}
  std::uint64_t tick() const override { return room_.simulation_.tick(); }
  std::optional<std::uint64_t> digest_at(std::uint64_t tick) const override {
    if (const MadeTick* made = room_.frames_.find(tick)) return made->digest;
    const auto state = room_.keyframes_.at_or_before(tick);  // Such as that of tick 0.
    return state && state->tick() == tick ? std::optional(state->digest()) : std::nullopt;
  }
  const protocol::InputFrame* frame_at(std::uint64_t tick) const override {
    const MadeTick* made = room_.frames_.find(tick);
    return made == nullptr ? nullptr : &made->frame;
  }
  std::shared_ptr<const ExactState> state_at_or_before(std::uint64_t tick) const override {
    return room_.keyframes_.at_or_before(tick);
  }
  std::shared_ptr<const ExactState> state_from(std::uint64_t tick) const override {
    return room_.keyframes_.from(tick);
  }

 private:
  const Room& room_;
};

void Room::on_digest(PeerId id, Peer& peer, const protocol::Digest& digest) {
  // A rewind may have taken back ticks that the client has seen, and so may its seat's loss.
  const std::uint64_t highest = highest_tick_ - std::min(highest_tick_, peer.delay_ticks);
  if (digest.tick > highest) {
    if (peer.unseated && digest.tick <= highest_tick_) return;
    return refuse(id, peer, protocol::Refusal::kBadMessage,
                  "a digest of tick " + std::to_string(digest.tick) + ", the last made is " +
                      std::to_string(visible_tick(peer)));
  }
  const bool loads = peer.state_due || peer.outbox.state_waits();
  if (peer.mode != protocol::Mode::kLockstep || digest.tick <= peer.exact_tick || loads) return;
  const MadeTick* made = frames_.find(digest.tick);
  if (made == nullptr) return;
  if (was_taken_back(digest.tick)) return;
  // Only what all replicas are asked for is a vote: others could crowd those out.
  const bool votes = digest.tick % options_.limits.digest_ticks == 0;
  if (votes && hooks_.inquiry != nullptr) {
    hooks_.inquiry->on_digest(id, digest.tick, digest.digest);
  }
  if (made->digest != digest.digest) return on_mismatch(id, peer, digest, made->digest);
  if (peer.seat >= 0) prove_secret(peer);
}

void Room::on_mismatch(PeerId id, Peer& peer, const protocol::Digest& digest, std::uint64_t ours) {
  ++statistics_.desyncs;
  if (!std::exchange(peer.desync_noticed, true)) {
    notice(Notice::Kind::kDesync, "client " + std::to_string(id) + " desynced by tick " +
                                      std::to_string(digest.tick) + ": digest 0x" +
                                      protocol::hex16(digest.digest) + ", here 0x" +
                                      protocol::hex16(ours));
  }
  const Limits& limits = options_.limits;
  if (!peer.desyncs.take(hooks_.now_ns())) {
    return refuse(id, peer, protocol::Refusal::kResyncLimit,
                  "desynced more than " + std::to_string(limits.resyncs_max) + " times in " +
                      std::to_string(limits.resync_window.count() / 1'000'000'000) + " s");
  }
  want_state(peer);
  if (hooks_.inquiry == nullptr) return;
  const Mismatch mismatch{id, peer.name, peer.build, digest.tick, digest.digest, ours, peer.seat};
  on_inquiry(id, peer, hooks_.inquiry->on_mismatch(mismatch, Evidence(*this)));
}

void Room::on_tick_digests(PeerId id, Peer& peer, const protocol::TickDigests& digests) {
  if (hooks_.inquiry == nullptr) return;  // An answer to another server's question, or to none.
  on_inquiry(id, peer, hooks_.inquiry->on_tick_digests(id, digests, Evidence(*this)));
}

void Room::on_state_part(PeerId id, Peer& peer, const protocol::StatePart& part) {
  if (hooks_.inquiry == nullptr) return;
  on_inquiry(id, peer, hooks_.inquiry->on_state_part(id, part, Evidence(*this)));
}

void Room::on_inquiry(PeerId id, Peer& peer, InquiryAnswer said) {
  if (!said.error.empty()) return refuse(id, peer, protocol::Refusal::kBadMessage, said.error);
  for (const protocol::ServerMessage& message : said.messages) {
    if (!peer.playing()) return;
    if (std::holds_alternative<protocol::StateWanted>(message)) {
      peer.free_bytes = 2 * states_.of(simulation_, digest_)->bytes().size() + kStateBytesBeside;
    }
    answer(id, peer, message);
  }
}

void Room::break_inquiries(const std::string& why) {
  if (hooks_.inquiry != nullptr) hooks_.inquiry->on_break(why, Evidence(*this));
}

void Room::pass_inquiry_messages() {
  if (hooks_.inquiry == nullptr) return;
  for (auto& [id, message] : hooks_.inquiry->take_messages(Evidence(*this))) {
    const auto found = peers_.find(id);
    if (found == peers_.end() || !found->second.playing()) continue;
    InquiryAnswer said;
    said.messages.push_back(std::move(message));
    on_inquiry(id, found->second, std::move(said));
  }
}

}  // namespace cycloid::server
