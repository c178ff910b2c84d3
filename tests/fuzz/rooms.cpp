#include <algorithm>
#include <set>

#include "scenes/catalogue.hpp"
#include "server/room/room.hpp"
#include "tests/fuzz/targets.hpp"

namespace cycloid::fuzz {
namespace {

using server::PeerId;
using server::Room;

constexpr std::size_t kPeersMax = 12;
constexpr std::size_t kQueueBytesMax = 16384;

const scenes::Scene& fuzz_scene() {
  static const scenes::Scene kScene = *scenes::find("room:bodies=9").scene;
  return kScene;
}

server::RoomOptions small_room() {
  server::RoomOptions options;
  options.scene_digest = scenes::scene_digest(fuzz_scene());
  options.limits.connections_max = kPeersMax;
  options.limits.queue_bytes_max = kQueueBytesMax;
  options.limits.digest_ticks = 4;
  options.limits.keyframe_ticks = 4;
  options.limits.handshake = std::chrono::milliseconds(400);
  options.limits.resume = std::chrono::milliseconds(200);
  options.name = "arena";
  return options;
}

/// Many connections in one room, as a script of three bytes for each act says.
class RoomPlay {
 public:
  RoomPlay() : room_(small_room(), simulation(), hooks()) {
    std::vector<std::byte> state;
    room_.encode_state(state);
    state_bytes_ = state.size();
  }

  void act(unsigned what, unsigned who, unsigned how) {
    const PeerId id = peers_.empty() ? server::kNobody : peers_[who % peers_.size()];
    switch (what % 12) {
      case 0:
        if (peers_.size() < 2 * kPeersMax) peers_.push_back(room_.connect());
        break;
      case 1:
        say(id, hello(how));
        break;
      case 2:
        say(id, protocol::Input{room_.tick() + how % 70, {{}, static_cast<std::uint16_t>(how)}});
        break;
      case 3:
        say(id, protocol::Digest{room_.tick() - how % 8, how % 2 == 0 ? room_.digest() : how});
        break;
      case 4:
        say(id, protocol::Ack{room_.tick() - how % 8});
        break;
      case 5:
        pass(how);
        break;
      case 6:
        take(id);
        break;
      case 7:
        room_.disconnect(id);
        std::erase(peers_, id);
        break;
      case 8:
        room_.receive(id, std::vector<std::byte>(how, static_cast<std::byte>(who)));
        break;
      case 9:
        say(id, protocol::TickDigests{1 + how, {1, 2, 3}});
        break;
      case 10:
        say(id, protocol::StatePart{1 + room_.tick() - how % 8, 4, 0, {4, std::byte{1}}});
        break;
      default:
        administer(who, how);
    }
    check();
  }

 private:
  static scenes::Simulation simulation() {
    return std::move(scenes::Simulation::create(fuzz_scene()).value());
  }

  server::RoomHooks hooks() {
    server::RoomHooks hooks{[this] { return now_ns_; }};
    hooks.random = [this](std::span<std::byte> bytes) {
      for (std::byte& each : bytes) each = static_cast<std::byte>(++chance_ % 251);
    };
    return hooks;
  }

  protocol::Hello hello(unsigned how) {
    protocol::Hello hello;
    hello.scene_digest = small_room().scene_digest + (how == 77 ? 1 : 0);
    hello.seat_wish = static_cast<std::int32_t>(how % 12) - 2;
    hello.mode = how % 3 == 0 ? protocol::Mode::kSnapshot : protocol::Mode::kLockstep;
    hello.profile = how % 6 == 0 ? protocol::Profile::kQuantised : protocol::Profile::kExact;
    hello.room = how == 78 ? "elsewhere" : "";
    if (how % 5 == 0 && !resumes_.empty()) hello.resume = resumes_[how % resumes_.size()];
    return hello;
  }

  void say(PeerId id, const protocol::ClientMessage& message) {
    room_.receive(id, protocol::encode(message));
  }

  /// What a room says is what a client understands.
  void take(PeerId id) {
    protocol::Framer framer(protocol::kServerMessageBytesMax);
    for (const server::Shared& bytes : room_.take_output(id)) {
      if (!framer.feed(*bytes)) fail("a room announces a size that is none");
      while (const auto payload = framer.next()) {
        const auto decoded = protocol::decode_server(*payload);
        if (!decoded.message) fail("a room says what is no message: " + decoded.error);
        const auto* welcome = std::get_if<protocol::Welcome>(&*decoded.message);
        if (welcome != nullptr && !welcome->resume.empty()) resumes_.push_back(welcome->resume);
      }
    }
    if (framer.held_bytes() != 0) fail("a room says half a message");
  }

  void administer(unsigned who, unsigned how) {
    const std::size_t seat = who % (room_.seats().size() + 1);
    const auto done = [](bool) {};  // Either answer is one; `check` looks at what it left.
    if (how % 7 == 0) done(room_.kick(seat, "why"));
    if (how % 7 == 1) room_.lock(how % 2 == 0);
    if (how % 7 == 2) done(room_.reserve(seat, who % 2 == 0 ? "ada" : "", how));
    if (how % 7 == 3) room_.pause("a pause");
    if (how % 7 == 4) room_.resume();
    if (how % 7 == 5) done(room_.rewind(room_.tick() - how % 16));
    if (how == 6) room_.drain("over");
  }

  void check() const {
    if (room_.state() == server::RoomState::kFaulted) fail("peers have faulted the world");
    if (room_.state() != server::RoomState::kRunning) return;  // A match that is over has no seats.
    std::set<PeerId> holders;
    for (std::size_t i = 0; i < room_.seats().size(); ++i) {
      const server::SeatHold& seat = room_.seats()[i];
      if (seat.state != server::SeatState::kHeld) continue;
      if (!holders.insert(seat.holder).second) fail("a connection holds two seats");
      if (std::find(peers_.begin(), peers_.end(), seat.holder) == peers_.end())
        fail("a connection that is gone holds a seat");
    }
  }

  void pass(unsigned milliseconds) {
    const std::uint64_t before = room_.tick();
    now_ns_ += static_cast<std::int64_t>(milliseconds) * 1'000'000;
    room_.advance();
    if (room_.tick() == before) return;
    // As counted by the tick that was just made: frames and answers, and the latest snapshot.
    const std::size_t snapshot_bytes_max = 2 * state_bytes_ + 4096;
    const std::size_t each = kQueueBytesMax + snapshot_bytes_max;
    if (room_.statistics().queue_bytes > each * peers_.size()) fail("more waits than may");
  }

  std::int64_t now_ns_ = 1;
  unsigned chance_ = 0;
  std::size_t state_bytes_ = 0;
  std::vector<PeerId> peers_;
  std::vector<std::vector<std::byte>> resumes_;
  Room room_;
};

}  // namespace

void run_room(Input input) {
  constexpr std::size_t kActsMax = 200;  // A tick is a whole step: longer scripts only take longer.
  RoomPlay play;
  for (std::size_t i = 0; i + 2 < input.size() && i < 3 * kActsMax; i += 3) {
    play.act(std::to_integer<unsigned>(input[i]), std::to_integer<unsigned>(input[i + 1]),
             std::to_integer<unsigned>(input[i + 2]));
  }
}

std::vector<Seed> room_seeds() {
  const auto script = [](std::initializer_list<unsigned> bytes) {
    Seed seed;
    for (const unsigned byte : bytes) seed.push_back(static_cast<std::byte>(byte));
    return seed;
  };
  return {
      script({0, 0, 0, 1, 0, 1, 6, 0, 0, 2, 0, 2, 5, 0, 40, 6, 0, 0, 3, 0, 1, 5, 0, 80, 6, 0, 0}),
      script({0, 0, 0, 1, 0, 1, 6, 0, 0, 5, 0, 90, 7, 0, 0, 0, 0, 0, 1, 0, 5, 6, 0, 0, 5, 0, 90}),
      script({0, 0, 0, 1, 0, 6, 6, 0, 0, 4, 0, 0, 5, 0, 60, 6, 0, 0, 11, 0, 5, 5, 0, 60, 6, 0, 0}),
      script({0, 0, 0, 0, 0, 0, 1, 0, 2, 1, 1, 2, 11, 0, 0, 11, 1, 2, 5, 0, 200, 8, 0, 9, 6, 1, 0}),
  };
}

}  // namespace cycloid::fuzz
