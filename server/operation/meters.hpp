#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>

#include "protocol/messages.hpp"

namespace cycloid::server {

/// A number that one thread writes and any may read; readers never make the writer wait.
class Meter {
 public:
  void set(std::uint64_t value) { value_.store(value, std::memory_order_relaxed); }
  void add(std::uint64_t by = 1) { value_.fetch_add(by, std::memory_order_relaxed); }
  std::uint64_t get() const { return value_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> value_{0};
};

/// Durations in fixed buckets, written by any thread, read by scrapes. 16 numbers.
class DurationMeter {
 public:
  /// Upper bounds in ns, from far below a tick to far above; what is longer counts in the total.
  static constexpr std::array<std::uint64_t, 14> kBounds = {
      50'000,     100'000,    250'000,    500'000,    1'000'000,   2'500'000,   5'000'000,
      10'000'000, 16'666'667, 25'000'000, 50'000'000, 100'000'000, 250'000'000, 1'000'000'000};

  void add(std::uint64_t duration_ns, std::uint64_t times = 1) {
    sum_ns_.add(duration_ns * times);
    count_.add(times);
    for (std::size_t i = 0; i < kBounds.size(); ++i) {
      if (duration_ns <= kBounds[i]) return buckets_[i].add(times);
    }
  }
  /// Of bucket i alone, not of those below it too.
  std::uint64_t in_bucket(std::size_t i) const { return buckets_[i].get(); }
  std::uint64_t count() const { return count_.get(); }
  std::uint64_t sum_ns() const { return sum_ns_.get(); }

 private:
  std::array<Meter, kBounds.size()> buckets_;
  Meter count_;
  Meter sum_ns_;
};

/// By protocol::Refusal.
using RefusalMeters = std::array<Meter, static_cast<std::size_t>(protocol::kLastRefusal) + 1>;

/// What a room shows of itself: written on the room's strand, read by everybody. 1 KiB.
struct RoomMeters {
  Meter tick;
  Meter digest;
  Meter clients;  ///< Connections now.
  Meter joined;   ///< Welcomed since the room was made.
  RefusalMeters refusals;
  Meter desyncs;
  Meter inquiries_skipped;  ///< Desyncs beyond a bound, into which nobody looks.
  Meter inputs_late;
  Meter inputs_early;
  Meter inputs_replaced;  ///< Repeated or neutral where somebody sits.
  Meter bytes_in;
  Meter bytes_out;
  Meter queue_bytes;
  Meter catch_up_ticks;  ///< Made in one go behind the first.
  Meter slowed_ns;
  Meter encodes;  ///< States that were encoded, for clients or to be kept.
  Meter durable;  ///< 1, or 0 once the log has ended early.
  DurationMeter lateness;
  DurationMeter tick_time;
  std::atomic<std::int64_t> armed_ns{0};  ///< When the next tick is due; 0: none is.
  std::atomic<std::int64_t> tick_ns{0};   ///< How long a tick lasts.
};

/// What the process shows of itself beside its rooms.
struct HostMeters {
  Meter connections;  ///< Open now, of all kinds.
  Meter pending;      ///< Of these, those that no room has yet.
  Meter accepted;
  Meter accept_failures;
  RefusalMeters refusals;  ///< At the gate.
  Meter gate_bytes;        ///< Heard before an admission or a refusal.
  Meter rooms_made;
  Meter rooms_ended;
  Meter reports_dropped;  ///< Of desyncs, over a bound or refused by the disk.
  DurationMeter log_sync;
};

}  // namespace cycloid::server
