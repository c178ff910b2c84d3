#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "protocol/messages.hpp"
#include "scenes/simulation.hpp"
#include "server/room/admission.hpp"
#include "server/room/delay_controller.hpp"
#include "server/room/exact_states.hpp"
#include "server/room/histogram.hpp"
#include "server/room/history.hpp"
#include "server/room/inquiry.hpp"
#include "server/room/log_sink.hpp"
#include "server/room/options.hpp"
#include "server/room/pacer.hpp"
#include "server/room/peer.hpp"
#include "server/room/resume_tokens.hpp"
#include "server/room/seats.hpp"
#include "server/room/snapshot_feed.hpp"

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
    kEnd,
    kAct  ///< Of an admin.
  };
  Kind kind = Kind::kJoin;
  std::string text;
};

/// What a room sees of the world outside.
struct RoomHooks {
  std::function<std::int64_t()> now_ns;         ///< Never goes back.
  std::function<void(const Notice&)> notice{};  ///< May be empty.
  /// How long after its deadline each tick begins, those that are caught up too. May be empty.
  std::function<void(std::uint64_t late_ns)> lateness{};
  LogSink* log = nullptr;  ///< May be none.
  /// Fills with bytes that nobody can guess. Empty: seats cannot be resumed.
  std::function<void(std::span<std::byte>)> random{};
  DesyncInquiry* inquiry = nullptr;  ///< May be none.
};

enum class RoomState : std::uint8_t { kRunning, kDrained, kTicksDone, kFaulted, kLogFailed };

struct RoomStatistics {
  std::uint64_t bytes_in = 0;
  std::uint64_t bytes_out = 0;
  std::uint64_t clients = 0;
  std::uint64_t resumes = 0;
  std::uint64_t refusals = 0;
  std::array<std::uint64_t, static_cast<std::size_t>(protocol::kLastRefusal) + 1>
      refusals_by_code{};
  std::uint64_t desyncs = 0;
  std::uint64_t overruns = 0;  ///< Queues dropped for an exact state.
  std::uint64_t rewinds = 0;
  std::uint64_t inputs_late = 0;
  std::uint64_t inputs_early = 0;
  std::uint64_t inputs_replaced = 0;  ///< Of seated players who had spoken before.
  std::uint64_t catch_up_ticks = 0;   ///< Made in one `advance` behind another.
  std::uint64_t encodes = 0;          ///< Of exact states and of snapshots, whoever got them.
  std::uint64_t queue_bytes = 0;      ///< That wait for all peers, when last served.
  std::uint64_t slowed_ns = 0;
  std::uint64_t waited_ns = 0;  ///< For missing inputs.
  std::uint64_t worst_tick_ns = 0;
  std::uint64_t last_tick_ns = 0;
  std::uint64_t last_lateness_ns = 0;
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
  Room(const Room&) = delete;
  Room& operator=(const Room&) = delete;

  /// A new connection, whose first message is to be its hello. It may be refused at once, and then
  /// `wants_close`.
  PeerId connect();
  /// A new connection that has said its hello to a gate, which has vouched for the rest.
  PeerId admit(const Admission& admission);
  void receive(PeerId id, std::span<const std::byte> bytes);
  /// The connection is gone; the id means nothing from now on.
  void disconnect(PeerId id);

  /// False while the peer has said more than one tick may hold: read nothing until the next, or
  /// until `advance` has served the peers without one.
  bool wants_bytes(PeerId id) const;
  bool has_output(PeerId id) const;
  /// All that waits for the peer and may leave in this tick, in order: one write. To be called when
  /// the connection can take it, for exact states are made only then.
  std::vector<Shared> take_output(PeerId id);
  /// Whether the peer's next frame or snapshot waits for an exact state to be begun and taken.
  bool owes_state(PeerId id) const;
  /// Close the connection once its output is written.
  bool wants_close(PeerId id) const;

  /// Makes the ticks that are due, a bounded number of them, and closes overdue peers. Serves them
  /// with each tick, and without one where none was made for 100 ms.
  void advance();
  /// When to call `advance` next.
  std::int64_t next_deadline_ns() const { return pacer_.next_ns(simulation_.tick() + 1); }
  /// Ends the match: all peers are told, the log is closed.
  void drain(const std::string& reason);

  // What an admin may do. Those that return a bool change nothing where they return false.

  /// Sends the seat's holder away, or frees the seat that waits for one.
  bool kick(std::size_t seat, const std::string& reason);
  bool kick_peer(PeerId id, const std::string& reason);
  /// Newcomers are refused but admins and those who resume.
  void lock(bool locked);
  /// Keeps a seat for an identity, or, where that is "", for a token bound to the seat, until so
  /// many more ticks are made.
  bool reserve(std::size_t seat, const std::string& identity, std::uint64_t ticks);
  void pause(const std::string& reason);
  void resume();
  /// The match goes on from after an earlier tick that is still kept; all clients are given its
  /// state, and the log branches.
  bool rewind(std::uint64_t tick);
  /// Tells all clients that the server goes away.
  void announce_drain(std::chrono::milliseconds within, const std::string& reason);
  /// Of what comes from now on; queues that are there keep their bounds.
  void set_limits(const Limits& limits);
  void encode_state(std::vector<std::byte>& into);  ///< The exact one, after `tick()`.

  RoomState state() const { return state_; }
  const std::string& end_reason() const { return end_reason_; }
  std::uint64_t tick() const { return simulation_.tick(); }
  std::uint64_t digest() const { return digest_; }
  std::size_t peers() const { return peers_.size(); }
  /// Whether `connect` would take one more, as far as their number goes.
  bool takes_connections() const;
  const SeatTable& seats() const { return seats_; }
  bool locked() const { return locked_; }
  bool paused() const { return pacer_.paused(); }
  std::uint32_t input_delay_ticks() const { return delay_.ticks(); }
  const RoomStatistics& statistics() const { return statistics_; }

 private:
  class Evidence;

  // room.cpp: connections, and how they end.
  std::size_t connections() const;
  void close_overdue();
  /// `seat_event`: what becomes of its seat.
  void refuse(PeerId id, Peer& peer, protocol::Refusal code, const std::string& reason,
              protocol::EventKind seat_event = protocol::EventKind::kLeave);
  void end(RoomState state, const std::string& reason);
  void give_up_seat(Peer& peer, protocol::EventKind event);
  void leave(PeerId id, Peer& peer, const std::string& why, protocol::EventKind seat_event);
  void answer(PeerId id, Peer& peer, const protocol::ServerMessage& message);
  /// For the lines of the log: what its token says of who it is, or "".
  static std::string identity_text(const Peer& peer);
  void notice(Notice::Kind kind, const std::string& text) const;

  // room_hello.cpp: from hello to a seat.
  void greet(PeerId id, Peer& peer, const Admission& admission);
  bool refuse_other_build(PeerId id, Peer& peer, const protocol::Hello& hello);
  bool take_seat(PeerId id, Peer& peer, const Admission& admission);
  bool resume_seat(PeerId id, Peer& peer, const Admission& admission);
  void give_secret(Peer& peer, std::span<const std::byte> used);
  bool events_have_room(PeerId id, Peer& peer);

  // room_messages.cpp: what peers say.
  void process(PeerId id, Peer& peer);
  bool within_rates(PeerId id, Peer& peer, std::size_t bytes, const protocol::ClientMessage& said);
  void take(PeerId id, Peer& peer, const protocol::ClientMessage& message);
  void on_input(PeerId id, Peer& peer, const protocol::Input& input);
  void on_ack(PeerId id, Peer& peer, const protocol::Ack& ack);
  void on_ack_of_snapshot(Peer& peer, std::uint64_t tick);
  void prove_secret(Peer& peer);

  // room_desync.cpp
  void on_digest(PeerId id, Peer& peer, const protocol::Digest& digest);
  void on_mismatch(PeerId id, Peer& peer, const protocol::Digest& digest, std::uint64_t ours);
  void on_tick_digests(PeerId id, Peer& peer, const protocol::TickDigests& digests);
  void on_state_part(PeerId id, Peer& peer, const protocol::StatePart& part);
  void on_inquiry(PeerId id, Peer& peer, InquiryAnswer said);
  void pass_inquiry_messages();
  void break_inquiries(const std::string& why);

  // room_tick.cpp: what happens in a tick.
  void make_due_ticks();
  bool waits_for_input(std::int64_t now_ns);
  void make_tick();
  protocol::InputFrame close_frame();
  protocol::SeatFrame close_seat(SeatHold& hold, std::uint64_t tick);
  void serve_peers();
  void keep(protocol::InputFrame frame);
  void enforce_slow_policy();
  void look_on_late(Peer& peer);
  void expire_seats();
  void fault(const protocol::InputFrame& frame, const solver::Error& error);
  void check_log();
  void slow_down();

  // room_publish.cpp: what peers hear.
  std::uint64_t visible_tick(const Peer& peer) const;
  /// The kept state that one who sees the match late is to be given. None is older than what it has
  /// been sent: frames go on behind it, and none comes twice. Null until there is one.
  std::shared_ptr<const ExactState> late_state(const Peer& peer) const;
  void publish();
  void send_snapshot(Peer& peer);
  void send_frames(PeerId id, Peer& peer, std::int64_t now_ns);
  void send_margins();
  void want_state(Peer& peer);
  void overrun(PeerId id, Peer& peer);
  void begin_state(PeerId id, Peer& peer);
  std::uint64_t welcome_tick(const Peer& peer, std::uint64_t state_tick) const;
  void say_welcome(PeerId id, Peer& peer, std::uint64_t tick);
  void tell_all(protocol::NoticeKind kind, std::uint64_t value, const std::string& text);

  // room_rewind.cpp
  /// Whether the tick may be of a branch that is gone, in what a client says of it: it may not have
  /// heard of the rewind when it said so.
  bool was_taken_back(std::uint64_t tick) const {
    return tick > rewound_to_ && tick <= rewound_from_;
  }
  bool replay_to(std::uint64_t tick);
  void reconcile_seats(std::uint64_t tick);
  void rewind_peers(std::uint64_t tick);

  RoomOptions options_;
  scenes::Simulation simulation_;
  RoomHooks hooks_;
  RoomState state_ = RoomState::kRunning;
  std::string end_reason_;
  bool locked_ = false;
  std::uint64_t digest_ = 0;
  std::uint64_t highest_tick_ = 0;  ///< Ever made, rewound or not.
  /// The least tick that the match was ever taken back to, and the greatest that it was from.
  std::uint64_t rewound_to_ = std::numeric_limits<std::uint64_t>::max();
  std::uint64_t rewound_from_ = 0;

  Pacer pacer_;
  std::map<PeerId, Peer> peers_;
  PeerId last_id_ = kNobody;
  SeatTable seats_;
  ResumeTokens tokens_;
  std::vector<protocol::FrameEvent> events_;  ///< Of the next frame, and so are the changes.
  std::vector<protocol::FrameChange> changes_;
  DelayController delay_;
  TickInputs inputs_;  ///< Since the last tick.
  ExactStates states_;
  FrameRing frames_;
  KeyframeRing keyframes_;
  SnapshotFeed feed_;

  bool log_noticed_ = false;
  bool stall_noticed_ = false;
  bool slow_steps_noticed_ = false;
  std::int64_t slowed_told_ns_ = 0;
  RoomStatistics statistics_;
};

}  // namespace cycloid::server
