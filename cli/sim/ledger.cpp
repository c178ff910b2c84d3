#include "cli/sim/ledger.hpp"

#include <algorithm>
#include <utility>

namespace cycloid::sim {

using protocol::EventKind;
using protocol::Origin;

namespace {

/// Whether every part of an input that stands in for one that did not come is the last one given,
/// or neutral, which a room may make of some controls.
bool stands_in(const scenes::SeatInput& said, const scenes::SeatInput& given) {
  for (std::size_t i = 0; i < said.axes.size(); ++i) {
    if (said.axes[i] != given.axes[i] && said.axes[i] != 0) return false;
  }
  return (said.buttons & ~given.buttons) == 0;
}

}  // namespace

scenes::SeatInput honest_input(std::uint64_t seed, int seat, std::uint64_t tick) {
  // Held for some ticks, as people do.
  const std::uint64_t stretch = tick / 8;
  const std::uint64_t bits =
      scramble(seed ^ scramble(stretch ^ (static_cast<std::uint64_t>(seat) << 32)));
  scenes::SeatInput input;
  for (std::size_t axis = 0; axis < input.axes.size(); ++axis) {
    const auto value = static_cast<std::int16_t>((bits >> (12 * axis)) & 0xfff);
    input.axes[axis] = static_cast<std::int16_t>(8 * value - 16384);
  }
  input.buttons = static_cast<std::uint16_t>(bits >> 62);
  return input;
}

void Ledger::add(const protocol::LogTick& tick) {
  const protocol::InputFrame& frame = tick.frame;
  if (frame.tick != ticks() + 1) {
    chronicle_->violate(Invariant::kFrames, "the room made tick " + std::to_string(frame.tick) +
                                                " behind tick " + std::to_string(ticks()));
    return;
  }
  held_.resize(frame.seats.size());
  last_given_.resize(frame.seats.size());
  // The events of a frame happen before its inputs count.
  for (const protocol::FrameEvent& event : frame.events) check_event(frame.tick, event);
  for (std::size_t seat = 0; seat < frame.seats.size(); ++seat) {
    check_seat(frame.tick, seat, frame.seats[seat]);
  }
  mix(tick);
  now().ticks.push_back(tick);
  show(tick);
}

void Ledger::branch(std::uint64_t tick, std::span<const std::byte> state) {
  if (tick >= ticks()) {
    return chronicle_->violate(
        Invariant::kFrames,
        "the room goes back to tick " + std::to_string(tick) + " of " + std::to_string(ticks()));
  }
  timelines_.push_back(timelines_.back());
  now().ticks.resize(static_cast<std::size_t>(tick));
  now().branch_tick = tick;
  held_.assign(held_.size(), false);
  last_given_.assign(last_given_.size(), {});
  for (const protocol::LogTick& made : now().ticks) {
    for (const protocol::FrameEvent& event : made.frame.events) check_event(made.frame.tick, event);
    for (std::size_t seat = 0; seat < made.frame.seats.size(); ++seat) {
      check_seat(made.frame.tick, seat, made.frame.seats[seat]);
    }
  }
  chronicle_->mix(tick);
  if (!shown_ || now().poses.empty()) return;
  now().poses.resize(static_cast<std::size_t>(tick) + 1);
  const bool is_it =
      shown_->decode(state).ok() && (tick == 0 || shown_->digest() == now().ticks.back().digest);
  if (is_it) return;
  chronicle_->violate(Invariant::kDigests,
                      "the state of tick " + std::to_string(tick) + " to go on from is another");
}

std::uint64_t Ledger::highest_tick() const {
  std::uint64_t highest = 0;
  for (const Timeline& timeline : timelines_) {
    highest = std::max<std::uint64_t>(highest, timeline.ticks.size());
  }
  return highest;
}

void Ledger::show(const protocol::LogTick& tick) {
  if (!shown_) return;
  if (now().poses.empty()) now().poses.push_back(shown_->poses());
  std::vector<scenes::SeatInput> inputs;
  for (const protocol::SeatFrame& seat : tick.frame.seats) inputs.push_back(seat.input);
  if (!shown_->step(inputs).ok() || shown_->digest() != tick.digest) {
    chronicle_->violate(Invariant::kDigests, "tick " + std::to_string(tick.frame.tick) +
                                                 " stepped beside the room has another digest");
  }
  now().poses.push_back(shown_->poses());
}

void Ledger::mix(const protocol::LogTick& tick) {
  const auto fold = [this](std::uint64_t value) { digest_ = scramble(digest_ ^ value); };
  fold(tick.digest);
  for (const protocol::SeatFrame& seat : tick.frame.seats) {
    fold(static_cast<std::uint64_t>(seat.origin));
    for (const std::int16_t axis : seat.input.axes) fold(static_cast<std::uint16_t>(axis));
    fold(seat.input.buttons);
  }
  for (const protocol::FrameEvent& event : tick.frame.events) {
    fold((static_cast<std::uint64_t>(event.kind) << 32) | event.seat);
  }
  chronicle_->mix(digest_);
}

void Ledger::check_event(std::uint64_t tick, const protocol::FrameEvent& event) {
  if (event.seat >= held_.size()) {
    return chronicle_->violate(Invariant::kSeats, "an event of seat " + std::to_string(event.seat));
  }
  const bool joins = event.kind == EventKind::kJoin;
  const bool leaves = event.kind == EventKind::kLeave || event.kind == EventKind::kKick;
  if ((joins && held_[event.seat]) || (!joins && !held_[event.seat])) {
    chronicle_->violate(Invariant::kSeats, "tick " + std::to_string(tick) + ": event " +
                                               std::to_string(static_cast<int>(event.kind)) +
                                               " of seat " + std::to_string(event.seat) +
                                               ", which is " +
                                               (held_[event.seat] ? "held" : "free"));
  }
  if (joins) last_given_[event.seat] = {};
  if (joins || leaves) held_[event.seat] = joins;
}

void Ledger::check_seat(std::uint64_t tick, std::size_t seat, const protocol::SeatFrame& said) {
  const std::string name = "tick " + std::to_string(tick) + ", seat " + std::to_string(seat);
  const bool neutral = said.input == scenes::SeatInput{};
  if ((said.origin == Origin::kAbsent || said.origin == Origin::kNeutral) && !neutral) {
    chronicle_->violate(Invariant::kInputs, name + ": an input that nobody gave");
  }
  if (said.origin == Origin::kRepeated && !stands_in(said.input, last_given_[seat])) {
    chronicle_->violate(Invariant::kInputs, name + ": repeats what was not the last given");
  }
  if (said.origin != Origin::kGiven) return;
  last_given_[seat] = said.input;
  if (!held_[seat]) {
    chronicle_->violate(Invariant::kInputs, name + ": given, but nobody holds the seat");
  }
  if (!inputs_excused_ && said.input != honest_input(seed_, static_cast<int>(seat), tick)) {
    chronicle_->violate(Invariant::kInputs, name + ": not what was said for this tick");
  }
}

std::optional<std::string> Ledger::not_a_prefix(std::span<const protocol::LogTick> ticks,
                                                std::uint64_t before, std::size_t timeline) const {
  const std::vector<protocol::LogTick>& all = timelines_[timeline].ticks;
  if (before + ticks.size() > all.size()) {
    return std::to_string(before + ticks.size()) + " ticks, of which only " +
           std::to_string(all.size()) + " were confirmed";
  }
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const protocol::LogTick& confirmed = all[static_cast<std::size_t>(before) + i];
    if (ticks[i].digest == confirmed.digest && ticks[i].frame == confirmed.frame) continue;
    return "tick " + std::to_string(before + i + 1) + " is not the one that was confirmed";
  }
  return {};
}

std::optional<std::string> Ledger::not_replayable(scenes::Simulation fresh) const {
  std::vector<scenes::SeatInput> inputs;
  for (const protocol::LogTick& tick : now().ticks) {
    inputs.clear();
    for (const protocol::SeatFrame& seat : tick.frame.seats) inputs.push_back(seat.input);
    if (!fresh.step(inputs).ok()) {
      return "tick " + std::to_string(tick.frame.tick) + " cannot be stepped again";
    }
    if (fresh.digest() != tick.digest) {
      return "tick " + std::to_string(tick.frame.tick) + " stepped again has another digest";
    }
  }
  return {};
}

}  // namespace cycloid::sim
