#pragma once

#include <cstdint>
#include <string>

namespace cycloid::server {

/// Where a hosted room is between its making and its end.
enum class LifeStage : std::uint8_t {
  kRunning,
  kPaused,    ///< No tick is made and no time passes for its clients.
  kDraining,  ///< Runs on to its deadline; nobody comes in.
  kEnded,     ///< The last words are being read; then it is gone.
};

/// What may be done to it.
enum class LifeAct : std::uint8_t { kLock, kUnlock, kPause, kResume, kDrain, kEnd };

const char* life_stage_name(LifeStage stage);
const char* life_act_name(LifeAct act);

/// The rules of the acts, and nothing else: docs/server.md has them as a table.
class LifeCycle {
 public:
  /// "", or why the act means nothing now: then nothing has changed.
  [[nodiscard]] std::string apply(LifeAct act);

  LifeStage stage() const { return stage_; }
  bool locked() const { return locked_; }
  /// Whether a newcomer may come in.
  bool open() const { return !locked_ && stage_ <= LifeStage::kPaused; }
  /// Whether ticks are made.
  bool ticking() const { return stage_ == LifeStage::kRunning || stage_ == LifeStage::kDraining; }

 private:
  LifeStage stage_ = LifeStage::kRunning;
  bool locked_ = false;
};

}  // namespace cycloid::server
