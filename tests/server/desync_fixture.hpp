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
#include "server/desync/report.hpp"
#include "server/desync/room_inquiry.hpp"
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

/// A real room with its inquiry, and real replicas, joined by the bytes of the protocol. The
/// clients' inputs are those of the scene's script.
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
    RoomInquiryHooks asking;
    asking.now_ns = [this] { return now_; };
    asking.publish = [this](const Finding& finding) {
      findings_.push_back(finding);
      return report_line(investigate(finding));
    };
    inquiry_.emplace(options, std::make_shared<const RoomIdentity>(identity_), asking);
    RoomOptions room;
    room.scene_digest = identity_.scene_digest;
    RoomHooks hooks;
    hooks.now_ns = [this] { return now_; };
    hooks.inquiry = &*inquiry_;
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
    options.on_notice = [this](const protocol::RoomNotice& notice) {
      if (notice.kind == protocol::NoticeKind::kReport) notices_.push_back(notice.text);
    };
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
    exchange();
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
          if (!guest.instead || !guest.instead(message))
            room_->receive(guest.id, protocol::encode(message));
        }
        for (const Shared& bytes : room_->take_output(guest.id)) {
          any = true;
          hear(guest, *bytes);
        }
      }
    }
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
  std::optional<RoomInquiry> inquiry_;
  std::optional<Room> room_;
  std::vector<Guest> guests_;
  std::vector<Finding> findings_;
  std::vector<std::string> notices_;  ///< That clients were told of reports.
};

}  // namespace cycloid::server
