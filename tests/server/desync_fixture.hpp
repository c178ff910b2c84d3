#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/replica/evidence.hpp"
#include "client/replica/replica.hpp"
#include "server/desync/inquiry.hpp"
#include "server/desync/report.hpp"
#include "tests/server/room_fixture.hpp"

namespace cycloid::server {

/// Changes one bit of a world between two ticks, past all checks, as a fault in memory does.
inline void flip_bit(float& value, int bit) {
  value = std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) ^ (1u << bit));
}
inline void flip_bit(std::uint32_t& value, int bit) {
  value ^= 1u << bit;
}

/// Calls f with the state of the world, of whichever dimension, and puts what f made of it back.
template <class F>
void change_state(scenes::Simulation& simulation, F&& f) {
  const auto change = [&](auto& world) {
    auto state = world.state();
    f(state);
    world.restore(state);
  };
  if (simulation.planar() != nullptr) change(*simulation.planar());
  if (simulation.spatial() != nullptr) change(*simulation.spatial());
}

/// A real room and real replicas, joined by the bytes of the protocol, with the desk between them
/// that a host puts there. The clients' inputs are those of the scene's script.
class DesyncTest : public testing::Test {
 protected:
  static constexpr std::int64_t kTickNs = 16'666'667;

  struct Guest {
    PeerId id = kNobody;
    std::unique_ptr<client::Replica> replica;
    client::Outbox out;
    /// May answer in place of the replica's message; false: the message is sent as it is.
    std::function<bool(const protocol::ClientMessage&)> instead;
  };

  void open(const std::string& scene, int guests, DesyncDeskOptions options = {}) {
    auto loaded = scenes::find(scene);
    ASSERT_TRUE(loaded.scene) << scene;
    identity_.room = "arena";
    identity_.scene = std::make_shared<const scenes::Scene>(std::move(*loaded.scene));
    identity_.scene_digest = scenes::scene_digest(*identity_.scene);
    identity_.build = "server build";
    desk_.emplace(options, std::make_shared<const RoomIdentity>(identity_));
    shadow_.emplace(simulation_of(*identity_.scene));
    desk_->start(*shadow_);
    RoomOptions room;
    room.scene_digest = identity_.scene_digest;
    RoomHooks hooks;
    hooks.now_ns = [this] { return now_; };
    hooks.log = &log_;
    room_.emplace(room, simulation_of(*identity_.scene), hooks);
    for (int i = 0; i < guests; ++i) join();
  }

  void join() {
    Guest guest;
    guest.id = room_->connect();
    client::FollowerOptions options;
    options.scene_digest = identity_.scene_digest;
    const auto seats = identity_.scene->seats.size();
    options.seat_wish = guests_.size() < seats ? protocol::kAnySeat : protocol::kSpectator;
    options.name = "guest";
    options.build = "client build";
    options.witness = std::make_shared<client::Evidence>();
    options.input = [scene = identity_.scene](int seat, std::uint64_t tick) {
      return scenes::scripted_input(*scene, seat, tick);
    };
    guest.replica = std::make_unique<client::Replica>(simulation_of(*identity_.scene), options);
    guest.replica->greet(guest.out);
    guests_.push_back(std::move(guest));
    exchange();
  }

  /// Lets the room make its next tick, and everybody say and hear all there is.
  void tick() {
    now_ = room_->next_deadline_ns();
    room_->advance();
    for (; seen_ < log_.ticks.size(); ++seen_) {
      std::vector<scenes::SeatInput> inputs;
      for (const auto& seat : log_.ticks[seen_].frame.seats) inputs.push_back(seat.input);
      ASSERT_TRUE(shadow_->step(inputs).ok());
      desk_->on_tick(log_.ticks[seen_].frame, log_.ticks[seen_].digest, *shadow_);
    }
    exchange();
    for (Finding& finding : desk_->take_findings(now_, guests_.size()))
      findings_.push_back(std::move(finding));
  }
  void run_to(std::uint64_t tick_number) {
    while (room_->tick() < tick_number && !HasFatalFailure()) tick();
  }

  void exchange() {
    for (bool any = true; any;) {
      any = false;
      for (Guest& guest : guests_) {
        for (const protocol::ClientMessage& message : std::exchange(guest.out, {})) {
          any = true;
          if (!guest.instead || !guest.instead(message)) deliver(guest, message);
        }
        for (const Shared& bytes : room_->take_output(guest.id)) {
          any = true;
          hear(guest, *bytes);
        }
      }
    }
  }

  /// From a client to the server: through the codec, past the desk, to the room.
  void deliver(Guest& guest, const protocol::ClientMessage& message) {
    const protocol::Bytes bytes = protocol::encode(message);
    const auto decoded =
        protocol::decode_client(std::span(bytes).subspan(protocol::Framer::kPrefixBytes));
    ASSERT_TRUE(decoded.message) << decoded.error;
    if (const auto* digest = std::get_if<protocol::Digest>(&*decoded.message)) {
      desk_->on_digest(guest.id, digest->tick, digest->digest);
      desk_->on_mismatch({guest.id, "guest", "client build", guest.replica->progress().seat},
                         *digest, now_);
    } else if (const auto* digests = std::get_if<protocol::TickDigests>(&*decoded.message)) {
      if (const auto wanted = desk_->on_tick_digests(guest.id, *digests))
        hear(guest, protocol::encode(protocol::ServerMessage(*wanted)));
    } else if (const auto* part = std::get_if<protocol::StatePart>(&*decoded.message)) {
      desk_->on_state_part(guest.id, *part);
    }
    room_->receive(guest.id, bytes);
  }

  static void hear(Guest& guest, const protocol::Bytes& bytes) {
    protocol::Framer framer(protocol::kServerMessageBytesMax);
    ASSERT_TRUE(framer.feed(bytes));
    while (const auto payload = framer.next()) {
      const auto decoded = protocol::decode_server(*payload);
      ASSERT_TRUE(decoded.message) << decoded.error;
      guest.replica->receive(*decoded.message, guest.out);
    }
  }

  void expect_in_sync(const Guest& guest, std::uint64_t mismatches) {
    EXPECT_EQ(guest.replica->progress().phase, client::Phase::kRunning)
        << guest.replica->progress().reason;
    EXPECT_EQ(guest.replica->simulation().tick(), room_->tick());
    EXPECT_EQ(guest.replica->simulation().digest(), room_->digest());
    EXPECT_EQ(guest.replica->progress().mismatches, mismatches);
    EXPECT_EQ(guest.replica->progress().resyncs, mismatches);
  }

  std::int64_t now_ = 1'000'000'000;
  RoomIdentity identity_;
  std::optional<DesyncDesk> desk_;
  std::optional<scenes::Simulation> shadow_;  ///< The room's world once more, for the desk.
  MemoryLog log_;
  std::size_t seen_ = 0;  ///< Of the log.
  std::optional<Room> room_;
  std::vector<Guest> guests_;
  std::vector<Finding> findings_;
};

}  // namespace cycloid::server
