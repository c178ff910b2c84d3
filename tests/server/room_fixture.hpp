#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "protocol/codec.hpp"
#include "protocol/state/exact_delta.hpp"
#include "scenes/catalogue.hpp"
#include "server/room/room.hpp"

namespace cycloid::server {

/// Two balls on a floor; each of the two seats pushes one with axis 0.
inline scenes::Scene two_seat_scene() {
  scenes::Scene scene;
  scene.name = "two-seats";
  scene.summary = "Two balls on a floor.";
  scene.gravity = {0.0f, -10.0f, 0.0f};
  scenes::SceneBody floor;
  floor.kind = solver::BodyKind::kStatic;
  floor.shapes.resize(1);
  floor.shapes[0].kind = solver::ShapeKind::kHalfSpace;
  floor.shapes[0].normal = {0.0f, 1.0f, 0.0f};
  scene.bodies.push_back(floor);
  for (const char* name : {"left", "right"}) {
    scenes::SceneBody ball;
    ball.name = name;
    ball.position = {scene.bodies.size() == 1 ? -1.0f : 1.0f, 0.6f, 0.0f};
    ball.shapes.resize(1);
    ball.shapes[0].kind = solver::ShapeKind::kBall;
    ball.shapes[0].radius = 0.5f;
    ball.shapes[0].points = {{0.0f, 0.0f, 0.0f}};
    scene.bodies.push_back(ball);
    scenes::Seat seat;
    seat.name = name;
    scenes::Control push;
    push.target = name;
    push.value = {20.0f, 0.0f, 0.0f};
    seat.controls.push_back(push);
    scene.seats.push_back(seat);
  }
  return scene;
}

inline scenes::Simulation simulation_of(const scenes::Scene& scene) {
  auto simulation = scenes::Simulation::create(scene);
  EXPECT_TRUE(simulation.ok()) << simulation.error().field;
  return std::move(simulation.value());
}

inline scenes::SeatInput push(int axis) {
  return {{static_cast<std::int16_t>(axis), 0, 0, 0}, 0};
}

/// Keeps what a room logs; each tick may cost time, and the disk may fail.
class MemoryLog final : public LogSink {
 public:
  void tick(const protocol::LogTick& tick) override {
    if (on_tick) on_tick();
    if (durable_) ticks.push_back(tick);
  }
  void close(const protocol::LogFooter& at_end) override { footer = at_end; }
  bool wants_keyframe(std::uint64_t tick) const override {
    return keyframe_ticks != 0 && tick % keyframe_ticks == 0;
  }
  void keyframe(std::uint64_t tick, std::uint64_t digest,
                std::span<const std::byte> state) override {
    keyframes.push_back({tick, digest, {state.begin(), state.end()}});
  }
  void branch(const protocol::LogTick& from, std::span<const std::byte> state) override {
    branches.push_back({from.frame.tick, from.digest, {state.begin(), state.end()}});
  }
  bool durable() const override { return durable_; }
  std::string error() const override { return "the disk is gone"; }
  void break_down() { durable_ = false; }

  std::function<void()> on_tick;
  std::uint64_t keyframe_ticks = 0;  ///< 0: wants none.
  std::vector<protocol::LogTick> ticks;
  std::vector<protocol::Snapshot> keyframes;
  std::vector<protocol::Snapshot> branches;
  std::optional<protocol::LogFooter> footer;

 private:
  bool durable_ = true;
};

/// A room with a clock of its own.
class RoomTest : public testing::Test {
 protected:
  static constexpr std::int64_t kTickNs = 16'666'667;

  void open(Limits limits = {}, std::uint64_t ticks = 0, scenes::Scene scene = two_seat_scene()) {
    RoomOptions options;
    options.limits = limits;
    options.ticks = ticks;
    options.stop_on_log_error = stop_on_log_error_;
    open_with(std::move(options), std::move(scene));
  }

  void open_with(RoomOptions options, scenes::Scene scene = two_seat_scene()) {
    scene_ = std::move(scene);
    options.scene_digest = scenes::scene_digest(scene_);
    RoomHooks hooks;
    hooks.now_ns = [this] { return now_; };
    hooks.notice = [this](const Notice& notice) { notices_.push_back(notice); };
    hooks.log = &log_;
    hooks.inquiry = inquiry_;
    if (resumable_) hooks.random = [this](std::span<std::byte> into) { fill_random(into); };
    room_.emplace(std::move(options), simulation_of(scene_), hooks);
  }

  /// Never the same twice, which is all that a test needs.
  void fill_random(std::span<std::byte> into) {
    ++secrets_;
    for (std::size_t i = 0; i < into.size(); ++i) {
      into[i] = static_cast<std::byte>(secrets_ * 31 + i);
    }
  }

  protocol::Hello hello(std::int32_t seat = protocol::kAnySeat) const {
    protocol::Hello hello;
    hello.scene_digest = scenes::scene_digest(scene_);
    hello.seat_wish = seat;
    hello.name = "tester";
    return hello;
  }

  void say(PeerId id, const protocol::ClientMessage& message) {
    room_->receive(id, protocol::encode(message));
  }

  PeerId admit(std::int32_t seat, Role role, const std::string& identity = "",
               std::int32_t bound = protocol::kAnySeat) {
    return room_->admit({hello(seat), role, bound, identity, "192.0.2.1"});
  }

  PeerId join(std::int32_t seat = protocol::kAnySeat,
              protocol::Mode mode = protocol::Mode::kLockstep) {
    const PeerId id = room_->connect();
    protocol::Hello greeting = hello(seat);
    greeting.mode = mode;
    say(id, greeting);
    return id;
  }

  /// Joins, and has heard its welcome and the exact state.
  PeerId enter(std::int32_t seat = protocol::kAnySeat,
               protocol::Mode mode = protocol::Mode::kLockstep) {
    const PeerId id = join(seat, mode);
    (void)hear(id);
    return id;
  }

  /// The resume token in the welcome that the peer hears now.
  std::vector<std::byte> secret_of(PeerId id) {
    const auto welcomes = only<protocol::Welcome>(hear(id));
    EXPECT_EQ(welcomes.size(), 1u);
    return welcomes.empty() ? std::vector<std::byte>{} : welcomes[0].resume;
  }
  /// A lost seat waits a second for who held it.
  Limits one_second_to_resume() {
    resumable_ = true;
    Limits limits;
    limits.resume = std::chrono::seconds(1);
    return limits;
  }
  PeerId come_back(const std::vector<std::byte>& secret) {
    const PeerId id = room_->connect();
    protocol::Hello greeting = hello();
    greeting.resume = secret;
    say(id, greeting);
    return id;
  }

  /// Everything the room has for a peer, decoded.
  std::vector<protocol::ServerMessage> hear(PeerId id) {
    std::vector<protocol::ServerMessage> messages;
    protocol::Framer framer(protocol::kServerMessageBytesMax);
    for (const Shared& bytes : room_->take_output(id)) {
      EXPECT_TRUE(framer.feed(*bytes));
      while (const auto payload = framer.next()) {
        auto decoded = protocol::decode_server(*payload);
        EXPECT_TRUE(decoded.message) << decoded.error;
        if (decoded.message) messages.push_back(std::move(*decoded.message));
      }
    }
    return messages;
  }

  template <class Message>
  static std::vector<Message> only(const std::vector<protocol::ServerMessage>& messages) {
    std::vector<Message> found;
    for (const protocol::ServerMessage& message : messages) {
      if (const auto* it = std::get_if<Message>(&message)) found.push_back(*it);
    }
    return found;
  }

  /// The refusal that a peer's connection ends with; the test fails if it does not.
  protocol::Refused refusal(PeerId id) {
    const auto messages = hear(id);
    if (messages.empty() || !std::holds_alternative<protocol::Refused>(messages.back())) {
      ADD_FAILURE() << "not refused";
      return {};
    }
    EXPECT_TRUE(room_->wants_close(id));
    return std::get<protocol::Refused>(messages.back());
  }

  /// The time goes on, tick by tick.
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      now_ = std::max(now_, room_->next_deadline_ns());
      room_->advance();
    }
  }

  int count(Notice::Kind kind) const {
    int found = 0;
    for (const Notice& notice : notices_) found += notice.kind == kind ? 1 : 0;
    return found;
  }

  scenes::Scene scene_;
  bool stop_on_log_error_ = false;
  std::int64_t now_ = 1'000'000'000;
  MemoryLog log_;
  std::vector<Notice> notices_;
  bool resumable_ = false;  ///< Before `open`: seats can be resumed.
  std::size_t secrets_ = 0;
  DesyncInquiry* inquiry_ = nullptr;
  std::optional<Room> room_;
};

/// A replica: a world that is stepped by what the room says. Frames that come while the parts of a
/// state do wait for it.
struct Mirror {
  explicit Mirror(const scenes::Scene& scene) : simulation(simulation_of(scene)) {}

  scenes::Simulation simulation;
  std::map<std::uint64_t, std::uint64_t> digests{};  ///< After each tick.
  std::vector<protocol::InputFrame> frames{};
  std::vector<protocol::InputFrame> waiting{};
  std::vector<std::byte> parts{};
  std::uint64_t states = 0;
  std::uint64_t deltas = 0;
  bool loading = false;

  void take(const std::vector<protocol::ServerMessage>& messages) {
    for (const protocol::ServerMessage& message : messages) {
      if (const auto* part = std::get_if<protocol::SnapshotPart>(&message)) take_part(*part);
      if (const auto* delta = std::get_if<protocol::StateDelta>(&message)) {
        ASSERT_EQ(delta->baseline_tick, 0u) << "a whole state was expected";
        ASSERT_FALSE(loading) << "a snapshot before the state that it may differ from";
        const auto state = protocol::decode_exact_delta({}, delta->bytes, std::size_t{1} << 24);
        ASSERT_TRUE(state);
        load(*state, delta->tick, delta->digest);
        ++deltas;
      }
      if (const auto* frame = std::get_if<protocol::InputFrame>(&message)) {
        if (loading) {
          waiting.push_back(*frame);
        } else {
          step(*frame);
        }
      }
    }
  }

  void take_part(const protocol::SnapshotPart& part) {
    if (part.offset == 0) {
      parts.clear();
      waiting.clear();
      loading = true;
    }
    ASSERT_TRUE(loading);
    ASSERT_EQ(part.offset, parts.size());
    parts.insert(parts.end(), part.bytes.begin(), part.bytes.end());
    if (parts.size() < part.total_bytes) return;
    loading = false;
    ++states;
    load(parts, part.tick, part.digest);
    for (const protocol::InputFrame& frame : std::exchange(waiting, {})) step(frame);
  }

  void load(const std::vector<std::byte>& state, std::uint64_t tick, std::uint64_t digest) {
    ASSERT_TRUE(simulation.decode(state).ok());
    ASSERT_EQ(simulation.digest(), digest);
    ASSERT_EQ(simulation.tick(), tick);
  }

  void step(const protocol::InputFrame& frame) {
    ASSERT_EQ(frame.tick, simulation.tick() + 1);
    std::vector<scenes::SeatInput> inputs;
    for (const protocol::SeatFrame& seat : frame.seats) inputs.push_back(seat.input);
    ASSERT_TRUE(simulation.step(inputs).ok());
    digests[frame.tick] = simulation.digest();
    frames.push_back(frame);
  }
};

}  // namespace cycloid::server
