#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <limits>
#include <span>

#include "cli/sim/chronicle.hpp"
#include "cli/sim/random.hpp"
#include "protocol/codec.hpp"
#include "server/admission/peer_address.hpp"

namespace cycloid::sim {

inline constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
inline constexpr std::int64_t kMillisecond = 1'000'000;
inline constexpr std::int64_t kSecond = 1'000'000'000;
inline constexpr std::size_t kReadBytes = 16384;  ///< That a client or session reads at once.

/// How one direction of a connection treats its bytes.
struct PipeFaults {
  std::int64_t latency_ns = kMillisecond;
  std::int64_t jitter_ns = 0;
  std::uint64_t bytes_per_s = 0;           ///< 0: as many as one likes.
  std::uint32_t segment_bytes_max = 1460;  ///< Segments have 1 to so many bytes. @pre > 0.
  bool whole_segments = true;              ///< All as long as may be; else of any length.
  bool coalesces = false;                  ///< A read gives all that has come, not one segment.
  std::uint32_t stall_per_million = 0;  ///< Of a write: the stream freezes, as for a lost packet.
  std::int64_t stall_ns = 200 * kMillisecond;
  std::uint32_t flip_per_million = 0;        ///< Of a segment: one of its bits is the other one.
  std::size_t capacity_bytes = 262144;       ///< On the way and unread; more has to wait. @pre > 0.
  std::int64_t blackhole_from_ns = kNever;   ///< What is sent from then on comes at the end of it,
  std::int64_t blackhole_until_ns = kNever;  ///< if there is one.
};

/// One direction of a byte stream in virtual time: in order, whole, and as late as the faults say.
class Pipe {
 public:
  Pipe(const PipeFaults& faults, Random random, Chronicle& chronicle)
      : faults_(faults), random_(random), chronicle_(&chronicle) {}

  /// Takes as many of the bytes as there is room for; says how many.
  std::size_t write(std::span<const std::byte> bytes);
  /// No more will be written: the reader comes to an end behind all that was.
  void finish();
  /// What is on the way is lost; reader and writer see a reset.
  void reset();

  /// What has come, at most `bytes_max` of it; empty where there is nothing yet. Valid until the
  /// next call of anything.
  std::span<const std::byte> read(std::size_t bytes_max);
  bool at_end() const { return finished_ && segments_.empty() && chronicle_->now_ns >= end_ns_; }
  bool is_reset() const { return reset_; }
  bool finished() const { return finished_; }
  /// Nothing that is written will ever come.
  bool is_lost() const {
    return chronicle_->now_ns >= faults_.blackhole_from_ns && faults_.blackhole_until_ns == kNever;
  }
  std::size_t held_bytes() const { return buffer_.size() - begin_; }
  std::uint64_t flips() const { return flips_; }

  /// No fault from now on, and what is on the way comes at once. But a blackhole that has begun and
  /// has no end stays one: nothing mends that connection but giving it up.
  void calm();

 private:
  struct Segment {
    std::int64_t at_ns = 0;
    std::size_t bytes = 0;
  };
  std::int64_t arrival_ns(std::size_t bytes);

  PipeFaults faults_;
  Random random_;
  Chronicle* chronicle_;
  protocol::Bytes buffer_;
  std::size_t begin_ = 0;
  std::deque<Segment> segments_;
  std::int64_t last_ns_ = 0;  ///< Of the segment before: nothing overtakes.
  std::int64_t free_ns_ = 0;  ///< When the line has sent what was written before.
  std::int64_t end_ns_ = 0;
  std::uint64_t flips_ = 0;
  bool swallowed_ = false;  ///< A blackhole was met, and counted.
  bool finished_ = false;
  bool reset_ = false;
};

/// A connection: what the client says and what the server says.
struct Wire {
  Wire(const PipeFaults& up_faults, const PipeFaults& down_faults, const Random& random,
       Chronicle& chronicle)
      : up(up_faults, random.fork(1), chronicle), down(down_faults, random.fork(2), chronicle) {}

  void reset() {
    up.reset();
    down.reset();
  }
  void calm() {
    up.calm();
    down.calm();
    reset_at_ns = kNever;
  }

  /// Its time may have come.
  void step(Chronicle& chronicle) {
    if (chronicle.now_ns < reset_at_ns || up.is_reset()) return;
    reset();
    chronicle.count(Event::kReset);
  }

  Pipe up;
  Pipe down;
  bool flips_up = false;
  bool flips_down = false;
  std::int64_t reset_at_ns = kNever;
  std::uint64_t number = 0;  ///< Of this connection in the run.
  std::size_t room = 0;
  std::size_t era = 0;  ///< Of the room that accepted it; see RoomHost.
  server::PeerAddress address = server::PeerAddress::v4({127, 0, 0, 1});  ///< Of the client.
  std::size_t timeline = 0;                  ///< Of the room's ledger when it said its welcome.
  std::int32_t seat = protocol::kSpectator;  ///< Of that welcome, whatever became of it on the way.
  bool unwelcome = false;  ///< Its peer says nothing that a room may take for a hello.
};

}  // namespace cycloid::sim
