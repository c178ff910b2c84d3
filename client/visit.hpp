#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "client/backoff.hpp"
#include "client/join.hpp"

namespace cycloid::client {

/// A stay in a room without blocking: what `join` does, a step at a time, for a host with a loop of
/// its own. Comes back after a broken connection where the options say so, to the same seat by the
/// resume token of the last welcome.
///
/// All callbacks of the options are called from inside of `poll`, on its thread.
class Visit {
 public:
  /// The first connection begins. Where the options have a mistake (mistake_of), or the scene
  /// cannot run, the visit is over at once.
  explicit Visit(JoinOptions options);
  /// Says goodbye where it is connected: at most the farewell deadline of the connection, or as
  /// long as the system's name service takes where a name is being looked up.
  ~Visit();
  Visit(const Visit&) = delete;
  Visit& operator=(const Visit&) = delete;

  /// Takes in and sends what is there; waits for at most so long where nothing is.
  void poll(std::chrono::milliseconds wait);
  /// Says goodbye; over within the farewell deadline of the connection, by polling on.
  void stop();
  bool over() const { return over_; }

  /// As far as it has come; of a visit that is over it changes no more.
  JoinReport report() const;
  /// What brings the seat back, once; empty where the server gave none.
  const std::vector<std::byte>& resume() const { return resume_; }
  /// Of the connection there is now, or was last. Null where the options have a mistake or the
  /// scene cannot run. No state to show until its progress has begun.
  Follower* follower();
  const Follower* follower() const;

 private:
  class Attempt;
  using Clock = std::chrono::steady_clock;

  void begin(std::chrono::milliseconds wait);
  void fail(std::string reason);
  void attempt_ended();
  bool comes_back(const Attempt& ended);
  void count(const Attempt& ended);
  void keep_welcome();
  void keep_state(const Follower& ended);

  JoinOptions options_;
  Backoff backoff_;
  std::unique_ptr<Attempt> attempt_;
  JoinReport report_;  ///< Of the attempts before this one.
  std::vector<std::byte> resume_;
  std::string room_;
  scenes::Simulation::Saved kept_;  ///< The confirmed state that the last connection has left.
  bool has_kept_ = false;
  bool welcomed_ = false;  ///< Once at least.
  bool forgotten_ =
      false;  ///< The server no longer knew our resume token; it has let nobody in yet.
  bool stopping_ = false;
  bool over_ = false;
  std::optional<Clock::time_point> broken_;         ///< Since when there is no state from a server.
  std::optional<Clock::time_point> working_since_;  ///< The first state of this connection.
};

}  // namespace cycloid::client
