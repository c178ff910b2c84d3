#include "server/room/history.hpp"

#include <algorithm>
#include <utility>

namespace cycloid::server {

const Shared& MadeTick::bytes(bool packed) const {
  Shared& bytes = said[packed ? 1 : 0];
  if (bytes != nullptr) return bytes;
  protocol::Bytes made =
      packed ? protocol::encode_packed(frame) : protocol::encode(protocol::ServerMessage(frame));
  if (says_digest) {
    const protocol::Digest after{frame.tick, digest};
    const auto behind = protocol::encode(protocol::ServerMessage(after));
    made.insert(made.end(), behind.begin(), behind.end());
  }
  bytes = std::make_shared<const protocol::Bytes>(std::move(made));
  return bytes;
}

void FrameRing::push(MadeTick made) {
  ticks_.push_back(std::move(made));
  if (ticks_.size() > frames_max_) ticks_.pop_front();
}

const MadeTick* FrameRing::find(std::uint64_t tick) const {
  if (ticks_.empty() || tick < oldest() || tick - oldest() >= ticks_.size()) return nullptr;
  return &ticks_[tick - oldest()];
}

void FrameRing::drop_after(std::uint64_t tick) {
  while (!ticks_.empty() && ticks_.back().frame.tick > tick) ticks_.pop_back();
}

void KeyframeRing::push(std::shared_ptr<const ExactState> state, std::uint64_t needed_tick) {
  bytes_ += state->bytes().size();
  states_.push_back(std::move(state));
  // The second may take the place of the first only where it, too, is not too new.
  while (bytes_ > bytes_max_ && states_.size() > 1 && states_[1]->tick() <= needed_tick) {
    bytes_ -= states_.front()->bytes().size();
    states_.pop_front();
  }
}

std::shared_ptr<const ExactState> KeyframeRing::at_or_before(std::uint64_t tick) const {
  const auto after =
      std::ranges::find_if(states_, [&](const auto& state) { return state->tick() > tick; });
  return after == states_.begin() ? nullptr : *std::prev(after);
}

std::shared_ptr<const ExactState> KeyframeRing::from(std::uint64_t tick) const {
  const auto found =
      std::ranges::find_if(states_, [&](const auto& state) { return state->tick() >= tick; });
  return found == states_.end() ? nullptr : *found;
}

void KeyframeRing::drop_after(std::uint64_t tick) {
  while (!states_.empty() && states_.back()->tick() > tick) {
    bytes_ -= states_.back()->bytes().size();
    states_.pop_back();
  }
}

void KeyframeRing::drop_before(std::uint64_t tick) {
  while (!states_.empty() && states_.front()->tick() < tick) {
    bytes_ -= states_.front()->bytes().size();
    states_.pop_front();
  }
}

}  // namespace cycloid::server
