#include "bench/load/lateness.hpp"

#include <chrono>
#include <exception>

#include "bench/load/metrics_page.hpp"

namespace cycloid::load {

using Clock = std::chrono::steady_clock;

/// Short enough to tell one standstill of the machine from another; a page of a hundred rooms costs
/// the server some milliseconds, which is not to become its load.
static constexpr std::chrono::seconds kStretch{5};

static double since_ms(Clock::time_point from) {
  return std::chrono::duration<double, std::milli>(Clock::now() - from).count();
}

BareTimer::~BareTimer() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

Samples BareTimer::stop() {
  stop_ = true;
  thread_.join();
  return std::move(late_ms_);
}

void BareTimer::run() {
  auto due = Clock::now();
  while (!stop_) {
    due += std::chrono::duration_cast<Clock::duration>(
        std::chrono::duration<double, std::milli>(kTick_ms));
    std::this_thread::sleep_until(due);
    const double late_ms = since_ms(due);
    if (!measures_) continue;
    late_ms_.add(late_ms);
    if (late_ms > worst_ms_) worst_ms_ = late_ms;  // Nobody else raises it.
  }
}

OverrunWatch::OverrunWatch(std::uint16_t operation_port, BareTimer& control)
    : port_(operation_port), control_(&control), thread_([this] { run(); }) {}

OverrunWatch::~OverrunWatch() {
  end();
}

void OverrunWatch::begin() {
  const std::scoped_lock lock(mutex_);
  phase_ = Phase::kWatches;
  changed_.notify_all();
}

void OverrunWatch::end() {
  {
    const std::scoped_lock lock(mutex_);
    phase_ = Phase::kEnds;
    changed_.notify_all();
  }
  if (thread_.joinable()) thread_.join();
}

std::vector<Stretch> OverrunWatch::stop() {
  end();
  return std::move(behind_);
}

bool OverrunWatch::wait_for_stretch() {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, kStretch, [this] { return phase_ == Phase::kEnds; });
}

void OverrunWatch::run() {
  {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return phase_ != Phase::kWaits; });
    if (phase_ == Phase::kEnds) return;
  }
  try {
    watch();
  } catch (const std::exception&) {
    // The server is gone. Who measures it asks for the same page at the end, and says so.
  }
}

void OverrunWatch::watch() {
  const auto began = Clock::now();
  const auto ask = [this] {
    return MetricsPage::fetch(port_).sum("cycloid_room_catch_up_ticks_total");
  };
  double before = ask();
  (void)control_->take_worst_ms();
  double from_s = 0.0;
  for (bool over = false; !over;) {
    over = wait_for_stretch();
    const double now = ask();
    const double to_s = since_ms(began) / 1e3;
    const double worst_ms = control_->take_worst_ms();
    if (now > before) behind_.push_back({from_s, to_s, now - before, worst_ms});
    before = now;
    from_s = to_s;
  }
}

}  // namespace cycloid::load
