#include "server/host/life_cycle.hpp"

#include <utility>

namespace cycloid::server {

const char* life_stage_name(LifeStage stage) {
  switch (stage) {
    case LifeStage::kRunning:
      return "running";
    case LifeStage::kPaused:
      return "paused";
    case LifeStage::kDraining:
      return "draining";
    case LifeStage::kEnded:
      return "ended";
  }
  return "unknown";
}

const char* life_act_name(LifeAct act) {
  switch (act) {
    case LifeAct::kLock:
      return "lock";
    case LifeAct::kUnlock:
      return "unlock";
    case LifeAct::kPause:
      return "pause";
    case LifeAct::kResume:
      return "resume";
    case LifeAct::kDrain:
      return "drain";
    case LifeAct::kEnd:
      return "end";
  }
  return "unknown";
}

std::string LifeCycle::apply(LifeAct act) {
  const auto refused = [&](const std::string& is) {
    return "the room is " + is + ": " + life_act_name(act) + " means nothing now";
  };
  if (stage_ == LifeStage::kEnded) return refused("ended");
  switch (act) {
    case LifeAct::kLock:
      return std::exchange(locked_, true) ? refused("locked already") : "";
    case LifeAct::kUnlock:
      return std::exchange(locked_, false) ? "" : refused("not locked");
    case LifeAct::kPause:
      if (stage_ != LifeStage::kRunning) return refused(life_stage_name(stage_));
      stage_ = LifeStage::kPaused;
      return "";
    case LifeAct::kResume:
      if (stage_ != LifeStage::kPaused) return refused(life_stage_name(stage_));
      stage_ = LifeStage::kRunning;
      return "";
    case LifeAct::kDrain:  // A paused room runs again, or it would never come to its deadline.
      if (stage_ == LifeStage::kDraining) return refused("draining");
      stage_ = LifeStage::kDraining;
      return "";
    case LifeAct::kEnd:
      stage_ = LifeStage::kEnded;
      return "";
  }
  return refused("unknown");
}

}  // namespace cycloid::server
