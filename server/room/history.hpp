#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>

#include "protocol/messages.hpp"
#include "server/room/exact_states.hpp"

namespace cycloid::server {

/// A tick that was made: what happened in it, what came of it, and the bytes that say so.
struct MadeTick {
  protocol::InputFrame frame;
  std::uint64_t digest = 0;  ///< After it.
  bool says_digest = false;  ///< To lockstep clients, behind the frame.
  mutable std::array<Shared, 2> said{};

  /// The frame, packed or not, and behind it the digest where one is due: encoded when a client is
  /// the first to hear of it, and then for all.
  const Shared& bytes(bool packed) const;
};

/// The last ticks that were made, without a gap; the oldest go when there are too many.
class FrameRing {
 public:
  explicit FrameRing(std::size_t frames_max) : frames_max_(frames_max) {}
  /// @pre its tick follows the newest.
  void push(MadeTick made);
  const MadeTick* find(std::uint64_t tick) const;  ///< Null where it is not kept.
  void drop_after(std::uint64_t tick);
  std::uint64_t oldest() const { return ticks_.empty() ? 0 : ticks_.front().frame.tick; }
  std::size_t size() const { return ticks_.size(); }

 private:
  std::size_t frames_max_;
  std::deque<MadeTick> ticks_;
};

/// Exact states of some ticks, within a budget of bytes: the oldest go first.
class KeyframeRing {
 public:
  explicit KeyframeRing(std::size_t bytes_max) : bytes_max_(bytes_max) {}

  /// The newest one of `needed_tick` or before stays, whatever the budget says, and the newest.
  /// @pre its tick is beyond the newest.
  void push(std::shared_ptr<const ExactState> state, std::uint64_t needed_tick);
  /// The newest of `tick` or before, or null.
  std::shared_ptr<const ExactState> at_or_before(std::uint64_t tick) const;
  /// The oldest of `tick` or later, or null.
  std::shared_ptr<const ExactState> from(std::uint64_t tick) const;
  void drop_after(std::uint64_t tick);
  void drop_before(std::uint64_t tick);
  std::size_t bytes() const { return bytes_; }
  std::size_t size() const { return states_.size(); }

 private:
  std::size_t bytes_max_;
  std::size_t bytes_ = 0;
  std::deque<std::shared_ptr<const ExactState>> states_;
};

}  // namespace cycloid::server
