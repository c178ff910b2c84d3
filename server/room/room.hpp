#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "protocol/lockstep.hpp"
#include "protocol/messages.hpp"
#include "scenes/simulation.hpp"
#include "server/room/histogram.hpp"
#include "server/room/log_sink.hpp"
#include "server/room/options.hpp"
#include "server/room/outbox.hpp"
#include "server/room/seat.hpp"

namespace cycloid::server {

/// What is worth one line in the server's log.
struct Notice {
  enum class Kind : std::uint8_t {
    kJoin,
    kLeave,
    kRefusal,
    kDesync,
    kOverload,
    kFault,
    kLog,
    kEnd
  };
  Kind kind = Kind::kJoin;
  std::string text;
};

struct RoomOptions {
  Limits limits;
  std::uint64_t scene_digest = 0;
  std::uint32_t tick_rate_millihertz = 60000;  ///< @pre > 0.
  std::uint64_t ticks = 0;                     ///< End after so many; 0: never.
  bool stop_on_log_error = false;
};

/// What a room sees of the world outside.
struct RoomHooks {
  std::function<std::int64_t()> now_ns;       ///< Never goes back.
  std::function<void(const Notice&)> notice;  ///< May be empty.
  LogSink* log = nullptr;                     ///< May be none.
};

enum class RoomState : std::uint8_t { kRunning, kDrained, kTicksDone, kFaulted, kLogFailed };

struct RoomStatistics {
  std::uint64_t bytes_in = 0;
  std::uint64_t bytes_out = 0;
  std::uint64_t clients = 0;
  std::uint64_t refusals = 0;
  std::uint64_t desyncs = 0;
  std::uint64_t inputs_late = 0;
  std::uint64_t inputs_early = 0;
  std::uint64_t slowed_ns = 0;
  std::uint64_t worst_tick_ns = 0;
  Histogram lateness_ns;
};

/// The authority of one match, without sockets: bytes of peers and the time in, bytes for peers
/// and log records out.
///
/// Every tick closes its input frame, steps the world by it, hands frame and digest to the log and
/// only then lets the clients hear of it. A peer that is slow, silent, wrong or gone changes
/// nothing for the others. docs/protocol.md has the rules; not thread-safe.
class Room {
 public:
  Room(RoomOptions options, scenes::Simulation simulation, RoomHooks hooks);

  /// A new connection. It may be refused at once, and then `wants_close`.
  PeerId connect();
  void receive(PeerId id, std::span<const std::byte> bytes);
  /// The connection is gone; the id means nothing from now on.
  void disconnect(PeerId id);

  /// False while the peer has said more than one tick may hold: read nothing until the next.
  bool wants_bytes(PeerId id) const;
  bool has_output(PeerId id) const;
  /// All that waits for the peer, in order: one write.
  std::vector<Shared> take_output(PeerId id);
  /// Close the connection once its output is written.
  bool wants_close(PeerId id) const;

  /// Makes the ticks that are due, a bounded number of them, and closes overdue peers.
  void advance();
  /// When the next tick is due.
  std::int64_t next_deadline_ns() const { return schedule_.deadline_ns(simulation_.tick() + 1); }
  /// Ends the match: all peers are told, the log is closed.
  void drain(const std::string& reason);

  RoomState state() const { return state_; }
  const std::string& end_reason() const { return end_reason_; }
  std::uint64_t tick() const { return simulation_.tick(); }
  std::uint64_t digest() const { return digest_; }
  std::size_t peers() const { return peers_.size(); }
  const RoomStatistics& statistics() const { return statistics_; }

 private:
  enum class Stage : std::uint8_t { kGreeting, kPlaying, kClosing };
  struct Peer {
    explicit Peer(std::size_t queue_bytes_max) : outbox(queue_bytes_max) {}
    Stage stage = Stage::kGreeting;
    std::int64_t connected_ns = 0;
    std::int64_t heard_ns = 0;  ///< When its last whole message came.
    protocol::Framer framer{protocol::kHelloBytesMax};
    std::uint32_t messages = 0;  ///< Since the last tick.
    Outbox outbox;
    protocol::Mode mode = protocol::Mode::kLockstep;
    std::int32_t seat = protocol::kSpectator;
    std::string name;
    std::uint64_t exact_tick = 0;  ///< Of its last exact snapshot; older digests say nothing.
    bool desync_noticed = false;
  };
  struct DigestAt {
    std::uint64_t tick = 0;
    std::uint64_t digest = 0;
  };

  // room.cpp: peers.
  void close_overdue();
  void refuse(PeerId id, Peer& peer, protocol::Refusal code, const std::string& reason);
  void end(RoomState state, const std::string& reason);
  void vacate(Peer& peer);
  void leave(PeerId id, Peer& peer, const std::string& why);
  void answer(PeerId id, Peer& peer, const protocol::ServerMessage& message);
  void notice(Notice::Kind kind, const std::string& text) const;

  // room_messages.cpp: what peers say.
  void process(PeerId id, Peer& peer);
  void take(PeerId id, Peer& peer, const protocol::ClientMessage& message);
  void on_hello(PeerId id, Peer& peer, const protocol::Hello& hello);
  bool find_seat(PeerId id, Peer& peer, std::int32_t wish);
  void on_input(PeerId id, Peer& peer, const protocol::Input& input);
  void on_digest(PeerId id, Peer& peer, const protocol::Digest& digest);

  // room_tick.cpp: what happens in a tick.
  void make_tick();
  protocol::InputFrame close_frame();
  void publish(const protocol::InputFrame& frame);
  void fault(const protocol::InputFrame& frame, const solver::Error& error);
  void check_log();
  void slow_down(std::int64_t tick_ns);
  Shared exact_snapshot();

  RoomOptions options_;
  scenes::Simulation simulation_;
  RoomHooks hooks_;
  RoomState state_ = RoomState::kRunning;
  std::string end_reason_;
  protocol::Schedule schedule_;
  std::map<PeerId, Peer> peers_;
  PeerId last_id_ = kNobody;
  std::vector<Seat> seats_;
  std::vector<protocol::FrameEvent> events_;  ///< Of the next frame.
  std::uint64_t digest_ = 0;
  std::deque<DigestAt> digests_;  ///< That clients may still answer.
  Shared snapshot_;               ///< Of `snapshot_tick_`, made when first asked for.
  std::uint64_t snapshot_tick_ = 0;
  bool log_noticed_ = false;
  bool stall_noticed_ = false;
  bool slow_steps_noticed_ = false;
  RoomStatistics statistics_;
};

/// "kTooSlow" and so on, for a line of the log.
const char* refusal_name(protocol::Refusal code);

}  // namespace cycloid::server
