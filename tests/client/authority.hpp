#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "client/replica/follower.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::client {

/// The server's side of a match, in memory: it makes the messages that a follower is fed with.
class Authority {
 public:
  explicit Authority(const scenes::Scene& scene)
      : scene_(scene), simulation_(std::move(scenes::Simulation::create(scene).value())) {}

  static scenes::Scene scene() { return std::move(*scenes::find("half-pipe").scene); }

  protocol::Welcome welcome(std::int32_t seat) const {
    protocol::Welcome welcome;
    welcome.seat = seat;
    welcome.seats = static_cast<std::uint32_t>(simulation_.seats());
    welcome.tick = simulation_.tick();
    return welcome;
  }

  protocol::Snapshot snapshot() const {
    protocol::Snapshot snapshot{simulation_.tick(), simulation_.digest(), {}};
    simulation_.encode(snapshot.state);
    return snapshot;
  }

  /// Makes a tick by the script and says what happened in it.
  protocol::InputFrame frame() {
    protocol::InputFrame frame;
    frame.tick = simulation_.tick() + 1;
    std::vector<scenes::SeatInput> inputs;
    for (int seat = 0; seat < simulation_.seats(); ++seat) {
      inputs.push_back(scenes::scripted_input(scene_, seat, frame.tick));
      frame.seats.push_back({protocol::Origin::kGiven, inputs.back()});
    }
    EXPECT_TRUE(simulation_.step(inputs).ok());
    return frame;
  }

  protocol::Digest digest() const { return {simulation_.tick(), simulation_.digest()}; }
  scenes::Simulation& simulation() { return simulation_; }

 private:
  const scenes::Scene& scene_;
  scenes::Simulation simulation_;
};

/// The state as the server sends it: in parts of at most `bytes_max` bytes.
inline std::vector<protocol::SnapshotPart> parts_of(const protocol::Snapshot& state,
                                                    std::size_t bytes_max = 16384) {
  std::vector<protocol::SnapshotPart> parts;
  for (std::size_t at = 0; at < state.state.size(); at += bytes_max) {
    protocol::SnapshotPart& part = parts.emplace_back();
    part.tick = state.tick;
    part.digest = state.digest;
    part.total_bytes = static_cast<std::uint32_t>(state.state.size());
    part.offset = static_cast<std::uint32_t>(at);
    const std::size_t end = std::min(at + bytes_max, state.state.size());
    part.bytes.assign(state.state.begin() + static_cast<std::ptrdiff_t>(at),
                      state.state.begin() + static_cast<std::ptrdiff_t>(end));
  }
  return parts;
}

/// Pushes one free body, as a fault in memory or in a compiler would.
inline void disturb(scenes::Simulation& simulation) {
  const auto push = [](auto& world) {
    for (const auto& body : world.bodies()) {
      if (body.mass == 0.0f) continue;
      auto impulse = decltype(body.velocity)::zero();
      impulse[0] = body.mass;
      ASSERT_TRUE(world.apply_impulse(body.id, impulse).ok());
      return;
    }
  };
  if (simulation.planar() != nullptr) push(*simulation.planar());
  if (simulation.spatial() != nullptr) push(*simulation.spatial());
}

}  // namespace cycloid::client
