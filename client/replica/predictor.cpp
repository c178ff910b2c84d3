#include "client/replica/predictor.hpp"

#include <algorithm>
#include <utility>

namespace cycloid::client {

Predictor::Predictor(scenes::Simulation& simulation, PredictorOptions options)
    : simulation_(simulation), options_(std::move(options)) {
  options_.window_ticks = std::clamp(options_.window_ticks, 1u, kWindowTicksMax);
  slots_.resize(options_.window_ticks + 1);
  last_.resize(static_cast<std::size_t>(simulation_.seats()));
  options_.one_shot.resize(last_.size());
  reset(false);
}

void Predictor::reset(bool went_back) {
  const std::uint64_t tick = simulation_.tick();
  if (went_back) said_ = {};
  // What the others said in a tick that is void says nothing of those that come in its place.
  if (went_back && tick != confirmed_) std::fill(last_.begin(), last_.end(), scenes::SeatInput{});
  heard_ = went_back ? tick : std::max(heard_, tick);
  highest_ = went_back ? tick : std::max(highest_, tick);
  confirmed_ = reached_ = tick;
  simulation_.save(slot(tick).state);
}

void Predictor::hear(std::uint64_t tick, const scenes::SeatInput& input) {
  said_[tick % said_.size()] = {tick, input};
  heard_ = std::max(heard_, tick);
  if (heard_ > confirmed_ + options_.window_ticks) ++statistics_.stalls;
}

void Predictor::predict(std::uint64_t tick, std::vector<scenes::SeatInput>& inputs) const {
  inputs = last_;
  for (std::size_t seat = 0; seat < inputs.size(); ++seat) {
    inputs[seat].buttons &= static_cast<std::uint16_t>(~options_.one_shot[seat]);
  }
  if (options_.seat < 0 || static_cast<std::size_t>(options_.seat) >= inputs.size()) return;
  const Said& mine = said_[tick % said_.size()];
  if (mine.tick == tick) inputs[static_cast<std::size_t>(options_.seat)] = mine.input;
}

solver::Error Predictor::make(std::uint64_t tick, std::span<const scenes::SeatInput> inputs) {
  if (const solver::Error error = simulation_.step(inputs); !error.ok()) {
    simulation_.restore(slot(reached_).state);  // A fault is state too.
    return error;
  }
  if (tick <= highest_) ++statistics_.resimulated;
  highest_ = std::max(highest_, tick);
  reached_ = tick;
  slot(tick).inputs.assign(inputs.begin(), inputs.end());
  simulation_.save(slot(tick).state);
  return {};
}

void Predictor::roll_back() {
  ++statistics_.rollbacks;
  statistics_.deepest_ticks = std::max(statistics_.deepest_ticks, reached_ - confirmed_);
  simulation_.restore(slot(confirmed_).state);
  reached_ = confirmed_;
}

solver::Error Predictor::confirm(std::span<const scenes::SeatInput> inputs) {
  const std::uint64_t tick = confirmed_ + 1;
  if (inputs.size() != last_.size()) return {solver::Code::kInvalid, "inputs"};
  const bool predicted = reached_ >= tick;
  const bool right =
      predicted && std::equal(inputs.begin(), inputs.end(), slot(tick).inputs.begin());
  if (predicted && !right) roll_back();
  if (!right) {
    if (const solver::Error error = make(tick, inputs); !error.ok()) return error;
  }
  confirmed_ = tick;
  heard_ = std::max(heard_, tick);
  last_.assign(inputs.begin(), inputs.end());
  return {};
}

void Predictor::settle() {
  const std::uint64_t goal = std::min(heard_, confirmed_ + options_.window_ticks);
  while (reached_ < goal) {
    predict(reached_ + 1, coming_);
    if (const solver::Error error = make(reached_ + 1, coming_); !error.ok()) {
      ++statistics_.faults;  // Of a tick that may never be: the confirmed one decides.
      return;
    }
  }
}

std::vector<std::uint16_t> one_shot_buttons(const scenes::Scene& scene) {
  std::vector<std::uint16_t> masks;
  for (const scenes::Seat& seat : scene.seats) {
    unsigned once = 0;
    unsigned held = 0;
    for (const scenes::Control& control : seat.controls) {
      if (control.source != scenes::Source::kButton) continue;
      const bool when_pressed = control.effect == scenes::Effect::kImpulse ||
                                control.effect == scenes::Effect::kSpawn ||
                                control.effect == scenes::Effect::kJump;
      (when_pressed ? once : held) |= 1u << (control.index & 15u);
    }
    masks.push_back(static_cast<std::uint16_t>(once & ~held));
  }
  return masks;
}

}  // namespace cycloid::client
