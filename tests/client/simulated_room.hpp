#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <random>
#include <utility>
#include <variant>
#include <vector>

#include "client/replica/replica.hpp"
#include "protocol/lockstep.hpp"
#include "scenes/catalogue.hpp"

namespace cycloid::client {

/// What a seat says in these tests: something else every few ticks, the same for all who ask.
inline scenes::SeatInput restless_input(int seat, std::uint64_t tick) {
  std::mt19937 random(static_cast<std::uint32_t>(tick / 7 * 64 + static_cast<unsigned>(seat)));
  scenes::SeatInput input;
  for (std::int16_t& axis : input.axes) axis = static_cast<std::int16_t>(random());
  input.buttons = static_cast<std::uint16_t>(random());
  return input;
}

/// One direction of a connection: in order, later by a latency that jitters.
template <class Message>
class Wire {
 public:
  void send(std::int64_t now_us, std::int64_t latency_us, const Message& message) {
    last_us_ = std::max(last_us_, now_us + latency_us);
    waiting_.push_back({last_us_, message});
  }
  bool take(std::int64_t now_us, Message& message) {
    if (waiting_.empty() || waiting_.front().first > now_us) return false;
    message = std::move(waiting_.front().second);
    waiting_.pop_front();
    return true;
  }

 private:
  std::int64_t last_us_ = 0;
  std::deque<std::pair<std::int64_t, Message>> waiting_;
};

/// A room with its clients and its network on one simulated clock: input windows, repeated inputs,
/// frames, a digest every tick and margins, as docs/protocol.md has them.
class SimulatedRoom {
 public:
  static constexpr std::int64_t kTickUs = 16667;
  static constexpr std::int64_t kStepUs = 500;
  static constexpr std::uint64_t kMarginTicks = 6;

  struct Link {
    std::int64_t rtt_us = 0;
    std::int64_t jitter_us = 0;  ///< Added to each way, 0 to so much.
  };
  struct Seat {
    std::unique_ptr<Replica> client;
    Link link;
    Wire<protocol::ClientMessage> up;
    Wire<protocol::ServerMessage> down;
    std::map<std::uint64_t, scenes::SeatInput> inputs;
    scenes::SeatInput last;
    bool heard = false;
    std::uint64_t replaced = 0;
    std::vector<std::uint64_t> replaced_ticks;
    protocol::Margin margin;
    bool margin_known = false;
    std::uint64_t told_tick = 0;
    std::optional<std::int32_t> early;  ///< Of the worst input of this tick.
    std::vector<std::int32_t> margins;  ///< One a tick: the worst input's.
  };

  SimulatedRoom(const scenes::Scene& scene, std::uint32_t seed)
      : scene_(scene), simulation_(make(scene)), random_(seed) {}

  static scenes::Simulation make(const scenes::Scene& scene) {
    return std::move(scenes::Simulation::create(scene).value());
  }

  Seat& sit(Link link, std::uint32_t delay_ticks, std::uint32_t predict_ticks = 0) {
    const auto seat = static_cast<std::int32_t>(seats_.size());
    FollowerOptions options;
    options.input = restless_input;
    options.predict_ticks = predict_ticks;
    options.one_shot = one_shot_buttons(scene_);
    Seat& added = seats_.emplace_back();
    added.link = link;
    added.client = std::make_unique<Replica>(make(scene_), std::move(options));
    protocol::Welcome welcome;
    welcome.seat = seat;
    welcome.seats = static_cast<std::uint32_t>(simulation_.seats());
    welcome.tick = simulation_.tick();
    welcome.input_delay_ticks = delay_ticks;
    tell(added, welcome);
    protocol::Snapshot snapshot{simulation_.tick(), simulation_.digest(), {}};
    simulation_.encode(snapshot.state);
    tell(added, snapshot);
    return added;
  }

  void run(std::uint64_t ticks) {
    const std::uint64_t end = simulation_.tick() + ticks;
    while (simulation_.tick() < end) {
      now_us_ += kStepUs;
      for (Seat& seat : seats_) move(seat);
      if (now_us_ >= static_cast<std::int64_t>(simulation_.tick() + 1) * kTickUs) close();
    }
  }
  /// Lets what is on its way arrive, without more ticks.
  void quiet() {
    for (int i = 0; i < 4000; ++i) {
      now_us_ += kStepUs;
      for (Seat& seat : seats_) move(seat);
    }
  }

  const std::vector<std::uint64_t>& digests() const { return digests_; }
  std::uint64_t tick() const { return simulation_.tick(); }
  std::deque<Seat>& seats() { return seats_; }

 private:
  std::int64_t latency(const Seat& seat) {
    const auto jitter = static_cast<std::uint32_t>(seat.link.jitter_us + 1);
    return seat.link.rtt_us / 2 + static_cast<std::int64_t>(random_() % jitter);
  }
  void tell(Seat& seat, const protocol::ServerMessage& message) {
    seat.down.send(now_us_, latency(seat), message);
  }

  void move(Seat& seat) {
    protocol::ServerMessage heard;
    Outbox out;
    while (seat.down.take(now_us_, heard)) seat.client->receive(heard, out);
    seat.client->settle();
    for (const auto& message : out) seat.up.send(now_us_, latency(seat), message);
    protocol::ClientMessage said;
    while (seat.up.take(now_us_, said)) {
      if (const auto* input = std::get_if<protocol::Input>(&said)) hear(seat, *input);
    }
  }

  void hear(Seat& seat, const protocol::Input& input) {
    const auto made = static_cast<std::int64_t>(simulation_.tick());
    const auto early = static_cast<std::int32_t>(static_cast<std::int64_t>(input.tick) - made - 1);
    if (protocol::timing(simulation_.tick(), input.tick) == protocol::Timing::kInTime) {
      seat.inputs[input.tick] = input.input;
      ++seat.margin.merged;
    }
    const bool first = !seat.margin_known;
    seat.margin.early_ticks = first ? early : std::min(early, seat.margin.early_ticks);
    seat.margin_known = true;
    seat.early = std::min(early, seat.early.value_or(early));
  }

  /// Every few ticks, and at once where an input was late or missing.
  void tell_margin(Seat& seat, std::uint64_t tick) {
    if (!seat.margin_known && seat.margin.missed == 0) return;
    const bool in_time = seat.margin.missed == 0 && seat.margin.early_ticks >= 0;
    if (in_time && tick - seat.told_tick < kMarginTicks) return;
    seat.margin.tick = seat.told_tick = tick;
    tell(seat, seat.margin);
    seat.margin = {};
    seat.margin_known = false;
  }

  void close() {
    protocol::InputFrame frame;
    frame.tick = simulation_.tick() + 1;
    frame.seats.resize(static_cast<std::size_t>(simulation_.seats()));
    std::vector<scenes::SeatInput> inputs(frame.seats.size());
    for (std::size_t i = 0; i < seats_.size(); ++i) {
      Seat& seat = seats_[i];
      const auto found = seat.inputs.find(frame.tick);
      const bool given = found != seat.inputs.end();
      if (given) seat.last = found->second;
      if (!given) ++seat.margin.missed;
      if (!given) seat.replaced_ticks.push_back(frame.tick);
      seat.replaced += given ? 0 : 1;
      seat.inputs.erase(seat.inputs.begin(), seat.inputs.upper_bound(frame.tick));
      frame.seats[i].origin = given ? protocol::Origin::kGiven : protocol::Origin::kRepeated;
      frame.seats[i].input = inputs[i] = seat.last;
    }
    if (!simulation_.step(inputs).ok()) std::abort();
    digests_.push_back(simulation_.digest());
    for (Seat& seat : seats_) {
      tell(seat, frame);
      tell(seat, protocol::Digest{frame.tick, digests_.back()});
      seat.margins.push_back(seat.early.value_or(std::numeric_limits<std::int32_t>::max()));
      seat.early.reset();
      tell_margin(seat, frame.tick);
    }
  }

  const scenes::Scene& scene_;
  scenes::Simulation simulation_;
  std::mt19937 random_;
  std::int64_t now_us_ = 0;
  std::deque<Seat> seats_;
  std::vector<std::uint64_t> digests_;  ///< The first is of tick 1.
};

}  // namespace cycloid::client
