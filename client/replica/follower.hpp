#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "protocol/messages.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::client {

/// What a seat says for a tick.
using InputSource = std::function<scenes::SeatInput(int seat, std::uint64_t tick)>;

/// Messages to send, in order. Whoever owns the connection empties it.
using Outbox = std::vector<protocol::ClientMessage>;

enum class Phase : std::uint8_t {
  kGreeting,  ///< The hello is out, no welcome yet.
  kLoading,   ///< Welcome; its snapshot has not come yet.
  kRunning,
  kEnded,    ///< The server said goodbye.
  kRefused,  ///< The server sent us away.
  kFailed,   ///< The server broke the rules, or the world cannot step.
};

/// How far a follower has come. Counts since the hello.
struct Progress {
  Phase phase = Phase::kGreeting;
  std::string reason;  ///< Why it is over; "" while it is not.
  std::optional<protocol::Refused> refused;
  std::int32_t seat = protocol::kSpectator;
  std::uint64_t first_tick = 0;  ///< Of the first snapshot.
  std::uint64_t last_tick = 0;   ///< Of the state that is held now.
  std::uint64_t frames = 0;
  std::uint64_t snapshots = 0;
  std::uint64_t digests_compared = 0;
  std::uint64_t mismatches = 0;  ///< Digests that were compared and differed.
  std::uint64_t resyncs = 0;     ///< Snapshots that ended a mismatch.
  std::uint64_t inputs_sent = 0;
  std::uint64_t inputs_replaced = 0;  ///< Frames in which my input was not the one I gave.

  bool over() const { return phase >= Phase::kEnded; }
};

struct FollowerOptions {
  std::uint64_t scene_digest = 0;
  std::int32_t seat_wish = protocol::kAnySeat;
  std::string name;
  InputSource input;  ///< Asked once for every tick, in order, when the client has a seat.
};

/// The client's side of the protocol without I/O or clock: messages in, messages out. What the two
/// modes have in common; they differ in how they come to the next state.
///
/// Whatever the server says is either in order or ends the session with a reason: nothing it sends
/// makes a follower crash, hang or grow.
class Follower {
 public:
  virtual ~Follower() = default;
  Follower(const Follower&) = delete;
  Follower& operator=(const Follower&) = delete;

  /// The first message of the session.
  void greet(Outbox& out);
  /// Takes a message in; appends the answers to `out`. Ignored once the session is over.
  void receive(const protocol::ServerMessage& message, Outbox& out);
  /// Asks for a pong, which shows both sides that the other lives.
  void ping(Outbox& out);

  const Progress& progress() const { return progress_; }
  std::uint32_t tick_rate_millihertz() const { return welcome_.tick_rate_millihertz; }
  const scenes::Simulation& simulation() const { return simulation_; }
  /// For a host that disturbs its own world, such as a test of recovery.
  scenes::Simulation& simulation() { return simulation_; }

 protected:
  Follower(protocol::Mode mode, scenes::Simulation simulation, FollowerOptions options);

  virtual void on_snapshot(const protocol::Snapshot& snapshot, Outbox& out) = 0;
  virtual void on_frame(const protocol::InputFrame& frame, Outbox& out) = 0;
  virtual void on_digest(const protocol::Digest& digest, Outbox& out) = 0;
  virtual void on_state_wanted(const protocol::StateWanted&) {}

  void fail(std::string reason);
  /// Puts the snapshot in place of the state; false, and the session has failed, if it is not one.
  bool load(const protocol::Snapshot& snapshot);
  /// Sends my inputs for the ticks up to `last` that were not sent yet. Starts at the tick that
  /// `input_delay_ticks` after the state can still reach.
  void send_inputs(std::uint64_t last, Outbox& out);
  /// False, and the session has failed, where the frame does not fit the scene.
  bool check_frame(const protocol::InputFrame& frame);
  void count_frame(const protocol::InputFrame& frame);

  std::uint64_t input_delay() const { return welcome_.input_delay_ticks; }
  Progress progress_;
  scenes::Simulation simulation_;

 private:
  void on_welcome(const protocol::Welcome& welcome);
  void on_pong(const protocol::Pong& pong);
  bool seated() const { return progress_.seat >= 0; }

  protocol::Mode mode_;
  FollowerOptions options_;
  protocol::Welcome welcome_;
  std::uint64_t pings_ = 0;
  std::uint64_t first_input_tick_ = 0;  ///< 0 until an input was sent.
  std::uint64_t next_input_tick_ = 0;
};

}  // namespace cycloid::client
