#pragma once

#include <memory>
#include <optional>
#include <utility>

#include "server/room/history.hpp"
#include "server/room/inquiry.hpp"

namespace cycloid::server {

/// What a room would still know of a world that a test steps: all frames, and the states of every
/// so many ticks.
class KeptEvidence final : public RoomEvidence {
 public:
  KeptEvidence(std::uint64_t state_ticks, const scenes::Simulation& start)
      : state_ticks_(state_ticks) {
    keep(start);
  }

  /// The tick that the frame has made.
  void add(protocol::InputFrame frame, const scenes::Simulation& simulation) {
    const std::uint64_t tick = tick_ = frame.tick;
    frames_.push({std::move(frame), simulation.digest(), false});
    if (tick % state_ticks_ == 0) keep(simulation);
  }
  /// As the room does once it has been rewound.
  void drop_after(std::uint64_t tick) {
    tick_ = tick;
    frames_.drop_after(tick);
    states_.drop_after(tick);
  }

  std::uint64_t tick() const override { return tick_; }
  std::optional<std::uint64_t> digest_at(std::uint64_t tick) const override {
    const MadeTick* made = frames_.find(tick);
    return made == nullptr ? std::nullopt : std::optional(made->digest);
  }
  const protocol::InputFrame* frame_at(std::uint64_t tick) const override {
    const MadeTick* made = frames_.find(tick);
    return made == nullptr ? nullptr : &made->frame;
  }
  std::shared_ptr<const ExactState> state_at_or_before(std::uint64_t tick) const override {
    return states_.at_or_before(tick);
  }
  std::shared_ptr<const ExactState> state_from(std::uint64_t tick) const override {
    return states_.from(tick);
  }

 private:
  void keep(const scenes::Simulation& simulation) {
    protocol::Bytes bytes;
    simulation.encode(bytes);
    states_.push(std::make_shared<const ExactState>(simulation.tick(), simulation.digest(), bytes),
                 0);
  }

  std::uint64_t state_ticks_;
  std::uint64_t tick_ = 0;
  FrameRing frames_{100'000};
  KeyframeRing states_{std::size_t{1} << 30};
};

}  // namespace cycloid::server
