#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "cli/sim/host.hpp"
#include "cli/sim/network.hpp"
#include "cli/sim/observer.hpp"
#include "cli/sim/settings.hpp"
#include "client/replica/follower.hpp"

namespace cycloid::sim {

/// Who a client is, for the whole run.
struct Persona {
  std::size_t room = 0;
  std::string name;
  protocol::Mode mode = protocol::Mode::kLockstep;
  std::int32_t seat_wish = protocol::kAnySeat;
  protocol::Profile profile = protocol::Profile::kExact;
  server::PeerAddress address = server::PeerAddress::v4({10, 0, 0, 1});
};

/// A client that keeps the rules, on a machine and a network that do not: it connects, plays,
/// loses its connection and comes back. What client::join does over a socket.
class SimClient {
 public:
  SimClient(const Settings& settings, const scenes::Scene& scene, Persona persona, Random random,
            Host& host, Chronicle& chronicle);

  void step();
  /// Its connection ends at once, and it comes back at once, as all others do.
  void storm();
  /// It goes on without mischief; what is left open of older connections is closed.
  void calm();

  /// "" where it runs and has seen what its room has made; else what it lacks.
  std::string lacks() const;
  /// Whether the server has said goodbye to it.
  bool ended() const { return ended_; }
  const std::string& name() const { return persona_.name; }

 private:
  /// What it will do on this connection beside playing, each at its time.
  struct Mischief {
    std::int64_t zero_window_ns = kNever;
    std::int64_t zero_window_until_ns = kNever;
    std::int64_t half_close_ns = kNever;
    std::int64_t leave_ns = kNever;
    std::int64_t duplicate_ns = kNever;
    std::int64_t desync_ns = kNever;
  };

  void dial();
  void draw_mischief();
  void keep_state();
  void go_on_from_kept();
  void make_follower();
  void take_welcome(const protocol::Welcome& welcome);
  void take_refusal(const protocol::Refused& refused);
  bool is_owed_its_seat() const;
  void make_mischief();
  void disturb();
  void read();
  void take(const protocol::ServerMessage& message);
  void take_planted(protocol::ServerMessage message);
  void check_after(std::uint64_t snapshots_before);
  void compare_unconfirmed(std::uint64_t tick);
  void send();
  void look_at_the_clock();
  std::string lags(std::uint64_t made) const;
  void finish(const std::string& why);
  void leave(const std::string& why);
  void blame(const std::string& what);
  bool planted(Plant plant) const { return settings_->plant == plant; }
  bool lockstep() const { return persona_.mode == protocol::Mode::kLockstep; }
  /// By its own clock, which drifts.
  std::int64_t local_ns() const {
    return chronicle_->now_ns + chronicle_->now_ns / kMillion * drift_ppm_;
  }

  const Settings* settings_;
  const scenes::Scene* scene_;
  Persona persona_;
  Random random_;
  Host* host_;
  Chronicle* chronicle_;
  std::uint64_t scene_digest_ = 0;
  std::int64_t drift_ppm_ = 0;

  std::shared_ptr<Wire> wire_;
  std::vector<std::shared_ptr<Wire>> ghosts_;  ///< Left open, never read again.
  std::unique_ptr<client::Follower> follower_;
  std::optional<Observer> observer_;
  std::optional<protocol::Framer> framer_;
  /// What the last connection has left to go on from, if anything; and whether one bit of it is
  /// wrong.
  struct Kept {
    scenes::Simulation::Saved state;
    bool is_there = false;
    bool disturbed = false;
  };
  Kept kept_;
  client::Outbox outbox_;
  protocol::Bytes unsent_;
  Mischief mischief_;
  std::vector<scenes::SeatInput> guess_;  ///< Of the next tick, for a plant.
  /// The seat that the last welcome gave, as the server said it, and how to get it back.
  struct Ticket {
    std::vector<std::byte> secret;
    std::int32_t seat = protocol::kSpectator;
    std::size_t era = 0;
    std::int64_t lost_since_ns = 0;  ///< Not before: the connection was begun then.
    bool is_clear = false;           ///< Nothing that followed gives the server a reason to forget.
  };
  Ticket ticket_;
  bool resumes_ = false;          ///< This connection's hello.
  std::vector<std::byte> token_;  ///< Shown by this connection's hello.
  bool shows_token_ = false;
  std::int64_t dial_at_ns_ = 0;
  std::int64_t dialed_ns_ = 0;
  std::int64_t heard_local_ns_ = 0;
  std::int64_t pinged_local_ns_ = 0;
  std::int64_t farewell_until_ns_ = kNever;
  std::uint64_t mismatches_ = 0;
  /// The room's when a digest was last found to differ, until an exact state comes; 0: none did.
  std::uint64_t contradicted_tick_ = 0;
  bool ended_ = false;
};

}  // namespace cycloid::sim
