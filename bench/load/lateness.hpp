#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <thread>
#include <vector>

#include "bench/load/samples.hpp"

namespace cycloid::load {

inline constexpr double kTick_ms = 1000.0 / 60.0;

/// Lateness of a bare timer, so that the machine's own is known beside the server's.
class BareTimer {
 public:
  BareTimer() : thread_([this] { run(); }) {}
  BareTimer(const BareTimer&) = delete;
  BareTimer& operator=(const BareTimer&) = delete;
  ~BareTimer();
  /// Until then nothing is kept.
  void begin_measuring() { measures_ = true; }
  /// The worst since it was last asked, ms.
  double take_worst_ms() { return worst_ms_.exchange(0.0); }
  Samples stop();

 private:
  void run();

  std::atomic<bool> stop_{false};
  std::atomic<bool> measures_{false};
  std::atomic<double> worst_ms_{0.0};
  Samples late_ms_;
  std::thread thread_;
};

/// Some seconds in which ticks of the server began in the time of the next.
struct Stretch {
  double from_s = 0.0;  ///< Since the measurement began.
  double to_s = 0.0;
  double behind = 0.0;            ///< Ticks of all rooms.
  double control_worst_ms = 0.0;  ///< How late the bare timer was at most.

  /// Whether even a timer that does nothing missed a whole tick.
  bool control_missed() const { return control_worst_ms > kTick_ms; }
};

/// Asks the server from time to time how many of its ticks were behind: beside the bare timer of
/// the same seconds it tells when the server was late alone.
class OverrunWatch {
 public:
  /// @param control  Outlives the watch.
  OverrunWatch(std::uint16_t operation_port, BareTimer& control);
  OverrunWatch(const OverrunWatch&) = delete;
  OverrunWatch& operator=(const OverrunWatch&) = delete;
  ~OverrunWatch();
  /// Until then nothing is asked.
  void begin();
  /// The stretches with ticks behind, in their order, up to where the server did not answer.
  std::vector<Stretch> stop();

 private:
  enum class Phase : std::uint8_t { kWaits, kWatches, kEnds };
  void run();
  void watch();
  /// Waits for the end of the stretch. @returns whether the watch is over.
  bool wait_for_stretch();
  void end();

  std::uint16_t port_;
  BareTimer* control_;
  std::mutex mutex_;
  std::condition_variable changed_;
  Phase phase_ = Phase::kWaits;
  std::vector<Stretch> behind_;
  std::thread thread_;
};

}  // namespace cycloid::load
