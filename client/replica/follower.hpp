#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/replica/assembly.hpp"
#include "client/replica/lead.hpp"
#include "client/replica/progress.hpp"
#include "protocol/messages.hpp"
#include "scenes/simulation.hpp"

namespace cycloid::client {

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
  /// All messages at hand were taken in: brings predictions up to them. Before the state is read.
  virtual void settle() {}
  /// A tick has passed on the host's clock without a frame: says and predicts one tick more. False
  /// where nothing is predicted, or the window is full.
  virtual bool advance(Outbox&) { return false; }

  const Progress& progress() const { return progress_; }
  std::uint32_t tick_rate_millihertz() const { return welcome_.tick_rate_millihertz; }
  /// Whether the server has let us in, and then how.
  bool welcomed() const { return welcomed_; }
  const protocol::Welcome& welcome() const { return welcome_; }
  /// The state to show: the predicted one where there are predictions. Of a snapshot client with
  /// the quantised profile it is the last exact one; see `poses`. Until progress().begun() it is
  /// what was handed over, and nothing to show.
  const scenes::Simulation& simulation() const { return simulation_; }
  /// For a host that disturbs its own world, such as a test of recovery.
  scenes::Simulation& simulation() { return simulation_; }
  virtual std::vector<scenes::Pose> poses() const { return simulation_.poses(); }
  /// Saves the confirmed state, for a connection to come to go on from. False, and nothing is
  /// saved, where there is none, or the server has contradicted it.
  virtual bool keep(scenes::Simulation::Saved&) const { return false; }
  /// Of the confirmed state, at progress().last_tick.
  virtual std::uint64_t digest() const { return simulation_.digest(); }

 protected:
  Follower(protocol::Mode mode, scenes::Simulation simulation, FollowerOptions options);

  virtual void on_exact(const protocol::Snapshot& state, Outbox& out) = 0;
  virtual void on_frame(const protocol::InputFrame& frame, Outbox& out) = 0;
  virtual void on_digest(const protocol::Digest& digest, Outbox& out) = 0;
  virtual void on_delta(const protocol::StateDelta& delta, Outbox& out) = 0;
  /// Exact state of `tick` and frames from there on will come: what is later is void.
  virtual void on_rewound(std::uint64_t tick) = 0;
  virtual void on_seated() {}
  /// The server goes on from the state that was handed over.
  virtual void on_kept() {}

  void fail(std::string reason);
  /// Puts the exact state in place of the world; false, and the session has failed, if it is none.
  bool load(std::uint64_t tick, std::uint64_t digest, std::span<const std::byte> state);
  /// Counts a state of `tick` that was taken in, and is running from now on.
  void loaded(std::uint64_t tick);
  /// Sends my inputs for the ticks up to `last` that were not sent yet, at most `burst` of them.
  /// Starts at the lead's first tick.
  void send_inputs(std::uint64_t last, std::uint64_t burst, Outbox& out);
  /// False, and the session has failed, where the frame does not fit the scene.
  bool check_frame(const protocol::InputFrame& frame);
  /// Counts a frame of which the tick is made, and takes its changes over.
  void take_frame(const protocol::InputFrame& frame);

  bool seated() const { return progress_.seat >= 0; }
  std::uint64_t lead() const { return lead_.lead_ticks(); }
  std::uint64_t next_input_tick() const { return next_input_tick_; }
  /// Exact state to begin with: of the welcome, or of the last rewind.
  std::uint64_t base_tick() const { return base_tick_; }
  bool loading() const { return progress_.phase == Phase::kLoading; }
  /// Of the exact state whose parts are coming in, if one is.
  std::optional<std::uint64_t> assembling_tick() const;
  /// My input for a tick that is being sent; for a prediction.
  virtual void on_said(std::uint64_t, const scenes::SeatInput&) {}

  const FollowerOptions& options() const { return options_; }
  Progress progress_;
  scenes::Simulation simulation_;

 private:
  void on_welcome(const protocol::Welcome& welcome, Outbox& out);
  void go_on_from_kept(Outbox& out);
  void on_pong(const protocol::Pong& pong);
  void on_part(const protocol::SnapshotPart& part, Outbox& out);
  void on_margin(const protocol::Margin& margin);
  void on_notice(const protocol::RoomNotice& notice);
  void on_refused(const protocol::Refused& refused);
  bool expect_state(const char* what);
  bool holds_state() const;
  bool catches_up() const { return catch_up_ping_ != 0 || progress_.last_tick < caught_up_tick_; }
  std::uint64_t sent_tick() const { return first_input_tick_ == 0 ? 0 : next_input_tick_ - 1; }

  protocol::Mode mode_;
  FollowerOptions options_;
  protocol::Welcome welcome_;
  bool welcomed_ = false;
  SnapshotAssembly assembly_;
  LeadController lead_;
  std::uint64_t pings_ = 0;
  std::uint64_t catch_up_ping_ = 0;   ///< Its pong will say which tick the match is at; 0: none.
  std::uint64_t caught_up_tick_ = 0;  ///< What I say before it would be late.
  std::uint64_t base_tick_ = 0;
  std::uint64_t first_input_tick_ = 0;  ///< 0 until an input was sent.
  std::uint64_t next_input_tick_ = 0;
};

}  // namespace cycloid::client
