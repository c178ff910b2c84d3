#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/messages.hpp"
#include "scenes/scene.hpp"

namespace cycloid::client {

struct PredictorOptions {
  std::uint32_t window_ticks = 8;  ///< Most ticks beyond the confirmed one; 1 to 64, else clamped.
  std::int32_t seat = protocol::kSpectator;  ///< Mine: its inputs are known before they come back.
  /// By seat: buttons that are not repeated in a prediction. May be empty: all are.
  std::vector<std::uint16_t> one_shot;
};

struct PredictorStatistics {
  std::uint64_t rollbacks = 0;      ///< Confirmed frames that differed from what was predicted.
  std::uint64_t resimulated = 0;    ///< Ticks stepped again because of them.
  std::uint64_t deepest_ticks = 0;  ///< Most ticks that one rollback threw away.
  std::uint64_t stalls = 0;         ///< Times that an input lay beyond the window.
  std::uint64_t faults = 0;         ///< Predictions that the world could not step.
};

/// Runs a world ahead of what the server has confirmed, and mends it when a confirmed frame differs
/// from what was predicted: back to the last confirmed state, then forward again.
///
/// My own inputs act at once. What the others say is taken to be what they said last, without
/// one-shot buttons. A confirmed state depends on confirmed frames alone, to the bit. The world is
/// stepped once for each tick and saved after it: a save costs 1 to 11 us where a step costs 5 to
/// 5000, so a second world that follows the confirmed frames would double the work.
class Predictor {
 public:
  static constexpr std::uint32_t kWindowTicksMax = 64;

  /// @pre `simulation` outlives this, and nobody else steps or restores it.
  Predictor(scenes::Simulation& simulation, PredictorOptions options);

  /// The simulation holds another confirmed state now, of whatever tick. Predictions begin again
  /// from it; what my seat has said for later ticks still stands.
  /// @param went_back  The match has: what was said after that tick was in another history. Else
  ///     a state from before the confirmed tick is followed by the frames that lead back to it.
  void reset(bool went_back);
  /// Which seat is mine from now on.
  void sit(std::int32_t seat) { options_.seat = seat; }
  /// What my seat says for `tick`, which is later than any said before.
  void hear(std::uint64_t tick, const scenes::SeatInput& input);
  /// What the server has confirmed for the tick after the confirmed one.
  /// @returns why the world cannot step; then it is at the confirmed tick before.
  solver::Error confirm(std::span<const scenes::SeatInput> inputs);
  /// Predicts as far as my seat has spoken and the window allows. Call it once all frames at hand
  /// are confirmed: what is thrown away meanwhile is stepped again only here.
  void settle();

  std::uint64_t confirmed_tick() const { return confirmed_; }
  /// Of the world as it is now.
  std::uint64_t predicted_tick() const { return reached_; }
  /// Whether an input for the next tick would lie beyond the window.
  bool full() const { return heard_ >= confirmed_ + options_.window_ticks; }
  const PredictorStatistics& statistics() const { return statistics_; }

  /// Calls f with the simulation in its confirmed state, which f must not change.
  template <class F>
  auto with_confirmed(F&& f) const {
    const bool ahead = reached_ != confirmed_;
    if (ahead) simulation_.restore(slot(confirmed_).state);
    auto result = f(static_cast<const scenes::Simulation&>(simulation_));
    if (ahead) simulation_.restore(slot(reached_).state);
    return result;
  }

 private:
  struct Slot {
    std::vector<scenes::SeatInput> inputs;  ///< By which the tick was made.
    scenes::Simulation::Saved state;        ///< After it.
  };
  struct Said {
    std::uint64_t tick = 0;
    scenes::SeatInput input;
  };

  Slot& slot(std::uint64_t tick) { return slots_[tick % slots_.size()]; }
  const Slot& slot(std::uint64_t tick) const { return slots_[tick % slots_.size()]; }
  void predict(std::uint64_t tick, std::vector<scenes::SeatInput>& inputs) const;
  void roll_back();
  solver::Error make(std::uint64_t tick, std::span<const scenes::SeatInput> inputs);

  scenes::Simulation& simulation_;
  PredictorOptions options_;
  std::vector<Slot> slots_;                       ///< After tick t, at t modulo their number.
  std::vector<scenes::SeatInput> last_;           ///< Of the confirmed tick.
  std::vector<scenes::SeatInput> coming_;         ///< Room for the inputs of one prediction.
  std::array<Said, 2 * kWindowTicksMax> said_{};  ///< At tick modulo their number.
  std::uint64_t confirmed_ = 0;
  std::uint64_t reached_ = 0;
  std::uint64_t heard_ = 0;    ///< The last tick for which my seat has spoken, or `confirmed_`.
  std::uint64_t highest_ = 0;  ///< Ticks up to here were stepped before.
  PredictorStatistics statistics_;
};

/// By seat: the buttons that act only when they go down (impulse, spawn, jump) and nothing else.
std::vector<std::uint16_t> one_shot_buttons(const scenes::Scene& scene);

}  // namespace cycloid::client
